//! The folder of a store on a disk.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, ErrorKind, Write};
use std::os::fd::AsRawFd;
use std::os::unix::fs::MetadataExt;
use std::path::{Path, PathBuf};

use super::log::{LogFile, ReplaceError};
use super::{StoreError, group};

/// The log.
pub(super) const LOG: &str = "store.log";
/// A log that is being written anew, and the space that is reserved for that.
const NEW: &str = "store.new";
/// The file that a program locks while it uses the folder.
const LOCK: &str = "lock";

/// A log in a folder that no other program uses.
pub(super) struct DiskFile {
    folder: PathBuf,
    file: File,
    /// The empty file that becomes the log when that is written anew.
    spare: Option<File>,
    /// Held as long as the log is open.
    _lock: File,
}

/// A log that was opened.
pub(super) struct Opened {
    pub(super) file: DiskFile,
    /// What it held.
    pub(super) bytes: Vec<u8>,
    /// False if it was made.
    pub(super) was_there: bool,
}

impl DiskFile {
    /// Opens the log of a folder, and makes both where they are missing.
    pub(super) fn open(folder: &Path) -> Result<Opened, StoreError> {
        let failed = |doing: &'static str, path: &Path| {
            let path = path.to_owned();
            move |error| StoreError::System { doing, path, error }
        };
        make(folder).map_err(failed("be made", folder))?;
        let (log, lock) = (folder.join(LOG), folder.join(LOCK));
        let is_new = !log.exists();
        if is_new && !lock.exists() {
            let mut entries = fs::read_dir(folder).map_err(failed("be read", folder))?;
            if entries.next().is_some() {
                return Err(StoreError::Foreign { folder: folder.to_owned() });
            }
        }
        // Opening a pipe, or reading it, would wait for somebody else.
        for path in [&log, &lock, &folder.join(NEW)] {
            if path.metadata().is_ok_and(|about| !about.is_file()) {
                return Err(StoreError::NoFile { path: path.clone() });
            }
        }
        let mut options = OpenOptions::new();
        options.create(true).truncate(false).read(true).write(true);
        let locked = options.open(&lock).map_err(failed("be written", &lock))?;
        match locked.try_lock() {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => return Err(StoreError::Used { folder: folder.to_owned() }),
            Err(TryLockError::Error(error)) => return Err(failed("be locked", &lock)(error)),
        }
        let mut file =
            OpenOptions::new().create(true).read(true).append(true).open(&log).map_err(failed("be written", &log))?;
        // The other file may have been removed as a leftover.
        if let Err(TryLockError::WouldBlock) = file.try_lock() {
            return Err(StoreError::Used { folder: folder.to_owned() });
        }
        let bytes = fs::read(&log).map_err(failed("be read", &log))?;
        // A program that ended before it had written the first line had committed nothing.
        if group::is_begun(&bytes) {
            let begin = |file: &mut File| {
                file.set_len(0)?;
                file.write_all(group::HEAD)?;
                sync_all(file)?;
                sync_folder(folder)
            };
            begin(&mut file).map_err(failed("be written", &log))?;
        }
        let file = DiskFile { folder: folder.to_owned(), file, spare: None, _lock: locked };
        Ok(Opened { file, bytes, was_there: !is_new })
    }
}

/// Makes a folder and those around it that are missing, so that they are there after a power failure.
fn make(folder: &Path) -> io::Result<()> {
    if folder.is_dir() {
        return Ok(());
    }
    let parent = folder.parent().filter(|parent| *parent != Path::new("")).unwrap_or(Path::new("."));
    make(parent)?;
    fs::create_dir(folder)?;
    sync_folder(parent)
}

/// Waits until the names of a folder's files are on the disk.
fn sync_folder(folder: &Path) -> io::Result<()> {
    sync_all(&File::open(folder)?)
}

/// Waits until a file is on the disk, with all that the system knows of it; or a folder, with the names of its files.
fn sync_all(file: &File) -> io::Result<()> {
    file.sync_all()?;
    #[cfg(test)]
    super::tests::power::note_synced(file);
    Ok(())
}

/// Waits until the bytes of a file are on the disk.
fn sync_data(file: &File) -> io::Result<()> {
    file.sync_data()?;
    #[cfg(test)]
    super::tests::power::note_synced(file);
    Ok(())
}

/// The empty file that becomes the log when that is written anew.
fn new_log(folder: &Path) -> io::Result<File> {
    let file = OpenOptions::new().create(true).append(true).open(folder.join(NEW))?;
    if file.metadata()?.len() > 0 {
        // A program ended while it wrote it.
        file.set_len(0)?;
    }
    Ok(file)
}

/// Has the disk reserve space for the first bytes of a file.
fn reserve(file: &File, size: u64) -> io::Result<()> {
    let size = libc::off_t::try_from(size).map_err(|_| ErrorKind::FileTooLarge)?;
    // SAFETY: the descriptor is that of an open file; the call touches no memory of this program.
    match unsafe { libc::fallocate(file.as_raw_fd(), libc::FALLOC_FL_KEEP_SIZE, 0, size) } {
        0 => Ok(()),
        _ => Err(io::Error::last_os_error()),
    }
}

impl LogFile for DiskFile {
    fn append(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.file.write_all(bytes)
    }

    fn sync(&mut self) -> io::Result<()> {
        sync_data(&self.file)
    }

    fn look(&self) -> io::Result<()> {
        let (path, own) = (self.folder.join(LOG), self.file.metadata()?);
        match fs::metadata(&path) {
            Ok(there) if (there.dev(), there.ino()) == (own.dev(), own.ino()) => Ok(()),
            Err(error) if error.kind() != ErrorKind::NotFound => Err(error),
            _ => {
                let path = path.display();
                Err(io::Error::other(format!("`{path}` is not there any more, or is another file")))
            }
        }
    }

    fn cut(&mut self, size: u64) -> io::Result<()> {
        self.file.set_len(size)
    }

    fn reserve(&mut self, size: u64) -> io::Result<()> {
        reserve(&self.file, size)
    }

    fn reserve_spare(&mut self, size: u64) -> io::Result<()> {
        if let Some(spare) = &self.spare {
            return reserve(spare, size);
        }
        let spare = new_log(&self.folder)?;
        reserve(&spare, size)?;
        self.spare = Some(spare);
        Ok(())
    }

    fn replace(&mut self, bytes: &[u8]) -> Result<(), ReplaceError> {
        let (new, log) = (self.folder.join(NEW), self.folder.join(LOG));
        let spare = self.spare.take();
        let write = || {
            let mut file = spare.map_or_else(|| new_log(&self.folder), Ok)?;
            file.write_all(bytes)?;
            sync_all(&file)?;
            // Nobody else uses it yet; a file system without locks has none for the other file, either.
            let _ = file.try_lock();
            Ok(file)
        };
        let file = write().map_err(|error| {
            // It takes space that the log may need.
            let _ = fs::remove_file(&new);
            ReplaceError::Before(error)
        })?;
        fs::rename(&new, &log).map_err(ReplaceError::Before)?;
        sync_folder(&self.folder).map_err(ReplaceError::Lost)?;
        self.file = file;
        Ok(())
    }
}
