//! Where the sockets of running fleets are, and the other files that only their user may use.

use std::env;
use std::fs::{self, DirBuilder, File, Permissions, TryLockError};
use std::io::{self, ErrorKind};
use std::os::unix::fs::{DirBuilderExt, FileTypeExt, MetadataExt, PermissionsExt};
use std::os::unix::net::{UnixListener, UnixStream};
use std::path::{Path, PathBuf};
use std::thread;
use std::time::{Duration, Instant};

use socket2::{Domain, SockAddr, Socket, Type};

/// Time for a connection and for a lock: a program that was stopped (SIGSTOP) gives neither.
const PATIENCE: Duration = Duration::from_secs(1);
/// Time between two attempts to get the lock, which is held for microseconds.
const PAUSE: Duration = Duration::from_millis(1);

/// The folder with the sockets of the user's fleets: `saoms` in `$XDG_RUNTIME_DIR`, which belongs to the user alone, or
/// else `/tmp/saoms-UID`.
pub(crate) fn folder() -> PathBuf {
    match env::var_os("XDG_RUNTIME_DIR").filter(|folder| Path::new(folder).is_dir()) {
        Some(folder) => Path::new(&folder).join("saoms"),
        None => PathBuf::from(format!("/tmp/saoms-{}", user())),
    }
}

pub(crate) fn user() -> u32 {
    // SAFETY: it takes nothing and cannot fail.
    unsafe { libc::geteuid() }
}

/// The usual socket of a fleet: `NAME-PID.sock` in the folder of the user.
pub fn default_socket(name: &str, pid: u32) -> PathBuf {
    let plain = |letter: char| if letter.is_alphanumeric() || "-_.".contains(letter) { letter } else { '_' };
    // A path of a socket has at most 107 bytes.
    let name: String = name.chars().map(plain).take(24).collect();
    folder().join(format!("{}-{pid}.sock", name.trim_start_matches('.')))
}

/// The file beside a socket with the token that allows everything, on the network.
pub fn token_beside(socket: &Path) -> PathBuf {
    beside(socket, ".token")
}

/// The file beside a socket with the token that allows to see everything, on the network.
pub fn view_token_beside(socket: &Path) -> PathBuf {
    beside(socket, ".view-token")
}

fn beside(socket: &Path, ending: &str) -> PathBuf {
    let mut file = socket.as_os_str().to_owned();
    file.push(ending);
    file.into()
}

/// A socket on which a fleet listens. The file is removed when it is dropped.
#[derive(Debug)]
pub struct Listener {
    pub(crate) socket: UnixListener,
    pub(crate) file: OwnFile,
}

/// A file of this program, removed when it is dropped.
#[derive(Debug)]
pub(crate) struct OwnFile {
    path: PathBuf,
    /// Device and inode.
    identity: (u64, u64),
}

impl Listener {
    /// Listens on a socket that only the user can use. The file of a program that has ended is replaced.
    ///
    /// # Errors
    /// The folder cannot be made or belongs to somebody else, a program listens there, or the file is no socket.
    pub fn bind(path: &Path) -> io::Result<Listener> {
        in_own_folder(path)?;
        // A socket refuses who connects between `bind` and `listen`, as one of a program that has ended does, and
        // would be removed as such: it gets its name when it listens.
        let name = path.file_stem().unwrap_or_default().display();
        let hidden = path.with_file_name(format!(".{name}"));
        let is_seen_by_others = path.parent() == Some(&folder());
        let first = if is_seen_by_others { &hidden } else { path };
        let socket = match UnixListener::bind(first) {
            Err(error) if error.kind() == ErrorKind::AddrInUse => {
                remove_dead(first)?;
                UnixListener::bind(first)?
            }
            bound => bound?,
        };
        let first = OwnFile::of(first)?;
        fs::set_permissions(&first.path, Permissions::from_mode(0o600))?;
        if !is_seen_by_others {
            return Ok(Listener { socket, file: first });
        }
        let _locked = locked(&folder())?;
        // A link replaces no other file, as moving it would.
        match fs::hard_link(&hidden, path) {
            Err(error) if error.kind() == ErrorKind::AlreadyExists => {
                remove_dead(path)?;
                fs::hard_link(&hidden, path)?;
            }
            linked => linked?,
        }
        Ok(Listener { socket, file: OwnFile::of(path)? })
    }
}

