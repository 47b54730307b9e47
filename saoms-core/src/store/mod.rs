//! The durable store: what components [keep](saoms_api::Context::keep) beyond the end of the program.
//!
//! A store is a folder with one log, to which changes are added. A thread writes them; all that waits while the disk is
//! busy is committed together. What is committed is there whatever happens: a log is read up to its last whole group,
//! and one that grows too large is written anew beside the old one, which it then replaces.

mod contents;
mod disk;
mod group;
mod log;
#[cfg(test)]
mod tests;
mod thread;

use std::fmt;
use std::io;
use std::path::{Path, PathBuf};

pub(crate) use contents::{Change, Contents, Entries};
use disk::{DiskFile, Opened};
use log::Log;
pub(crate) use thread::{Batch, LaterChanges, StoreEvents, StoreQueue, write};

/// A store that is open, and not yet used by a fleet.
///
/// ```
/// use saoms_core::store::Store;
///
/// let folder = tempfile::tempdir().unwrap();
/// let store = Store::open(&folder.path().join("state"))?;
/// assert!(store.repaired().is_none());
/// # Ok::<(), saoms_core::store::StoreError>(())
/// ```
pub struct Store {
    log: Log<DiskFile>,
    repaired: Option<String>,
}

/// A store that cannot be opened.
#[derive(Debug)]
pub enum StoreError {
    /// Another program uses it.
    Used {
        /// The folder.
        folder: PathBuf,
    },
    /// The folder has files, and no store.
    Foreign {
        /// The folder.
        folder: PathBuf,
    },
    /// The log is no log of this version.
    Version {
        /// The log.
        log: PathBuf,
        /// Its first line.
        line: String,
    },
    /// Something in the middle of the log was changed after it was written.
    Damaged {
        /// The log.
        log: PathBuf,
        /// The first byte that is wrong.
        at: usize,
    },
    /// Something in the folder is no regular file.
    NoFile {
        /// What it is.
        path: PathBuf,
    },
    /// The system refuses something.
    System {
        /// What could not be done, as `be read`.
        doing: &'static str,
        /// The file or folder.
        path: PathBuf,
        /// What the system says.
        error: io::Error,
    },
}

impl Store {
    /// Opens the store of a folder, which is made where it is missing.
    ///
    /// # Errors
    /// See [`StoreError`]. Nothing was changed but for a missing folder.
    pub fn open(folder: &Path) -> Result<Store, StoreError> {
        let Opened { mut file, bytes, was_there } = DiskFile::open(folder)?;
        let path = folder.join(disk::LOG);
        let is_begun = group::is_begun(&bytes);
        if !is_begun && !bytes.starts_with(group::HEAD) {
            let line = bytes.split(|byte| *byte == b'\n').next().unwrap_or_default();
            let line = String::from_utf8_lossy(&line[..line.len().min(40)]).into_owned();
            return Err(StoreError::Version { log: path, line });
        }
        let read = log::read(&bytes);
        if read.is_damaged {
            return Err(StoreError::Damaged { log: path, at: read.size });
        }
        let torn = bytes.len().saturating_sub(read.size);
        if torn > 0 {
            use log::LogFile;
            let cut = file.cut(read.size as u64).and_then(|()| file.sync());
            cut.map_err(|error| StoreError::System { doing: "be cut", path: path.clone(), error })?;
        }
        let repaired = if is_begun && was_there {
            Some(format!(
                "`{}` has {} bytes, which are no whole first line, as after a failure of the power before anything was \
                 kept: the fleet begins without a state. Restore the file from a backup if somebody cut it",
                path.display(),
                bytes.len()
            ))
        } else {
            (torn > 0).then(|| {
                format!(
                    "the last {torn} bytes of `{}` are no whole group, as after a failure of the power, and are removed: \
                     they were never committed, unless somebody changed the file",
                    path.display()
                )
            })
        };
        Ok(Store { log: Log::new(file, read.size as u64, read.number, read.contents), repaired })
    }

    /// What was removed from the end of the log, if anything was.
    pub fn repaired(&self) -> Option<&str> {
        self.repaired.as_deref()
    }

    pub(crate) fn contents(&self) -> &Contents {
        self.log.contents()
    }
}

impl fmt::Debug for Store {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.debug_struct("Store").field("contents", self.contents()).finish_non_exhaustive()
    }
}

impl fmt::Display for StoreError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            StoreError::Used { folder } => {
                write!(
                    formatter,
                    "another program keeps its state in `{}`: end it, or name another folder",
                    folder.display()
                )
            }
            StoreError::Foreign { folder } => write!(
                formatter,
                "the folder `{}` has files, but no state of a fleet: name an empty folder, or one that does not exist",
                folder.display()
            ),
            StoreError::Version { log, line } if line.as_bytes().starts_with(group::HEAD_OF_ALL) => write!(
                formatter,
                "`{}` is of another version (`{line}`): run the version of SAOMS that wrote it, or name another folder",
                log.display()
            ),
            StoreError::Version { log, .. } => {
                write!(formatter, "`{}` is no state of a fleet: name another folder", log.display())
            }
            StoreError::Damaged { log, at } => write!(
                formatter,
                "`{}` is damaged: what stands at byte {at} is not what was written there, and more follows it; restore \
                 the folder from a backup, or name another one: the fleet begins without its state then",
                log.display()
            ),
            StoreError::NoFile { path } => {
                write!(formatter, "`{}` is no regular file: remove it, or name another folder", path.display())
            }
            StoreError::System { doing, path, error } => {
                write!(formatter, "`{}` cannot {doing}: {error}", path.display())
            }
        }
    }
}

impl std::error::Error for StoreError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            StoreError::System { error, .. } => Some(error),
            _ => None,
        }
    }
}
