use std::env;
use std::fs::File;
use std::io::{self, ErrorKind, IsTerminal, Read, Write};
use std::mem::MaybeUninit;
use std::os::fd::{AsRawFd, RawFd};
use std::os::unix::net::UnixStream;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

use signal_hook::consts::{SIGHUP, SIGINT, SIGQUIT, SIGTERM, SIGTSTP, SIGWINCH};
use signal_hook::low_level::{emulate_default_handler, pipe};

use super::Sort;
use super::feed::Feed;
use crate::Exit;

/// Control sequences (ECMA-48, and those of xterm that all have): another screen, no cursor, no wrapping; and back.
const ENTER: &str = "\x1b[?1049h\x1b[?25l\x1b[?7l";
const LEAVE: &str = "\x1b[?7h\x1b[?25h\x1b[?1049l";
/// To the start of the screen; erase the rest of the line; erase the rest of the screen.
const HOME: &str = "\x1b[H";
const END_LINE: &str = "\x1b[K";
const END_SCREEN: &str = "\x1b[J";

/// The size of a window that does not tell it.
const SIZE: (usize, usize) = (24, 80);

/// A terminal that shows one picture after the other. It is as before when this is dropped.
pub(super) struct Terminal {
    output: File,
    /// How its input was before, where keys come from it.
    keys: Option<Keys>,
    woken: UnixStream,
    /// The newest signal that ends or stops the program; 0 is none.
    signal: Arc<AtomicUsize>,
}

struct Keys {
    before: libc::termios,
}

/// What is waited for.
#[derive(Debug)]
pub(super) enum Input {
    /// The user or the system ends it.
    End(Exit),
    /// Another order of the components.
    Sort(Option<Sort>),
    /// The window has another size, or is visible again.
    Changed,
    /// An answer of the fleet, or a signal.
    Woken,
    /// The time is over.
    Time,
}

impl Terminal {
    /// True if standard output is a terminal that can show pictures.
    pub(super) fn is_there() -> bool {
        let is_dumb = || env::var_os("TERM").is_none_or(|term| term == "dumb");
        crate::output::own().is_ok_and(|output| output.is_terminal()) && !is_dumb()
    }

    /// Takes the terminal. Signals and answers of the feed wake who waits.
    ///
    /// # Errors
    /// The system refuses it.
    pub(super) fn enter(feed: &Feed) -> io::Result<Terminal> {
        let signal = Arc::new(AtomicUsize::new(0));
        for number in [SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGTSTP] {
            signal_hook::flag::register_usize(number, Arc::clone(&signal), number as usize)?;
        }
        // After the number is noted.
        for number in [SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGTSTP, SIGWINCH] {
            pipe::register(number, feed.wake()?)?;
        }
        let woken = feed.woken.try_clone()?;
        let mut terminal = Terminal { output: crate::output::own()?, keys: None, woken, signal };
        terminal.begin()?;
        Ok(terminal)
    }

    fn begin(&mut self) -> io::Result<()> {
        self.keys = Keys::take();
        self.output.write_all(ENTER.as_bytes())
    }

    fn restore(&mut self) {
        // A terminal that is gone needs nothing.
        let _ = self.output.write_all(LEAVE.as_bytes());
        if let Some(keys) = self.keys.take() {
            keys.set(&keys.before);
        }
    }

    /// Rows and columns of the window.
    pub(super) fn size(&self) -> (usize, usize) {
        let mut size = MaybeUninit::<libc::winsize>::zeroed();
        // SAFETY: the request writes a `winsize`, for which there is room; all zeros are one, too.
        let size = unsafe {
            libc::ioctl(self.output.as_raw_fd(), libc::TIOCGWINSZ, size.as_mut_ptr());
            size.assume_init()
        };
        match (usize::from(size.ws_row), usize::from(size.ws_col)) {
            (0, _) | (_, 0) => SIZE,
            size => size,
        }
    }

    /// Shows lines from the start of the screen on, in one piece: nothing flickers.
    pub(super) fn show(&mut self, lines: &[String]) -> io::Result<()> {
        let lines: Vec<String> = lines.iter().map(|line| format!("{line}{END_LINE}")).collect();
        let text = format!("{HOME}{}{END_SCREEN}", lines.join("\r\n"));
        self.output.write_all(text.as_bytes())
    }

