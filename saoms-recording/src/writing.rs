//! The thread that writes a recording.

use std::collections::BTreeMap;
use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

use crate::file::FileWriter;
use crate::queue::Batch;
use crate::recording::Shared;

/// What a killed program loses at most.
const EVERY: Duration = Duration::from_secs(1);

/// The name of the attachment with the report.
pub(crate) const REPORT: &str = "report.json";

/// What stands before all messages.
pub(crate) struct Head {
    pub(crate) name: &'static str,
    pub(crate) values: BTreeMap<String, String>,
    pub(crate) files: Vec<(String, String)>,
}

/// The file of a recording, and what it has got so far.
pub(crate) struct Writing {
    path: PathBuf,
    file: File,
    writer: FileWriter,
    /// `None` once it is written.
    head: Option<Head>,
    shared: Arc<Shared>,
    /// The numbers of the channels in the file, 0 where there is none.
    channels: Vec<u16>,
    /// True if the file took not all that was written.
    is_stuck: bool,
}

impl Writing {
    pub(crate) fn begin(path: &Path, file: File, head: Head, shared: Arc<Shared>) -> Writing {
        let (writer, path, head) = (FileWriter::begin(), path.to_owned(), Some(head));
        Writing { path, file, writer, head, shared, channels: Vec::new(), is_stuck: false }
    }

    /// Writes what comes until nothing follows.
    pub(crate) fn run(mut self) -> Writing {
        let _ending = Ending(Arc::clone(&self.shared));
        let mut batch = Batch::default();
        let mut next = Instant::now() + EVERY;
        loop {
            batch = self.shared.queue.take(next, batch);
            self.take(&mut batch);
            let now = Instant::now();
            if batch.is_last || now >= next {
                next = now + EVERY;
                self.writer.end_chunk();
            }
            self.bring();
            if batch.is_last {
                return self;
            }
        }
    }

    fn take(&mut self, batch: &mut Batch) {
        if !batch.items.is_empty() {
            self.begin_file();
        }
        for form in &batch.channels {
            let channel = self.writer.channel(form);
            self.channels.push(channel);
        }
        let (count, mut lost) = (batch.items.len() as u64, 0);
        for item in &mut batch.items {
            item.channel = self.channels.get(usize::from(item.channel)).copied().unwrap_or(0);
            if item.channel == 0 {
                item.sender = None;
                lost += 1;
            }
        }
        if self.is_stuck {
            // What has no room in the file does not fill the memory instead.
            lost = count;
        } else {
            self.writer.write(&batch.items, &batch.bytes);
        }
        self.shared.lost.fetch_add(lost, Ordering::Relaxed);
        self.shared.written.fetch_add(count - lost, Ordering::Relaxed);
    }

    /// Writes what stands before all messages. The start of the run is known with the first one.
    fn begin_file(&mut self) {
        let Some(Head { name, mut values, files }) = self.head.take() else { return };
        let start = self.shared.start.load(Ordering::Relaxed);
        values.insert("start_ns".to_owned(), start.to_string());
        self.writer.metadata(name, &values);
        for (name, text) in files {
            let is_xml = text.trim_start_matches('\u{feff}').trim_start().starts_with('<');
            let media_type = if is_xml { "application/xml" } else { "text/plain" };
            self.writer.attach(&name, media_type, start, text.as_bytes());
        }
    }

    /// Brings to the file what has no place there yet.
    fn bring(&mut self) {
        match self.writer.bring(&mut self.file) {
            Ok(()) => {
                if std::mem::take(&mut self.is_stuck) {
                    self.shared.events.works();
                }
            }
            Err(error) => {
                if !self.is_stuck {
                    self.fails(&error);
                }
                self.is_stuck = true;
            }
        }
    }

    fn fails(&self, error: &io::Error) {
        let path = self.path.display();
        self.shared.events.fails(&format!("the recording cannot be written to `{path}`: {error}; messages are lost"));
    }

    /// Ends the file with the report of the run and values by name.
    pub(crate) fn end(&mut self, time: u64, report: &[u8], (name, values): (&str, &BTreeMap<String, String>)) {
        self.begin_file();
        self.writer.attach(REPORT, "application/json", time, report);
        self.writer.metadata(name, values);
        self.finish();
    }

    /// Ends the file.
    pub(crate) fn finish(&mut self) {
        self.writer.finish();
        self.bring();
        // How much is missing nobody knows.
        self.shared.lost.fetch_add(u64::from(self.is_stuck), Ordering::Relaxed);
    }
}

/// Has nobody wait for a thread that is gone.
struct Ending(Arc<Shared>);

impl Drop for Ending {
    fn drop(&mut self) {
        self.0.queue.close();
    }
}
