use std::io::{self, ErrorKind};

use super::{Change, Contents, group};

/// The file of a log, as far as its bytes are concerned.
pub(super) trait LogFile: Send {
    /// Adds bytes to its end.
    fn append(&mut self, bytes: &[u8]) -> io::Result<()>;
    /// Waits until all that was added is on the disk.
    fn sync(&mut self) -> io::Result<()>;
    /// Looks whether the file is still where it was opened: the next start reads it there.
    fn look(&self) -> io::Result<()>;
    /// Removes what comes after so many bytes.
    fn cut(&mut self, size: u64) -> io::Result<()>;
    /// Has the disk reserve the space up to so many bytes.
    fn reserve(&mut self, size: u64) -> io::Result<()>;
    /// Has the disk reserve so many bytes for what is put in place of all.
    fn reserve_spare(&mut self, size: u64) -> io::Result<()>;
    /// Puts other bytes on the disk, and then in place of all.
    fn replace(&mut self, bytes: &[u8]) -> Result<(), ReplaceError>;
}

/// Why a file was not replaced.
#[derive(Debug)]
pub(super) enum ReplaceError {
    /// It is as it was before.
    Before(io::Error),
    /// It is not known what is on the disk.
    Lost(io::Error),
}

/// Why a group was not committed.
#[derive(Debug)]
pub(super) enum CommitError {
    /// There is no space on the disk: the log is as it was before.
    Full(io::Error),
    /// It is not known what is on the disk. What the system could not write, it may have forgotten, so that trying
    /// again proves nothing.
    Failed(io::Error),
}

/// Size up to which a log is not written anew.
const SMALL: u64 = 1 << 20;
/// A log is written anew when it is this number of times as large as what it holds.
const FACTOR: u64 = 4;
/// Least space that is reserved on the disk beyond what is written, for the log and for the one that is written anew:
/// so a disk that becomes full stops nothing.
const LEAST_RESERVE: u64 = 4 << 20;

/// A log of what components keep.
pub(super) struct Log<F> {
    file: F,
    /// Number of bytes that are on the disk.
    size: u64,
    /// Number of the next group.
    number: u64,
    contents: Contents,
    /// Size at which it is written anew.
    compact_at: u64,
    /// Size up to which there is space; `None` where the file system reserves none.
    reserved: Option<u64>,
    /// The same for a log that is written anew.
    spare: Option<u64>,
    /// True if the disk had no space beyond what is reserved when it was asked last.
    lacks_space: bool,
    /// Why it could not be written anew, until somebody asks; and whether that was so when it was tried last.
    complaint: Option<io::Error>,
    has_complained: bool,
    buffer: Vec<u8>,
}

impl<F: LogFile> Log<F> {
    /// A log that holds this, after a group with this number.
    pub(super) fn new(file: F, size: u64, number: u64, contents: Contents) -> Log<F> {
        let mut log = Log {
            file,
            size,
            number,
            contents,
            compact_at: 0,
            reserved: Some(0),
            spare: Some(0),
            lacks_space: false,
            complaint: None,
            has_complained: false,
            buffer: Vec::new(),
        };
        log.compact_at = log.next_compaction();
        log
    }

    pub(super) fn contents(&self) -> &Contents {
        &self.contents
    }

    /// The space that is reserved beyond what is written, as far as the disk gives it: in half of it, all that the log
    /// holds may change at once, and it is reserved anew in time for that.
    fn reserve_size(&self) -> u64 {
        LEAST_RESERVE.max(2 * self.contents.size() + SMALL / 8)
    }

    fn next_compaction(&self) -> u64 {
        SMALL.max(FACTOR * self.contents.size())
    }

    /// Why it could not be written anew, once until it can: it grows meanwhile.
    pub(super) fn complaint(&mut self) -> Option<io::Error> {
        self.complaint.take()
    }

    /// Looks whether the next start will find what is kept.
    pub(super) fn look(&self) -> io::Result<()> {
        self.file.look()
    }

    /// Number of bytes of a log that is written anew, at most.
    fn holds(&self) -> u64 {
        self.contents.size() + SMALL / 16
    }

