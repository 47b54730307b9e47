//! Standard output and standard error. A reader that went away (`saoms components | head`) is no failure; a full disk
//! is one.

use std::borrow::Cow;
use std::fmt::Display;
use std::fs::File;
use std::io::{self, BufWriter, ErrorKind, Write};
use std::mem::MaybeUninit;
use std::os::fd::{AsFd, AsRawFd, IntoRawFd, RawFd};
use std::os::unix::fs::FileTypeExt;
use std::sync::atomic::{AtomicBool, AtomicI32, Ordering};
use std::sync::{LazyLock, Mutex, OnceLock, PoisonError};
use std::time::Duration;

use saoms_api::host::{Visible, format_duration};
use serde::Serialize;

use super::json::{json, json_line};
use super::place::Place;

/// Standard output without a buffer; `None` where the system has no descriptor left.
static STANDARD: LazyLock<Mutex<Option<File>>> =
    LazyLock::new(|| Mutex::new(io::stdout().as_fd().try_clone_to_owned().ok().map(File::from)));

/// A copy of the descriptor of standard error, which code of libraries may close; 0 before there is one.
static ERRORS: AtomicI32 = AtomicI32::new(0);

/// True once something could not be written to standard output.
static HAS_FAILED: AtomicBool = AtomicBool::new(false);

/// True once a terminal took nothing any more, and whether the run goes on without one.
static IS_TERMINAL_GONE: AtomicBool = AtomicBool::new(false);
static MAY_TERMINAL_GO: AtomicBool = AtomicBool::new(false);

/// True once a reader took nothing for longer than the patience lasted: it gets no lines with gaps between them.
static IS_GIVEN_UP: AtomicBool = AtomicBool::new(false);

/// The milliseconds for which a reader that reads nothing is waited for; below 0 without end.
static PATIENCE: AtomicI32 = AtomicI32::new(-1);

/// The milliseconds between two looks at the patience.
const LOOK: i32 = 100;

/// The bytes that a pipe with any room takes at once (`PIPE_BUF`).
const PIECE: usize = 4096;

/// Keeps standard output for the program: from now on what code of libraries prints there goes to standard error, so
/// that it is in no report and no JSON. Keeps standard error, too, should they close it.
pub(crate) fn keep_from_libraries() {
    if let Ok(copy) = io::stderr().as_fd().try_clone_to_owned() {
        ERRORS.store(copy.into_raw_fd(), Ordering::SeqCst);
    }
    let standard = STANDARD.lock().unwrap_or_else(PoisonError::into_inner);
    let own = standard.as_ref().map(AsRawFd::as_raw_fd).into_iter().chain([ERRORS.load(Ordering::SeqCst)]);
    let own = own.filter_map(|descriptor| Some((descriptor, identity(descriptor)?)));
    KEPT.get_or_init(|| own.collect());
    if standard.is_some() {
        // SAFETY: no pointers; both descriptors are those that every process begins with. Where standard error is
        // closed nothing changes.
        unsafe { libc::dup2(libc::STDERR_FILENO, libc::STDOUT_FILENO) };
    }
}

/// The descriptors that are kept, with device and inode.
static KEPT: OnceLock<Vec<(RawFd, (u64, u64))>> = OnceLock::new();

fn identity(descriptor: RawFd) -> Option<(u64, u64)> {
    let mut about = MaybeUninit::<libc::stat>::uninit();
    // SAFETY: there is room for what the call writes, and it is read only if it was written.
    unsafe {
        (libc::fstat(descriptor, about.as_mut_ptr()) == 0).then(|| {
            let about = about.assume_init();
            (about.st_dev, about.st_ino)
        })
    }
}

/// True if what the program wrote to is closed, or something else by now: code of a library did that. A signal handler
/// may ask.
pub(crate) fn has_lost_descriptors() -> bool {
    KEPT.get().is_some_and(|kept| kept.iter().any(|(descriptor, before)| identity(*descriptor) != Some(*before)))
}

/// Lets the program end with the exit code of a failure.
pub(crate) fn fail() {
    HAS_FAILED.store(true, Ordering::SeqCst);
}

/// The program's standard output.
///
/// # Errors
/// The system has no descriptor left.
pub(crate) fn own() -> io::Result<File> {
    let standard = STANDARD.lock().unwrap_or_else(PoisonError::into_inner);
    standard.as_ref().ok_or_else(|| io::Error::from_raw_os_error(libc::EMFILE))?.try_clone()
}

