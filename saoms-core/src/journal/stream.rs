use std::fs::File;
use std::io::{self, Write};
use std::path::Path;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use saoms_api::Time;
use serde_json::json;

use super::batch::Batch;
use super::entry::What;
use super::recorder::{Notice, Recorder};
use super::ring::Names;
use super::{Entry, Named};

/// How many records may wait for the file.
const CAPACITY: usize = 65_536;
/// From how many waiting records on the writer is woken; before that it looks by itself.
const HURRY: usize = CAPACITY / 4;
/// How often it looks.
const PAUSE: Duration = Duration::from_millis(100);

/// Records on their way to a file. Putting one in never waits for the file.
#[derive(Debug)]
pub(crate) struct Stream {
    waiting: Mutex<Waiting>,
    filled: Condvar,
    emptied: Condvar,
    /// Whether those who write wait for room, as in virtual time; otherwise records that find no room are counted and lost.
    patient: bool,
}

#[derive(Debug, Default)]
struct Waiting {
    batch: Batch,
    names: Vec<(u32, u16, String)>,
    lost: u64,
    writers_sleep: bool,
    /// When the run ended.
    closed: Option<Time>,
}

/// How the writing ended.
#[derive(Debug, Default)]
pub(crate) struct Written {
    /// Records that are not in the file.
    pub(crate) lost: u64,
    pub(crate) error: Option<io::Error>,
}

/// The file of a journal.
#[derive(Debug)]
pub(crate) struct JournalFile {
    file: File,
    components: Vec<Arc<str>>,
    loops: Vec<Names>,
    text: Vec<u8>,
}

impl JournalFile {
    /// Begins a file: its first line says what it is and which components there are.
    pub(crate) fn create(
        path: &Path,
        seed: u64,
        simulated: bool,
        components: &[Named],
    ) -> io::Result<JournalFile> {
        let mut file = File::create(path)?;
        let clock = if simulated { "virtual" } else { "real" };
        let head = json!({ "journal": 1, "seed": seed, "clock": clock, "components": components });
        file.write_all(format!("{head}\n").as_bytes())?;
        let components: Vec<Arc<str>> =
            components.iter().map(|component| Arc::from(component.name.as_str())).collect();
        let loops = components.iter().map(|_| Names::default()).collect();
        Ok(JournalFile { file, components, loops, text: Vec::new() })
    }

    /// For tests: goes on in another file.
    #[cfg(test)]
    pub(super) fn replace(&mut self, file: File) {
        self.file = file;
    }

    fn write(&mut self, waiting: &Waiting) -> io::Result<()> {
        for (component, place, name) in &waiting.names {
            self.loops[*component as usize].set(*place, name);
        }
        self.text.clear();
        for head in waiting.batch.heads() {
            let component = head.component as usize;
            let entry = Entry {
                id: head.id,
                time: head.time(),
                component: Arc::clone(&self.components[component]),
                loop_name: self.loops[component].get(head.place),
                phase: head.phase,
                cause: head.cause,
                change: head.change,
                what: What::Noted(waiting.batch.record(head)),
            };
            serde_json::to_writer(&mut self.text, &entry)?;
            self.text.push(b'\n');
        }
        self.file.write_all(&self.text)
    }
}

impl Stream {
    pub(crate) fn new(patient: bool) -> Stream {
        Stream { waiting: Mutex::default(), filled: Condvar::new(), emptied: Condvar::new(), patient }
    }

    fn lock(&self) -> MutexGuard<'_, Waiting> {
        self.waiting.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Takes over what a component has written.
    pub(crate) fn put(&self, component: u32, recorder: &Recorder) {
        let mut waiting = self.lock();
        for notice in &recorder.notices {
            if let Notice::Name(place, name) = notice {
                waiting.names.push((component, *place, name.clone()));
            }
        }
        if waiting.batch.len() >= CAPACITY && !self.patient {
            waiting.lost += recorder.batch.len() as u64;
            return;
        }
        let before = waiting.batch.len();
        waiting.batch.append(&recorder.batch);
        if before < HURRY && waiting.batch.len() >= HURRY {
            self.filled.notify_one();
        }
    }

    /// Whether those who are patient should wait.
    pub(crate) fn is_full(&self) -> bool {
        self.patient && self.lock().batch.len() >= CAPACITY
    }

    /// Waits until it is not full any more.
    pub(crate) fn wait_for_room(&self) {
        let mut waiting = self.lock();
        while waiting.batch.len() >= CAPACITY && waiting.closed.is_none() {
            waiting.writers_sleep = true;
            waiting = self.emptied.wait(waiting).unwrap_or_else(PoisonError::into_inner);
        }
    }

    /// The run has ended: [`write_to`](Stream::write_to) returns when it has written what is there.
    pub(crate) fn close(&self, end: Time) {
        self.lock().closed = Some(end);
        self.filled.notify_all();
        self.emptied.notify_all();
    }

    /// Writes records as they come, until the stream is closed and empty. `failed` is told the first error, when it happens; after that, records
    /// are only counted.
    pub(crate) fn write_to(&self, mut file: JournalFile, failed: impl Fn(&io::Error)) -> Written {
        let mut written = Written::default();
        let mut records = 0;
        let fail = |written: &mut Written, error: io::Error| {
            failed(&error);
            written.error = Some(error);
        };
        let mut batch = Waiting::default();
        loop {
            self.next(&mut batch);
            let count = batch.batch.len() as u64;
            records += count + batch.lost;
            written.lost += batch.lost;
            let result = if written.error.is_some() { None } else { Some(file.write(&batch)) };
            match result {
                Some(Ok(())) => {}
                None => written.lost += count,
                Some(Err(error)) => {
                    written.lost += count;
                    fail(&mut written, error);
                }
            }
            if let Some(end) = batch.closed {
                let lost = written.lost;
                let end = json!({ "end": { "time_s": end.as_secs_f64(), "records": records, "lost": lost } });
                if written.error.is_none()
                    && let Err(error) = file.file.write_all(format!("{end}\n").as_bytes())
                {
                    fail(&mut written, error);
                }
                return written;
            }
        }
    }

    /// Waits until there is something to write, and takes all of it, for the memory of what was written before.
    fn next(&self, batch: &mut Waiting) {
        batch.batch.clear();
        batch.names.clear();
        let mut waiting = self.lock();
        if waiting.batch.len() < HURRY && waiting.closed.is_none() {
            waiting = self.filled.wait_timeout(waiting, PAUSE).unwrap_or_else(PoisonError::into_inner).0;
        }
        std::mem::swap(&mut batch.batch, &mut waiting.batch);
        std::mem::swap(&mut batch.names, &mut waiting.names);
        batch.lost = std::mem::take(&mut waiting.lost);
        batch.closed = waiting.closed;
        if std::mem::take(&mut waiting.writers_sleep) {
            self.emptied.notify_all();
        }
    }
}
