use std::ffi::OsString;
use std::fs::{self, File, OpenOptions, Permissions};
use std::io::{self, ErrorKind, Write};
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// When a file that grows is moved aside for a new one, and how many of those are kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rotation {
    /// The size that a file comes to.
    pub size: Option<u64>,
    /// The age that a file comes to. It is moved when it is written to again.
    pub age: Option<Duration>,
    /// Number of earlier files that are kept; older ones are removed.
    pub keep: u32,
}

impl Rotation {
    /// A file that grows for ever.
    pub const NONE: Rotation = Rotation { size: None, age: None, keep: 0 };

    /// True if files are moved aside at all.
    pub fn is_any(&self) -> bool {
        self.size.is_some() || self.age.is_some()
    }
}

/// The name of an earlier file: `FILE.1` is the newest one.
pub fn earlier_file(path: &Path, number: u32) -> PathBuf {
    let mut name = OsString::from(path);
    name.push(format!(".{number}"));
    name.into()
}

/// A file that grows, and is moved aside when it is too large or too old.
#[derive(Debug)]
pub struct RotatingFile {
    path: PathBuf,
    /// Permissions where it is new; without, those of the process.
    mode: Option<u32>,
    rotation: Rotation,
    file: File,
    size: u64,
    since: Instant,
    /// True if the last part of it is torn, because there was no room for the rest.
    is_torn: bool,
}

impl RotatingFile {
    /// Opens a file: it goes on where there is one.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn append(path: PathBuf, mode: Option<u32>, rotation: Rotation) -> io::Result<RotatingFile> {
        let file = open(&path, mode, OpenOptions::new().append(true))?;
        let size = file.metadata()?.len();
        Ok(RotatingFile { path, mode, rotation, file, size, since: Instant::now(), is_torn: false })
    }

    /// Opens a new file. One that is there is moved aside if earlier files are kept, and else replaced.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn create(path: PathBuf, mode: Option<u32>, rotation: Rotation) -> io::Result<RotatingFile> {
        if rotation.is_any() && fs::metadata(&path).is_ok_and(|file| file.len() > 0) {
            move_aside(&path, rotation.keep)?;
        }
        let file = create_file(&path, mode)?;
        Ok(RotatingFile { path, mode, rotation, file, size: 0, since: Instant::now(), is_torn: false })
    }

    /// What is open, as a pipe, and never moved.
    pub fn of(file: File, path: PathBuf) -> RotatingFile {
        let (mode, rotation) = (None, Rotation::NONE);
        RotatingFile { path, mode, rotation, file, size: 0, since: Instant::now(), is_torn: false }
    }

    /// True if the file is moved aside before a line of so many bytes, when so many others are about to be written.
    pub fn is_full(&self, waiting: usize, line: usize) -> bool {
        let Rotation { size, age, .. } = self.rotation;
        let present = self.size + waiting as u64;
        let is_large = size.is_some_and(|most| present + line as u64 > most);
        present > 0 && (is_large || age.is_some_and(|most| self.since.elapsed() >= most))
    }

    /// Moves the file aside, and goes on with a new one.
    ///
    /// # Errors
    /// That is not possible. The file goes on as if it were new, so that this is tried again after the same time.
    pub fn rotate(&mut self) -> io::Result<()> {
        (self.size, self.since) = (0, Instant::now());
        move_aside(&self.path, self.rotation.keep)?;
        let new = open(&self.path, self.mode, OpenOptions::new().write(true).create_new(true))?;
        self.file = new;
        self.is_torn = false;
        Ok(())
    }

    /// Adds the line with which a file begins. It does not count as a part of its size.
    ///
    /// # Errors
    /// As [`write`](RotatingFile::write).
    pub fn begin(&mut self, line: &[u8]) -> io::Result<()> {
        self.write(line)?;
        self.size = 0;
        Ok(())
    }

    /// Adds whole lines.
    ///
    /// # Errors
    /// They are not written, or not all of them. What is written next begins on a line of its own.
    pub fn write(&mut self, lines: &[u8]) -> io::Result<()> {
        if self.is_torn {
            self.file.write_all(b"\n")?;
            self.is_torn = false;
        }
        let mut left = lines;
        while !left.is_empty() {
            match self.file.write(left) {
                Ok(0) => return Err(ErrorKind::WriteZero.into()),
                Ok(count) => {
                    self.size += count as u64;
                    left = &left[count..];
                    self.is_torn = !lines[..lines.len() - left.len()].ends_with(b"\n");
                }
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) => return Err(error),
            }
        }
        Ok(())
    }
}

