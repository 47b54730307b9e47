use std::fmt;
use std::fs::{File, Permissions};
use std::io::{self, ErrorKind, Write};
use std::os::unix::fs::PermissionsExt;
use std::path::PathBuf;
use std::sync::{Mutex, PoisonError};

use saoms_api::{Failure, Time};
use serde_json::json;

use super::{Beginning, Interest, Observer, Records};

/// An observer that writes every record of the journal to a file, as lines of JSON.
///
/// The file is created when the fleet starts, and holds whole lines at any time but while one is written. The first
/// line holds the format version and the components, the last one the end of the run.
pub struct JournalFile {
    path: PathBuf,
    /// Permissions of the file where it is new; without, those of the process.
    mode: Option<u32>,
    /// What is written in place of a file at the path.
    given: Mutex<Option<File>>,
    file: Mutex<Option<Open>>,
}

struct Open {
    file: File,
    text: Vec<u8>,
    records: u64,
    lost: u64,
}

impl JournalFile {
    /// The observer that writes to this path.
    pub fn new(path: impl Into<PathBuf>) -> JournalFile {
        JournalFile { path: path.into(), mode: None, given: Mutex::default(), file: Mutex::default() }
    }

    /// The observer that writes to an open file, as a pipe, that messages call by this path.
    pub fn to(file: File, path: impl Into<PathBuf>) -> JournalFile {
        JournalFile { given: Mutex::new(Some(file)), ..JournalFile::new(path) }
    }

    /// The same observer, whose file has these permissions where it is new, whatever mask code of a library has set.
    #[must_use]
    pub fn with_mode(self, mode: Option<u32>) -> JournalFile {
        JournalFile { mode, ..self }
    }

    fn create(&self) -> io::Result<File> {
        let file = match File::create_new(&self.path) {
            Err(error) if error.kind() == ErrorKind::AlreadyExists => return File::create(&self.path),
            created => created?,
        };
        if let Some(mode) = self.mode {
            file.set_permissions(Permissions::from_mode(mode))?;
        }
        Ok(file)
    }
}

impl fmt::Debug for JournalFile {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.debug_tuple("JournalFile").field(&self.path).finish()
    }
}

impl Observer for JournalFile {
    fn interest(&self) -> Interest {
        Interest { journal: true, ..Interest::NONE }
    }

    fn begin(&self, beginning: &Beginning<'_>) -> Result<(), Failure> {
        let given = self.given.lock().unwrap_or_else(PoisonError::into_inner).take();
        let open = given
            .map_or_else(|| self.create(), Ok)
            .and_then(|file| Open::begin(file, beginning))
            .map_err(|error| Failure::new(format!("the journal cannot be written: {error}")))?;
        *self.file.lock().unwrap_or_else(PoisonError::into_inner) = Some(open);
        Ok(())
    }

    fn records(&self, records: &Records<'_>) -> Result<(), Failure> {
        let mut file = self.file.lock().unwrap_or_else(PoisonError::into_inner);
        let Some(open) = &mut *file else { return Ok(()) };
        open.write(records).map_err(|error| {
            let path = self.path.display();
            Failure::new(format!("the journal could not be written to `{path}`: {error}"))
        })
    }
}

impl Open {
    fn begin(mut file: File, beginning: &Beginning<'_>) -> io::Result<Open> {
        let clock = if beginning.is_virtual { "virtual" } else { "real" };
        let head = json!({
            "journal": 1, "seed": beginning.seed, "clock": clock, "components": beginning.components
        });
        file.write_all(format!("{head}\n").as_bytes())?;
        Ok(Open { file, text: Vec::new(), records: 0, lost: 0 })
    }

    fn write(&mut self, records: &Records<'_>) -> io::Result<()> {
        self.records += records.entries.len() as u64 + records.lost;
        self.lost += records.lost;
        self.text.clear();
        for component in records.joined {
            writeln!(self.text, "{}", json!({ "joined": component }))?;
        }
        for entry in records.entries {
            serde_json::to_writer(&mut self.text, entry)?;
            self.text.push(b'\n');
        }
        if let Some(end) = records.end {
            let (time_s, records, lost) = (Time::as_secs_f64(end), self.records, self.lost);
            let end = json!({ "end": { "time_s": time_s, "records": records, "lost": lost } });
            writeln!(self.text, "{end}")?;
        }
        self.file.write_all(&self.text)
    }
}