    /// True if it can be written anew in what is reserved for that.
    fn has_room(&self) -> bool {
        self.spare.is_none_or(|spare| spare >= self.holds())
    }

    /// Reserves space for what comes. False if the disk has none left beyond what is reserved already: then the log is
    /// written anew in time, so that it goes on in that for as long as what it holds fits.
    ///
    /// # Errors
    /// It is not known what is on the disk.
    pub(super) fn reserve(&mut self) -> io::Result<bool> {
        self.reserve_both()?;
        // As long as there is room for it: what comes next may need more.
        let is_narrow = self.spare.is_some_and(|spare| spare < self.holds() + SMALL / 8) && self.size > self.holds();
        let is_due = self.size > self.compact_at || is_narrow && !self.has_complained;
        if self.lacks_space && self.has_room() && is_due {
            self.compact()?;
            self.reserve_both()?;
        }
        Ok(!self.lacks_space)
    }

    fn reserve_both(&mut self) -> io::Result<()> {
        // A log that cannot be written anew stops for good, and one that can has the space of both.
        let (spare, log) = (self.reserve_spare()?, self.reserve_log());
        self.lacks_space = !(log && spare);
        // One that could not be written anew is tried again later.
        if self.lacks_space && !self.has_complained {
            let reserved = self.reserved.unwrap_or(0).saturating_sub(LEAST_RESERVE / 2);
            self.compact_at = self.compact_at.min(reserved.max(self.holds() + self.holds() / 4));
        }
        Ok(())
    }

    fn reserve_log(&mut self) -> bool {
        let Some(reserved) = self.reserved else { return true };
        let reserve = self.reserve_size();
        if self.size + reserve / 2 > reserved {
            self.reserved = most_reserved(self.size, reserve, reserved, |size| self.file.reserve(size));
        }
        self.reserved.is_none_or(|reserved| self.size + LEAST_RESERVE / 2 <= reserved)
    }

    /// A disk that lacked space has some again only if it gives more than what was reserved before.
    fn reserve_spare(&mut self) -> io::Result<bool> {
        let Some(spare) = self.spare else { return Ok(true) };
        let (holds, reserve) = (self.holds(), self.reserve_size());
        let least = holds + if self.lacks_space { reserve + 2 * LEAST_RESERVE } else { reserve / 2 };
        if least <= spare {
            return Ok(true);
        }
        if self.lacks_space && self.file.reserve_spare(least).is_ok() {
            self.spare = Some(least);
            return Ok(true);
        }
        self.spare = most_reserved(holds, reserve, spare, |size| self.file.reserve_spare(size));
        if let (Some(spare), Some(reserved)) = (self.spare, self.reserved)
            && spare < holds + SMALL / 8
            && reserved > self.size
        {
            // What is reserved for the log is of no use once it cannot be written anew.
            self.file.cut(self.size)?;
            self.reserved = Some(self.size);
            self.spare = most_reserved(holds, reserve, spare, |size| self.file.reserve_spare(size));
        }
        // More than what a log that was written anew has freed: a full disk shows by that.
        Ok(!self.lacks_space && self.spare.is_none_or(|spare| holds + 2 * LEAST_RESERVE <= spare))
    }

    /// Puts changes on the disk, as one group. Afterwards they are there, whatever happens.
    ///
    /// # Errors
    /// They are not; see [`CommitError`].
    pub(super) fn commit(&mut self, changes: &[Change]) -> Result<(), CommitError> {
        let mut result = self.append(changes);
        let may_compact = match self.spare {
            Some(_) => self.has_room(),
            None => self.size > self.holds() && !self.has_complained,
        };
        if matches!(result, Err(CommitError::Full(_))) && may_compact {
            // Then it has the space of both.
            self.compact().map_err(CommitError::Failed)?;
            result = self.append(changes);
        }
        result?;
        changes.iter().for_each(|change| self.contents.apply(change));
        let may_compact = self.has_room() || !self.lacks_space;
        if self.size > self.compact_at && may_compact {
            self.compact().map_err(CommitError::Failed)?;
        }
        Ok(())
    }

