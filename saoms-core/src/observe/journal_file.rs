use std::fmt;
use std::fs::File;
use std::io::{self, Write};
use std::path::PathBuf;
use std::sync::{Mutex, PoisonError};
use std::time::{SystemTime, UNIX_EPOCH};

use saoms_api::{Failure, Time};
use serde_json::json;

use super::rotation::{RotatingFile, Rotation};
use super::{Beginning, Interest, Observer, Records};
use crate::journal::ComponentName;

/// What tells a problem that hinders nothing.
type Tell = Box<dyn Fn(&str) + Send + Sync>;

/// An observer that writes every record of the journal to a file, as lines of JSON.
///
/// The file is created when the fleet starts, and holds whole lines at any time but while one is written. The first
/// line holds the format version and the components, the last one the end of the run. A file that is moved aside is a
/// part of the journal: its first line also says of which run, and what the parts before it had.
pub struct JournalFile {
    path: PathBuf,
    /// Permissions of the file where it is new; without, those of the process.
    mode: Option<u32>,
    rotation: Rotation,
    tell: Tell,
    /// What is written in place of a file at the path.
    given: Mutex<Option<File>>,
    file: Mutex<Option<Open>>,
}

struct Open {
    file: RotatingFile,
    head: Head,
    text: Vec<u8>,
    records: u64,
    lost: u64,
    /// True if it was told that the file cannot be moved aside.
    stays: bool,
}

/// What the first line says.
struct Head {
    seed: u64,
    clock: &'static str,
    components: Vec<ComponentName>,
    /// The run and the number of the part, of a file that is moved aside.
    part: Option<(String, u32)>,
}

impl JournalFile {
    /// The observer that writes to this path.
    pub fn new(path: impl Into<PathBuf>) -> JournalFile {
        JournalFile {
            path: path.into(),
            mode: None,
            rotation: Rotation::NONE,
            tell: Box::new(|_| {}),
            given: Mutex::default(),
            file: Mutex::default(),
        }
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

    /// The same observer, which moves its file aside. `tell` tells that this is not possible: then the file grows.
    #[must_use]
    pub fn with_rotation(self, rotation: Rotation, tell: impl Fn(&str) + Send + Sync + 'static) -> JournalFile {
        JournalFile { rotation, tell: Box::new(tell), ..self }
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
        let file = match given {
            Some(file) => Ok(RotatingFile::of(file, self.path.clone())),
            None => RotatingFile::create(self.path.clone(), self.mode, self.rotation),
        };
        let open = file
            .and_then(|file| Open::begin(file, self.rotation.is_any(), beginning))
            .map_err(|error| Failure::new(format!("the journal cannot be written: {error}")))?;
        *self.file.lock().unwrap_or_else(PoisonError::into_inner) = Some(open);
        Ok(())
    }

    fn records(&self, records: &Records<'_>) -> Result<(), Failure> {
        let mut file = self.file.lock().unwrap_or_else(PoisonError::into_inner);
        let Some(open) = &mut *file else { return Ok(()) };
        open.write(records, &self.tell).map_err(|error| {
            let path = self.path.display();
            Failure::new(format!("the journal could not be written to `{path}`: {error}"))
        })
    }
}

impl Open {
    fn begin(file: RotatingFile, rotates: bool, beginning: &Beginning<'_>) -> io::Result<Open> {
        // Two runs never begin in the same nanosecond at the same path.
        let now = || SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default().as_nanos();
        let head = Head {
            seed: beginning.seed,
            clock: if beginning.is_virtual { "virtual" } else { "real" },
            components: beginning.components.to_vec(),
            part: rotates.then(|| (format!("{:x}", now()), 0)),
        };
        let mut open = Open { file, head, text: Vec::new(), records: 0, lost: 0, stays: false };
        open.write_head()?;
        Ok(open)
    }

    fn write_head(&mut self) -> io::Result<()> {
        let Head { seed, clock, components, part } = &self.head;
        let mut head = json!({ "journal": 1, "seed": seed, "clock": clock, "components": components });
        if let Some((run, number)) = part {
            head["part"] = json!({ "run": run, "number": number, "records": self.records, "lost": self.lost });
        }
        self.file.begin(format!("{head}\n").as_bytes())
    }

    fn write(&mut self, records: &Records<'_>, tell: &Tell) -> io::Result<()> {
        self.text.clear();
        for component in records.joined {
            writeln!(self.text, "{}", json!({ "joined": component }))?;
        }
        if self.head.part.is_some() {
            self.head.components.extend_from_slice(records.joined);
        }
        (self.records, self.lost) = (self.records + records.lost, self.lost + records.lost);
        for entry in records.entries {
            let before = self.text.len();
            serde_json::to_writer(&mut self.text, entry)?;
            self.text.push(b'\n');
            if self.file.is_full(before, self.text.len() - before) {
                self.file.write(&self.text[..before])?;
                self.text.drain(..before);
                self.rotate(tell)?;
            }
            self.records += 1;
        }
        if let Some(end) = records.end {
            let (time_s, records, lost) = (Time::as_secs_f64(end), self.records, self.lost);
            let end = json!({ "end": { "time_s": time_s, "records": records, "lost": lost } });
            writeln!(self.text, "{end}")?;
        }
        self.file.write(&self.text)
    }

    fn rotate(&mut self, tell: &Tell) -> io::Result<()> {
        match self.file.rotate() {
            Ok(()) => {
                if let Some((_, number)) = &mut self.head.part {
                    *number += 1;
                }
                self.write_head()
            }
            Err(error) => {
                if !std::mem::replace(&mut self.stays, true) {
                    tell(&format!("the journal could not be rotated: {error}; its file keeps growing"));
                }
                Ok(())
            }
        }
    }
}