impl OwnFile {
    /// The file that is at a path now.
    pub(crate) fn of(path: &Path) -> io::Result<OwnFile> {
        let metadata = fs::symlink_metadata(path)?;
        Ok(OwnFile { path: path.to_owned(), identity: (metadata.dev(), metadata.ino()) })
    }
}

impl Drop for OwnFile {
    fn drop(&mut self) {
        let _locked = self.path.parent().filter(|parent| *parent == folder()).map(locked);
        // Another program may have put its own file there.
        let is_own = fs::symlink_metadata(&self.path).is_ok_and(|file| (file.dev(), file.ino()) == self.identity);
        if is_own {
            let _ = fs::remove_file(&self.path);
        }
    }
}

/// Makes the folder of a file if it is that of the user's fleets.
pub(crate) fn in_own_folder(path: &Path) -> io::Result<()> {
    path.parent().filter(|parent| *parent == folder()).map_or(Ok(()), make_private)
}

/// Makes a folder that only the user can use.
fn make_private(folder: &Path) -> io::Result<()> {
    match DirBuilder::new().mode(0o700).create(folder) {
        Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
        made => return made,
    }
    let metadata = fs::symlink_metadata(folder)?;
    if !metadata.is_dir() || metadata.uid() != user() || metadata.mode() & 0o077 != 0 {
        let message = format!("other users can access the folder `{}`", folder.display());
        return Err(io::Error::new(ErrorKind::PermissionDenied, message));
    }
    Ok(())
}

/// Locks a folder: between the look at a file and its removal nobody may put another one there.
fn locked(folder: &Path) -> io::Result<File> {
    let file = File::open(folder)?;
    // Whoever holds the lock may have been stopped.
    let until = Instant::now() + PATIENCE;
    while let Err(error) = file.try_lock() {
        match error {
            TryLockError::WouldBlock if Instant::now() < until => thread::sleep(PAUSE),
            TryLockError::WouldBlock => {
                let message = format!("another program holds the lock of the folder `{}`", folder.display());
                return Err(io::Error::new(ErrorKind::TimedOut, message));
            }
            TryLockError::Error(error) => return Err(error),
        }
    }
    Ok(file)
}

/// Removes a socket on which nobody listens from the folder of the user's fleets.
pub(crate) fn remove_if_dead(path: &Path) -> io::Result<()> {
    // One that was stopped makes who asks wait: nobody holds the lock meanwhile.
    is_dead(path)?;
    let _locked = locked(&folder())?;
    remove_dead(path)
}

/// Removes a socket on which nobody listens.
fn remove_dead(path: &Path) -> io::Result<()> {
    is_dead(path)?;
    fs::remove_file(path)
}

/// `Ok` if nobody listens on a socket.
fn is_dead(path: &Path) -> io::Result<()> {
    if !fs::symlink_metadata(path)?.file_type().is_socket() {
        return Err(io::Error::new(ErrorKind::AlreadyExists, "a file that is not a socket is there"));
    }
    match connect(path) {
        Ok(_) => Err(io::Error::new(ErrorKind::AddrInUse, "another program listens there")),
        Err(error) if error.kind() == ErrorKind::ConnectionRefused => Ok(()),
        Err(error) => Err(error),
    }
}

/// Connects to a socket within [`PATIENCE`].
pub(crate) fn connect(path: &Path) -> io::Result<UnixStream> {
    let socket = Socket::new(Domain::UNIX, Type::STREAM, None)?;
    // It bounds the time for which a connection waits in the queue, too.
    socket.set_write_timeout(Some(PATIENCE))?;
    socket.connect(&SockAddr::unix(path)?).map_err(|error| match error.kind() {
        ErrorKind::WouldBlock => io::Error::new(ErrorKind::TimedOut, "it accepts no connection"),
        _ => error,
    })?;
    Ok(socket.into())
}