    fn append(&mut self, changes: &[Change]) -> Result<(), CommitError> {
        self.buffer.clear();
        group::write(&mut self.buffer, self.number, changes);
        if let Err(error) = self.file.append(&self.buffer) {
            if !is_full(&error) {
                return Err(CommitError::Failed(error));
            }
            self.file.cut(self.size).map_err(CommitError::Failed)?;
            // What was reserved may be gone with it.
            self.reserved = self.reserved.map(|_| 0);
            return Err(CommitError::Full(error));
        }
        self.file.sync().and_then(|()| self.file.look()).map_err(CommitError::Failed)?;
        self.size += self.buffer.len() as u64;
        self.number += 1;
        Ok(())
    }

    /// Writes the log anew, with what it holds alone. Where that is not possible, it goes on as it is.
    fn compact(&mut self) -> io::Result<()> {
        let mut bytes = group::HEAD.to_vec();
        let mut number = self.number;
        let mut part: Vec<Change> = Vec::new();
        let mut size = 0;
        for change in self.contents.changes() {
            size += change.bytes.as_ref().map_or(0, |bytes| bytes.len());
            part.push(change);
            if size > SMALL as usize {
                group::write(&mut bytes, number, &part);
                (number, size) = (number + 1, 0);
                part.clear();
            }
        }
        group::write(&mut bytes, number, &part);
        match self.file.replace(&bytes) {
            Ok(()) => {
                (self.size, self.number) = (bytes.len() as u64, number + 1);
                self.reserved = self.reserved.and_then(|_| self.spare.or(Some(0)));
                self.spare = self.spare.map(|_| 0);
                self.compact_at = self.next_compaction();
                self.has_complained = false;
                Ok(())
            }
            Err(ReplaceError::Before(error)) => {
                self.compact_at = 2 * self.size;
                self.spare = self.spare.map(|_| 0);
                if !std::mem::replace(&mut self.has_complained, true) {
                    self.complaint = Some(error);
                }
                Ok(())
            }
            Err(ReplaceError::Lost(error)) => Err(error),
        }
    }
}

/// Has the disk reserve as much as it gives beyond this size, if that is more than what is known to be reserved. `None`
/// where the file system reserves none.
fn most_reserved(size: u64, wanted: u64, known: u64, mut ask: impl FnMut(u64) -> io::Result<()>) -> Option<u64> {
    let mut last = u64::MAX;
    for step in [wanted + LEAST_RESERVE, wanted, wanted / 2, LEAST_RESERVE, SMALL / 8] {
        if step >= last || size + step <= known {
            continue;
        }
        last = step;
        match ask(size + step) {
            Ok(()) => return Some(size + step),
            Err(error) if is_full(&error) => {}
            Err(_) => return None,
        }
    }
    Some(known)
}

fn is_full(error: &io::Error) -> bool {
    matches!(error.kind(), ErrorKind::StorageFull | ErrorKind::QuotaExceeded)
}

/// What was read of a log.
pub(super) struct ReadLog {
    pub(super) contents: Contents,
    /// Number of the next group.
    pub(super) number: u64,
    /// Number of bytes up to the end of the last whole group.
    pub(super) size: usize,
    /// True if whole groups follow something that is none.
    pub(super) is_damaged: bool,
}

/// Reads the groups of a log. The last one may be torn, by a failure of the power: it was never committed.
pub(super) fn read(bytes: &[u8]) -> ReadLog {
    let mut log = ReadLog { contents: Contents::default(), number: 0, size: group::HEAD.len(), is_damaged: false };
    while let Some(rest) = bytes.get(log.size..).filter(|rest| !rest.is_empty()) {
        let Some(group) = group::Group::read(rest) else {
            log.is_damaged = group::has_later_group(rest, log.number);
            break;
        };
        if group.number < log.number || group.apply(&mut log.contents).is_none() {
            log.is_damaged = true;
            break;
        }
        (log.number, log.size) = (group.number + 1, log.size + group.size());
    }
    log
}