/// True if something could not be written to standard output, which was told.
pub(crate) fn has_failed() -> bool {
    let has_lost_terminal = || IS_TERMINAL_GONE.load(Ordering::SeqCst) && !MAY_TERMINAL_GO.load(Ordering::SeqCst);
    HAS_FAILED.load(Ordering::SeqCst) || has_lost_terminal()
}

/// Says that the terminal is lost, and that nobody misses it: that it cannot be written is no failure.
pub(crate) fn lose_terminal() {
    MAY_TERMINAL_GO.store(true, Ordering::SeqCst);
}

/// From now on waits no longer than this for a reader of standard output that reads nothing: it counts as gone then.
pub(crate) fn limit_patience(patience: Duration) {
    PATIENCE.store(i32::try_from(patience.as_millis()).unwrap_or(i32::MAX), Ordering::SeqCst);
}

/// Writes a text for people to standard output, piece by piece: what in it would steer a terminal is escaped.
pub(crate) fn print(shown: &(impl Display + ?Sized)) {
    printed(|output| write!(output, "{}", Visible(shown)));
}

/// Writes a text for programs to standard output as it is, piece by piece.
pub(crate) fn print_as_is(text: &(impl Display + ?Sized)) {
    printed(|output| write!(output, "{text}"));
}

/// Writes data to standard output as JSON, piece by piece.
pub(crate) fn print_json(value: &impl Serialize) {
    printed(|output| json(output, value));
}

/// Writes data to standard output as one line of JSON.
pub(crate) fn print_json_line(value: &impl Serialize) {
    printed(|output| json_line(output, value));
}

/// Writes to standard output. The first failure is told; from then on [`has_failed`].
pub(crate) fn printed(write: impl FnOnce(&mut dyn Write) -> io::Result<()>) {
    let mut standard = STANDARD.lock().unwrap_or_else(PoisonError::into_inner);
    let written = match &mut *standard {
        None => Err(io::Error::from_raw_os_error(libc::EMFILE)),
        Some(file) => {
            let mut output = BufWriter::with_capacity(PIECE, Patient(file));
            let written = write(&mut output).and_then(|()| output.flush());
            // What could not be written is not tried again.
            drop(output.into_parts());
            written
        }
    };
    let Err(error) = written else { return };
    let about = standard.as_ref().and_then(|file| file.metadata().ok());
    drop(standard);
    if error.kind() == ErrorKind::BrokenPipe {
        return;
    }
    // What a terminal that is lost says; the signal may come later.
    let is_terminal =
        error.raw_os_error() == Some(libc::EIO) && about.is_some_and(|about| about.file_type().is_char_device());
    let is_first = match is_terminal {
        true => !IS_TERMINAL_GONE.swap(true, Ordering::SeqCst) && !MAY_TERMINAL_GO.load(Ordering::SeqCst),
        false => !HAS_FAILED.swap(true, Ordering::SeqCst),
    };
    if !is_first {
        return;
    }
    let help = match error.kind() {
        ErrorKind::StorageFull | ErrorKind::QuotaExceeded => {
            "\n  = help: the output is incomplete: free disk space, then run the command again"
        }
        _ => "",
    };
    eprint(&format!("error: standard output cannot be written: {error}{help}\n"));
}

/// Standard output that is written when there is room.
struct Patient<'a>(&'a mut File);

impl Write for Patient<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        while !IS_GIVEN_UP.load(Ordering::SeqCst) {
            let patience = PATIENCE.load(Ordering::SeqCst);
            if wait(self.0, libc::POLLOUT, if patience < 0 { LOOK } else { patience })? {
                return self.0.write(&bytes[..bytes.len().min(PIECE)]);
            }
            if patience >= 0 && !IS_GIVEN_UP.swap(true, Ordering::SeqCst) {
                let waited = format_duration(Duration::from_millis(patience as u64));
                eprint(&format!(
                    "warning: the reader of standard output read nothing for {waited}: the rest is not printed\n"
                ));
            }
        }
        Err(ErrorKind::BrokenPipe.into())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// Waits until nobody reads standard output any more, where that is a pipe or a socket.
