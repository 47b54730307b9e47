//! Notes of the hardware: a line of a file for each action, with the time, the robot, and the action as people say it.

use std::fs::{self, OpenOptions};
use std::io::{self, Write};
use std::path::Path;
use std::time::{Duration, SystemTime};

use saoms_components::grid::Block;

/// Time that each action takes.
pub(crate) const TAKES: Duration = Duration::from_millis(14);

/// A line of the notes.
#[derive(Clone, Debug)]
pub(crate) struct Note {
    /// Time at which the action began, since 1970.
    pub(crate) at: Duration,
    pub(crate) robot: u32,
    /// The action, such as `move to (3,1)`, or `enters at (0,0)`.
    pub(crate) what: String,
}

impl Note {
    /// The block that it names.
    pub(crate) fn block(&self) -> Block {
        self.what.rsplit(' ').next().unwrap().parse().unwrap()
    }

    pub(crate) fn is_over(&self) -> bool {
        now() >= self.at + TAKES
    }
}

pub(crate) fn now() -> Duration {
    SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).unwrap()
}

/// All notes of a file, which need not be there.
pub(crate) fn notes(path: &Path) -> Vec<Note> {
    let note = |line: &str| {
        let mut parts = line.splitn(3, ' ');
        let at = Duration::from_nanos(parts.next()?.parse().ok()?);
        Some(Note { at, robot: parts.next()?.parse().ok()?, what: parts.next()?.to_owned() })
    };
    let text = fs::read_to_string(path).unwrap_or_default();
    text.lines().map(|line| note(line).unwrap_or_else(|| panic!("no note: {line}"))).collect()
}

/// Adds an action that begins now to a file.
#[cfg_attr(test, expect(dead_code, reason = "the tests read notes alone"))]
pub(crate) fn add(path: &Path, robot: u32, what: &str) -> io::Result<Note> {
    let mut file = OpenOptions::new().create(true).append(true).open(path)?;
    let note = Note { at: now(), robot, what: what.to_owned() };
    file.write_all(format!("{} {robot} {what}\n", note.at.as_nanos()).as_bytes())?;
    Ok(note)
}
