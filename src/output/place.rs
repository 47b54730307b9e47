//! The places that paths of outputs lead to, and how each is written.

use std::ffi::OsString;
use std::fs::{self, File, Metadata};
use std::io::{self, BufWriter, ErrorKind, Write};
use std::os::fd::{FromRawFd, RawFd};
use std::os::unix::ffi::OsStrExt;
use std::os::unix::fs::{FileTypeExt, MetadataExt};
use std::path::{Path, PathBuf};
use std::sync::OnceLock;
use std::{env, process};

use super::replace::{can_replace, replace};
use super::standard::{own, printed};

/// The path that stands for standard output.
const STANDARD: &str = "-";

/// The links that are followed one after the other, as Linux has it.
const LINKS: usize = 40;

/// The folder in which the program was started: code of a library may go into another one.
static START: OnceLock<PathBuf> = OnceLock::new();

/// Notes the present folder as that from which paths of outputs start.
pub(crate) fn keep_folder() {
    if let Ok(folder) = env::current_dir() {
        START.get_or_init(|| folder);
    }
}

/// The place that a path leads to.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Place {
    /// An open descriptor of this process, as `/dev/stdout` and `/dev/fd/3` name them.
    Descriptor(RawFd),
    /// A pipe or a device.
    Irregular(PathBuf),
    /// A file behind all links, which need not exist yet.
    File(PathBuf),
}

/// What is the same by whatever path it is reached.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(super) enum Identity {
    /// Device and inode.
    Present(u64, u64),
    /// A file to come: device and inode of its folder, and its name.
    Absent(u64, u64, OsString),
}

/// A place that is ready to be written.
#[derive(Debug)]
pub(crate) enum Sink {
    /// Standard output.
    Standard,
    /// Something that is open: it is written in place.
    Open(File),
    /// A file, written whole or not at all.
    File(PathBuf),
}

impl Place {
    /// The place behind all links.
    pub(crate) fn of(path: &Path) -> io::Result<Place> {
        if path == Path::new(STANDARD) {
            return Ok(Place::Descriptor(libc::STDOUT_FILENO));
        }
        let mut path = START.get().map_or_else(|| path.to_owned(), |start| start.join(path));
        for _ in 0..LINKS {
            if let Some(descriptor) = descriptor(&path) {
                return Ok(Place::Descriptor(descriptor));
            }
            // The last link may lead to a file that does not exist yet.
            match fs::read_link(&path) {
                Ok(target) => path = folder(&path).join(target),
                Err(_) => return Place::at(path),
            }
        }
        Err(io::Error::from_raw_os_error(libc::ELOOP))
    }

    /// True if it is standard output.
    pub(crate) fn is_standard_output(&self) -> bool {
        *self == Place::Descriptor(libc::STDOUT_FILENO)
    }

    /// The place at a path that is no link.
    fn at(path: PathBuf) -> io::Result<Place> {
        match fs::metadata(&path) {
            Ok(about) if about.is_dir() => Err(ErrorKind::IsADirectory.into()),
            Ok(about) if about.is_file() => Ok(Place::File(path)),
            Ok(_) => Ok(Place::Irregular(path)),
            Err(error) if error.kind() != ErrorKind::NotFound => Err(error),
            Err(_) if path.as_os_str().as_bytes().ends_with(b"/") => Err(ErrorKind::IsADirectory.into()),
            Err(_) => Ok(Place::File(path)),
        }
    }

    /// What the place is by whatever path it is reached; `None` for devices that take what anybody writes, as
    /// `/dev/null` and terminals, and for what is not there.
    pub(super) fn identity(&self) -> Option<Identity> {
        let about = match self {
            Place::Descriptor(libc::STDOUT_FILENO) => own().and_then(|output| output.metadata()),
            Place::Descriptor(descriptor) => fs::metadata(format!("/proc/self/fd/{descriptor}")),
            Place::Irregular(path) | Place::File(path) => fs::metadata(path),
        };
        match (about, self) {
            (Ok(about), _) if about.file_type().is_char_device() => None,
            (Ok(about), _) => Some(Identity::of(&about)),
            (Err(_), Place::File(path)) => {
                let folder = fs::metadata(folder(path)).ok()?;
                Some(Identity::Absent(folder.dev(), folder.ino(), path.file_name()?.to_owned()))
            }
            (Err(_), _) => None,
        }
    }

    /// True if standard output is a pipe or a socket, whose reader can go away.
    pub(crate) fn is_standard_output_read() -> bool {
        let about = own().and_then(|output| output.metadata()).map(|about| about.file_type());
        about.is_ok_and(|about| about.is_fifo() || about.is_socket())
    }

    /// Tries whether a file can be written, whole or as it grows, without a trace: what is there stays as it is. What
    /// is no file, [`open`](Self::open) tries.
    pub(super) fn try_out(&self, grows: bool) -> io::Result<()> {
        let Place::File(path) = self else { return Ok(()) };
        if !grows {
            return can_replace(path);
        }
        match File::options().append(true).open(path) {
            Err(error) if error.kind() == ErrorKind::NotFound => {}
            result => return result.map(drop),
        }
        // Only a file created here is removed: if another process was faster, this is an error.
        File::create_new(path)?;
        fs::remove_file(path)
    }

    /// Makes the place ready. A named pipe waits for its reader.
    pub(crate) fn open(self) -> io::Result<Sink> {
        match self {
            Place::Descriptor(libc::STDOUT_FILENO) => Ok(Sink::Standard),
            Place::Descriptor(descriptor) => copy(descriptor).map(Sink::Open),
            Place::Irregular(path) => File::options().write(true).open(path).map(Sink::Open),
            Place::File(path) => Ok(Sink::File(path)),
        }
    }
}

impl Identity {
    pub(super) fn of(about: &Metadata) -> Identity {
        Identity::Present(about.dev(), about.ino())
    }
}

impl Sink {
    /// Writes everything that there is to write. What happens to standard output is told where it happens.
    pub(crate) fn write(&self, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
        match self {
            Sink::Standard => {
                printed(|output| write(output));
                Ok(())
            }
            Sink::Open(file) => {
                let mut output = BufWriter::new(file);
                write(&mut output)?;
                output.flush()
            }
            Sink::File(path) => replace(path, write),
        }
    }
}

fn folder(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// The descriptor that a path in the folder of this process's descriptors stands for. It can lead to a file that
/// others write as well, which is why it is used itself.
fn descriptor(path: &Path) -> Option<RawFd> {
    let number: RawFd = path.file_name()?.to_str()?.parse().ok()?;
    let folder = fs::canonicalize(path.parent()?).ok()?;
    (folder == Path::new("/proc").join(process::id().to_string()).join("fd")).then_some(number)
}

fn copy(descriptor: RawFd) -> io::Result<File> {
    // SAFETY: the call takes no pointers; a number that is no open descriptor is an error.
    let copy = unsafe { libc::fcntl(descriptor, libc::F_DUPFD_CLOEXEC, 0) };
    if copy < 0 {
        return Err(io::Error::last_os_error());
    }
    // SAFETY: the descriptor has just been made, and is nobody else's.
    Ok(unsafe { File::from_raw_fd(copy) })
}
