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
/// Space that is reserved on the disk beyond what is written, for the log and for the one that is written anew: so a
/// disk that becomes full stops nothing.
const RESERVE: u64 = 4 << 20;

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
    /// Why it could not be written anew, until somebody asks.
    complaint: Option<io::Error>,
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
            buffer: Vec::new(),
        };
        log.compact_at = log.next_compaction();
        log
    }

    pub(super) fn contents(&self) -> &Contents {
        &self.contents
    }

    fn next_compaction(&self) -> u64 {
        SMALL.max(FACTOR * self.contents.size())
    }

    /// Why it could not be written anew since this was asked last: it grows meanwhile.
    pub(super) fn complaint(&mut self) -> Option<io::Error> {
        self.complaint.take()
    }

    /// Looks whether the next start will find what is kept.
    pub(super) fn look(&self) -> io::Result<()> {
        self.file.look()
    }

    /// Reserves space for what comes. False if the disk has none left beyond what is reserved already: then the log is
    /// written anew in time, so that it goes on in that for as long as what it holds fits.
    pub(super) fn reserve(&mut self) -> bool {
        let (log, spare) = (self.reserve_log(), self.reserve_spare());
        self.lacks_space = !(log && spare);
        if self.lacks_space {
            let reserved = self.reserved.unwrap_or(0).saturating_sub(RESERVE / 2);
            self.compact_at = self.compact_at.min(reserved.max(2 * self.contents.size() + SMALL / 16));
        }
        !self.lacks_space
    }

    fn reserve_log(&mut self) -> bool {
        let Some(reserved) = self.reserved else { return true };
        if self.size + RESERVE / 2 <= reserved {
            return true;
        }
        match self.file.reserve(self.size + RESERVE) {
            Ok(()) => self.reserved = Some(self.size + RESERVE),
            Err(error) if is_full(&error) => return false,
            Err(_) => self.reserved = None,
        }
        true
    }

    /// A disk that lacked space has some again only if it gives more than what was reserved before.
    fn reserve_spare(&mut self) -> bool {
        let Some(spare) = self.spare else { return true };
        let holds = self.contents.size();
        let least = holds + if self.lacks_space { 2 * RESERVE } else { RESERVE / 2 };
        if least <= spare {
            return true;
        }
        let wanted = least.max(holds + RESERVE);
        match self.file.reserve_spare(wanted) {
            Ok(()) => self.spare = Some(wanted),
            Err(error) if is_full(&error) => {
                if spare < holds + RESERVE / 2 && self.file.reserve_spare(holds + RESERVE).is_ok() {
                    self.spare = Some(holds + RESERVE);
                }
                return false;
            }
            Err(_) => self.spare = None,
        }
        true
    }

    /// Puts changes on the disk, as one group. Afterwards they are there, whatever happens.
    ///
    /// # Errors
    /// They are not; see [`CommitError`].
    pub(super) fn commit(&mut self, changes: &[Change]) -> Result<(), CommitError> {
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
        changes.iter().for_each(|change| self.contents.apply(change));
        if self.size > self.compact_at { self.compact().map_err(CommitError::Failed) } else { Ok(()) }
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
                Ok(())
            }
            Err(ReplaceError::Before(error)) => {
                self.compact_at = 2 * self.size;
                self.spare = self.spare.map(|_| 0);
                self.complaint = Some(error);
                Ok(())
            }
            Err(ReplaceError::Lost(error)) => Err(error),
        }
    }
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