/// Opens a file from whose beginning is written. It has these permissions where it is new, whatever mask code of a
/// library has set; without, those of the process.
///
/// # Errors
/// It cannot be written.
pub fn create_file(path: &Path, mode: Option<u32>) -> io::Result<File> {
    open(path, mode, OpenOptions::new().write(true).truncate(true))
}

fn open(path: &Path, mode: Option<u32>, options: &mut OpenOptions) -> io::Result<File> {
    let mut fresh = options.clone();
    let file = match fresh.truncate(false).create_new(true).open(path) {
        Err(error) if error.kind() == ErrorKind::AlreadyExists => return options.open(path),
        created => created?,
    };
    if let Some(mode) = mode {
        file.set_permissions(Permissions::from_mode(mode))?;
    }
    Ok(file)
}

/// Renames `FILE` to `FILE.1`, that to `FILE.2`, and so on, and removes what is not kept.
fn move_aside(path: &Path, keep: u32) -> io::Result<()> {
    let absent = |result: io::Result<()>| match result {
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(()),
        other => other,
    };
    // The last one that is kept is written over.
    for number in (1..keep).rev() {
        absent(fs::rename(earlier_file(path, number), earlier_file(path, number + 1)))?;
    }
    match keep {
        0 => absent(fs::remove_file(path)),
        _ => absent(fs::rename(path, earlier_file(path, 1))),
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

    use super::*;

    fn texts(folder: &Path) -> Vec<(String, String)> {
        let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap());
        let mut texts: Vec<(String, String)> = entries
            .map(|entry| (entry.file_name().into_string().unwrap(), fs::read_to_string(entry.path()).unwrap()))
            .collect();
        texts.sort();
        texts
    }

    fn add(file: &mut RotatingFile, line: &str) {
        if file.is_full(0, line.len()) {
            file.rotate().unwrap();
        }
        file.write(line.as_bytes()).unwrap();
    }

    fn named(files: &[(&str, &str)]) -> Vec<(String, String)> {
        files.iter().map(|(name, text)| ((*name).to_owned(), (*text).to_owned())).collect()
    }

    #[test]
    fn a_file_is_moved_when_it_is_full() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("log");
        let rotation = Rotation { size: Some(8), age: None, keep: 2 };
        let mut file = RotatingFile::append(path.clone(), Some(0o600), rotation).unwrap();
        for line in ["one\n", "two\n", "three\n", "longer than it may be\n", "four\n", "five\n"] {
            add(&mut file, line);
        }
        let kept = [("log", "five\n"), ("log.1", "four\n"), ("log.2", "longer than it may be\n")];
        assert_eq!(texts(folder.path()), named(&kept));
        assert_eq!(fs::metadata(&path).unwrap().permissions().mode() & 0o777, 0o600);
        // A log goes on, a journal begins anew beside the earlier one.
        let mut file = RotatingFile::append(path.clone(), None, rotation).unwrap();
        add(&mut file, "6\n");
        assert_eq!(texts(folder.path())[0], ("log".to_owned(), "five\n6\n".to_owned()));
        let mut file = RotatingFile::create(path.clone(), None, rotation).unwrap();
        add(&mut file, "7\n");
        assert_eq!(texts(folder.path()), named(&[("log", "7\n"), ("log.1", "five\n6\n"), ("log.2", "four\n")]));
        RotatingFile::create(path, None, Rotation::NONE).unwrap();
        assert_eq!(texts(folder.path()), named(&[("log", ""), ("log.1", "five\n6\n"), ("log.2", "four\n")]));
    }

    #[test]
    fn a_file_is_moved_when_it_is_old() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("log");
        let rotation = Rotation { size: None, age: Some(Duration::ZERO), keep: 0 };
        let mut file = RotatingFile::append(path.clone(), None, rotation).unwrap();
        add(&mut file, "one\n");
        add(&mut file, "two\n");
        assert_eq!(texts(folder.path()), named(&[("log", "two\n")]));
        let rotation = Rotation { age: Some(Duration::from_secs(3600)), ..rotation };
        let mut file = RotatingFile::append(path, None, rotation).unwrap();
        add(&mut file, "three\n");
        assert_eq!(texts(folder.path()), named(&[("log", "two\nthree\n")]));
    }

    #[test]
    fn what_cannot_be_moved_goes_on() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("log");
        fs::create_dir_all(folder.path().join("log.1/in the way")).unwrap();
        let rotation = Rotation { size: Some(1), age: None, keep: 1 };
        let mut file = RotatingFile::append(path.clone(), None, rotation).unwrap();
        file.write(b"one\n").unwrap();
        assert!(file.is_full(0, 1));
        assert!(file.rotate().is_err());
        file.write(b"two\n").unwrap();
        assert_eq!(fs::read_to_string(path).unwrap(), "one\ntwo\n");
    }
}
