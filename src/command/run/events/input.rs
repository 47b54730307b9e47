//! Where the lines of `saoms run --events` come from.

use std::fs::{self, File};
use std::io::{self, BufRead, BufReader, ErrorKind, Read};
use std::os::unix::fs::{FileTypeExt, OpenOptionsExt};
use std::path::Path;

use saoms_lang::load::{missing_file_help, wide_encoding};

use super::journal;
use crate::output::{displayed, wait_for_input};

/// The mark with which editors begin some files in UTF-8. It is no part of the text.
pub(super) const MARK: &[u8] = b"\xef\xbb\xbf";

/// Why events cannot be read.
#[derive(Debug)]
pub(in crate::command::run) struct Unreadable {
    pub(in crate::command::run) message: String,
    pub(in crate::command::run) help: Option<String>,
}

impl From<io::Error> for Unreadable {
    fn from(error: io::Error) -> Unreadable {
        Unreadable { message: error.to_string(), help: None }
    }
}

impl Unreadable {
    fn new(message: impl Into<String>) -> Unreadable {
        Unreadable { message: message.into(), help: None }
    }
}

/// A named pipe that is read without blocking. To read it blocking, it would have to be opened so, which waits for a
/// writer.
struct Pipe(File);

impl Read for Pipe {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        loop {
            // Nothing comes before there is a writer, and the end only after one.
            wait_for_input(&self.0)?;
            match self.0.read(buffer) {
                Err(error) if error.kind() == ErrorKind::WouldBlock => {}
                result => return result,
            }
        }
    }
}

/// Opens a file, or standard input where the path is `-`. A named pipe may have no writer yet: it is waited for when
/// lines are read, so that the fleet runs and can be ended.
pub(super) fn open(path: &Path) -> Result<Box<dyn BufRead + Send>, Unreadable> {
    if path == Path::new("-") {
        return Ok(Box::new(BufReader::new(io::stdin())));
    }
    let about = fs::metadata(path).map_err(|error| match error.kind() {
        // A link that leads to no file is there itself.
        ErrorKind::NotFound if path.symlink_metadata().is_err() => {
            Unreadable { message: "there is no such file".to_owned(), help: missing_file_help(path) }
        }
        _ => error.into(),
    })?;
    if about.file_type().is_fifo() {
        let pipe = File::options().read(true).custom_flags(libc::O_NONBLOCK).open(path)?;
        return Ok(Box::new(BufReader::new(Pipe(pipe))));
    }
    if about.is_dir() {
        return Err(io::Error::from(ErrorKind::IsADirectory).into());
    }
    let mut lines = BufReader::new(File::open(path)?);
    // A device may have nothing to read yet.
    if about.is_file() {
        judge(lines.fill_buf()?, path)?;
    }
    Ok(Box::new(lines))
}

/// Refuses a file whose start shows that it has no lines of events.
fn judge(start: &[u8], path: &Path) -> Result<(), Unreadable> {
    if let Some(encoding) = wide_encoding(start) {
        let help = format!("convert it: `iconv -f {encoding} -t UTF-8 {}`", displayed(path));
        return Err(Unreadable { message: format!("it is in {encoding}, expected UTF-8"), help: Some(help) });
    }
    let start = start.strip_prefix(MARK).unwrap_or(start).trim_ascii_start();
    if start.starts_with(b"<") {
        return Err(Unreadable::new("it is XML, expected a line for each event"));
    }
    if start.starts_with(b"{") && !journal::is_head(start) {
        return Err(Unreadable::new("it is JSON, expected a line for each event, or a file of `--journal`"));
    }
    Ok(())
}