    /// Waits for something to do, so long at most.
    pub(super) fn wait(&mut self, time: Option<Duration>) -> Input {
        // A wait that is a bit too long is better than one that is repeated with no time left.
        let milliseconds = time.map_or(-1, |time| i32::try_from(time.as_millis()).map_or(i32::MAX, |time| time + 1));
        let keys: RawFd = if self.keys.is_some() { libc::STDIN_FILENO } else { -1 };
        let asked = |descriptor: RawFd| libc::pollfd { fd: descriptor, events: libc::POLLIN, revents: 0 };
        let mut both = [asked(self.woken.as_raw_fd()), asked(keys)];
        // SAFETY: the pointer leads to two structures that live until the call returns.
        let found =
            unsafe { libc::poll(both.as_mut_ptr(), 2, if time == Some(Duration::ZERO) { 0 } else { milliseconds }) };
        if found == 0 {
            return Input::Time;
        }
        match self.signal.swap(0, Ordering::SeqCst) as i32 {
            0 => {}
            SIGINT => return Input::End(Exit::Done),
            SIGTSTP => return self.stopped(),
            _ => return Input::End(Exit::Interrupted),
        }
        if both[1].revents != 0 {
            return self.key();
        }
        let mut bytes = [0; 64];
        match self.woken.read(&mut bytes) {
            Err(error) if error.kind() != ErrorKind::WouldBlock => Input::End(Exit::Failed),
            _ => Input::Woken,
        }
    }

    /// Stops the program as Ctrl-Z does, with the terminal as it was.
    fn stopped(&mut self) -> Input {
        self.restore();
        // It returns when the program goes on.
        let _ = emulate_default_handler(SIGTSTP);
        match self.begin() {
            Ok(()) => Input::Changed,
            Err(_) => Input::End(Exit::Failed),
        }
    }

    fn key(&mut self) -> Input {
        let mut keys = [0; 64];
        // Through no buffer: one could hold keys that `poll` does not see.
        // SAFETY: there is room for so many bytes.
        let count = unsafe { libc::read(libc::STDIN_FILENO, keys.as_mut_ptr().cast(), keys.len()) };
        let keys = &keys[..usize::try_from(count).unwrap_or(0)];
        if keys.is_empty() {
            // The end of the input, or an error: from now on signals alone end it.
            self.keys = None;
        }
        // Keys as arrows come as several bytes, which mean nothing by themselves.
        let typed = if keys.first() == Some(&0x1b) { &[] } else { keys };
        let mut meant = typed.iter().filter_map(|key| match key {
            b'q' | b'Q' => Some(Input::End(Exit::Done)),
            b'l' => Some(Input::Sort(Some(Sort::Late))),
            b'm' => Some(Input::Sort(Some(Sort::Missed))),
            b'n' => Some(Input::Sort(Some(Sort::Name))),
            b'c' => Some(Input::Sort(None)),
            _ => None,
        });
        meant.next_back().unwrap_or(Input::Changed)
    }
}

impl Drop for Terminal {
    fn drop(&mut self) {
        self.restore();
    }
}

impl Keys {
    /// Lets keys come at once and unseen; `None` where standard input is no terminal of this program.
    fn take() -> Option<Keys> {
        let mut settings = MaybeUninit::<libc::termios>::uninit();
        // SAFETY: there is room for what the call writes, and it is read only if it was written.
        let before = unsafe {
            if libc::tcgetattr(libc::STDIN_FILENO, settings.as_mut_ptr()) != 0 {
                return None;
            }
            settings.assume_init()
        };
        let keys = Keys { before };
        let mut settings = before;
        settings.c_lflag &= !(libc::ICANON | libc::ECHO);
        (settings.c_cc[libc::VMIN], settings.c_cc[libc::VTIME]) = (1, 0);
        keys.set(&settings).then_some(keys)
    }

    fn set(&self, settings: &libc::termios) -> bool {
        // SAFETY: the settings live until the call returns.
        unsafe { libc::tcsetattr(libc::STDIN_FILENO, libc::TCSANOW, settings) == 0 }
    }
}
