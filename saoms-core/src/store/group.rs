//! The form of the log: a line with its version, then groups. A group is what was committed together: it is there as a
//! whole, or not at all.

use std::sync::Arc;

use super::{Change, Contents};
use crate::hash::fold;

/// First line of a log.
pub(super) const HEAD: &[u8] = b"saoms-store 1\n";

/// True if a log has no more than a part of its first line.
pub(super) fn is_begun(bytes: &[u8]) -> bool {
    bytes.len() < HEAD.len() && HEAD.starts_with(bytes)
}

/// What each first line begins with, in every version.
pub(super) const HEAD_OF_ALL: &[u8] = b"saoms-store ";

/// First bytes of a group.
const MARK: [u8; 4] = *b"grp\n";
/// Length of what comes before the changes of a group: mark, number of bytes, number of the group, checksum.
const HEADER: usize = 4 + 4 + 8 + 8;
/// In place of the number of bytes of a change that removes something.
const REMOVED: u32 = u32::MAX;
/// Most bytes of changes in one group.
pub(super) const MOST_BYTES: usize = 1 << 30;

/// Adds a group to a buffer.
pub(super) fn write<'a>(buffer: &mut Vec<u8>, number: u64, changes: impl IntoIterator<Item = &'a Change>) {
    let from = buffer.len();
    buffer.extend_from_slice(&[0; HEADER]);
    for Change { component, key, bytes } in changes {
        write_bytes(buffer, component.as_bytes());
        buffer.extend_from_slice(&key.to_le_bytes());
        match bytes {
            Some(bytes) => write_bytes(buffer, bytes),
            None => buffer.extend_from_slice(&REMOVED.to_le_bytes()),
        }
    }
    let (length, sum) = ((buffer.len() - from - HEADER) as u32, checksum(number, &buffer[from + HEADER..]));
    let header = &mut buffer[from..from + HEADER];
    header[..4].copy_from_slice(&MARK);
    header[4..8].copy_from_slice(&length.to_le_bytes());
    header[8..16].copy_from_slice(&number.to_le_bytes());
    header[16..].copy_from_slice(&sum.to_le_bytes());
}

/// The components have names and bytes of at most 64 MiB, so that their lengths fit.
fn write_bytes(buffer: &mut Vec<u8>, bytes: &[u8]) {
    buffer.extend_from_slice(&(bytes.len() as u32).to_le_bytes());
    buffer.extend_from_slice(bytes);
}

/// The checksum of a group.
fn checksum(number: u64, payload: &[u8]) -> u64 {
    let mut state = fold(number, payload.len() as u64);
    let mut words = payload.chunks_exact(8);
    for word in &mut words {
        state = fold(state, u64::from_le_bytes(word.try_into().unwrap_or_default()));
    }
    let mut last = [0; 8];
    last[..words.remainder().len()].copy_from_slice(words.remainder());
    fold(state, u64::from_le_bytes(last))
}

/// A group that was read.
pub(super) struct Group<'a> {
    pub(super) number: u64,
    payload: &'a [u8],
}

impl<'a> Group<'a> {
    /// The group with which these bytes begin; `None` if there is no whole one.
    pub(super) fn read(bytes: &'a [u8]) -> Option<Group<'a>> {
        let (header, rest) = bytes.split_at_checked(HEADER)?;
        if header[..4] != MARK {
            return None;
        }
        let word = |from: usize| header[from..from + 8].try_into().map(u64::from_le_bytes).ok();
        let length = header[4..8].try_into().map(u32::from_le_bytes).ok()?;
        let (number, sum) = (word(8)?, word(16)?);
        let payload = rest.get(..length as usize)?;
        (checksum(number, payload) == sum).then_some(Group { number, payload })
    }

    /// Number of its bytes.
    pub(super) fn size(&self) -> usize {
        HEADER + self.payload.len()
    }

    /// Adds its changes to contents; `None` if they are of another form.
    pub(super) fn apply(&self, contents: &mut Contents) -> Option<()> {
        let mut rest = self.payload;
        while !rest.is_empty() {
            let (length, after) = split_u32(rest)?;
            let (component, after) = after.split_at_checked(length as usize)?;
            let (key, after) = after.split_first_chunk::<8>()?;
            let (length, after) = split_u32(after)?;
            let bytes = if length == REMOVED { None } else { Some(after.get(..length as usize)?) };
            rest = &after[bytes.map_or(0, <[u8]>::len)..];
            let component: Arc<str> = std::str::from_utf8(component).ok()?.into();
            contents.apply(&Change { component, key: u64::from_le_bytes(*key), bytes: bytes.map(Arc::from) });
        }
        Some(())
    }
}

fn split_u32(bytes: &[u8]) -> Option<(u32, &[u8])> {
    bytes.split_first_chunk::<4>().map(|(first, rest)| (u32::from_le_bytes(*first), rest))
}

/// True if a whole group with a higher number than this begins somewhere in these bytes.
pub(super) fn has_later_group(bytes: &[u8], number: u64) -> bool {
    let is_mark = |place: &usize| bytes[*place..].starts_with(&MARK);
    (0..bytes.len())
        .filter(is_mark)
        .any(|place| Group::read(&bytes[place..]).is_some_and(|group| group.number > number))
}