///
/// # Errors
/// The system cannot tell.
pub(crate) fn wait_for_no_reader() -> io::Result<()> {
    wait(&own()?, 0, -1).map(drop)
}

/// False if standard output is a pipe or a socket that nobody reads any more.
pub(crate) fn has_reader() -> bool {
    // Asked for nothing, `poll` tells of the end alone.
    !Place::is_standard_output_read() || !own().and_then(|output| wait(&output, 0, 0)).is_ok_and(|is_gone| is_gone)
}

/// Waits until there is something to read, or the end of it.
///
/// # Errors
/// The system cannot tell.
pub(crate) fn wait_for_input(descriptor: &impl AsRawFd) -> io::Result<()> {
    wait(descriptor, libc::POLLIN, -1).map(drop)
}

/// Waits for one of these events, an error or the end of a descriptor, so many milliseconds at most.
fn wait(descriptor: &impl AsRawFd, events: i16, milliseconds: i32) -> io::Result<bool> {
    loop {
        let mut asked = libc::pollfd { fd: descriptor.as_raw_fd(), events, revents: 0 };
        // SAFETY: the pointer leads to one structure that lives until the call returns.
        let found = unsafe { libc::poll(&raw mut asked, 1, milliseconds) };
        match io::Error::last_os_error() {
            error if found < 0 && error.kind() != ErrorKind::Interrupted => return Err(error),
            _ if found < 0 => {}
            _ => return Ok(found > 0),
        }
    }
}

/// Writes a text for people to standard error, piece by piece: what in it would steer a terminal is escaped.
pub(crate) fn eprint(shown: &(impl Display + ?Sized)) {
    let shown = shown.to_string();
    let lines: Vec<Cow<'_, str>> = shown.split('\n').map(quoting_little).collect();
    eprint_coloured(&Visible(&lines.join("\n")));
}

/// The characters of a value that a line quotes at most: a path is longer than other values.
const QUOTED: usize = 300;

/// A line that quotes no value, between backticks, beyond that.
fn quoting_little(line: &str) -> Cow<'_, str> {
    if line.len() <= QUOTED {
        return line.into();
    }
    let pieces = line.split('`').enumerate().map(|(place, piece)| match piece.char_indices().nth(QUOTED) {
        Some((end, _)) if place % 2 == 1 => format!("{}…", &piece[..end]),
        _ => piece.to_owned(),
    });
    pieces.collect::<Vec<String>>().join("`").into()
}

/// Writes diagnostics to standard error, piece by piece. They escape what others wrote, and have colours.
pub(crate) fn eprint_coloured(shown: &(impl Display + ?Sized)) {
    eprinted(|output| write!(output, "{shown}"));
}

/// Standard error. Where it cannot be written nobody is left to be told, but the exit code says so.
fn eprinted(write: impl FnOnce(&mut dyn Write) -> io::Result<()>) {
    struct Errors;

    impl Write for Errors {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            if write_error(bytes) { Ok(bytes.len()) } else { Err(io::Error::last_os_error()) }
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    // One at a time.
    let _lock = io::stderr().lock();
    let mut output = BufWriter::new(Errors);
    let written = write(&mut output).and_then(|()| output.flush());
    drop(output.into_parts());
    if written.is_err_and(|error| error.raw_os_error() == Some(libc::EBADF)) {
        fail();
    }
}

/// Writes bytes to standard error, or to the copy of it if it was closed. A signal handler may do so.
pub(crate) fn write_error(mut bytes: &[u8]) -> bool {
    let kept = ERRORS.load(Ordering::SeqCst);
    let mut descriptor = if kept == 0 { libc::STDERR_FILENO } else { kept };
    while !bytes.is_empty() {
        // SAFETY: the bytes are readable.
        let written = unsafe { libc::write(descriptor, bytes.as_ptr().cast(), bytes.len()) };
        match usize::try_from(written) {
            Ok(written) => bytes = &bytes[written..],
            Err(_) => match io::Error::last_os_error().raw_os_error() {
                Some(libc::EINTR) => {}
                Some(libc::EBADF) if descriptor != libc::STDERR_FILENO => descriptor = libc::STDERR_FILENO,
                _ => return false,
            },
        }
    }
    true
}

/// Writes data to standard error as JSON, piece by piece.
pub(crate) fn eprint_json(value: &impl Serialize) {
    eprinted(|output| json(output, value));
}
