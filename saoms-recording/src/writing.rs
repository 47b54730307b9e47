//! The thread that writes a recording.

use std::collections::{BTreeMap, HashMap};
use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use saoms_core::observe::create_file;

use crate::drawer::{Drawer, Heard};
use crate::file::{ChannelForm, END, FileWriter, Item, RUN};
use crate::queue::Batch;
use crate::recording::Shared;

/// What a killed program loses at most.
const EVERY: Duration = Duration::from_secs(1);
/// Chunks of a file after which another one begins, since their index is in memory: 18 hours, or 64 GB of
/// messages.
const MOST_CHUNKS: u64 = 1 << 16;

/// The name of the file in a recording that is the report of its run.
pub const REPORT: &str = "report.json";
/// What the metadata of a channel say of one that has drawings.
pub(crate) const DRAWING: &str = "drawing";

/// What stands before all messages.
pub(crate) struct Head {
    pub(crate) values: BTreeMap<String, String>,
    pub(crate) files: Vec<(String, String)>,
}

/// The files of a recording: `run.mcap`, `run-2.mcap` and so on.
pub(crate) struct Place {
    path: PathBuf,
    mode: Option<u32>,
    limit: u64,
    part: u32,
}

/// The file of a recording, and what it has got so far.
pub(crate) struct Writing {
    place: Place,
    file: File,
    writer: FileWriter,
    head: Head,
    /// The size of the file with that, once it has it.
    head_size: Option<u64>,
    shared: Arc<Shared>,
    /// The channels of the run, and their numbers in the file, 0 where there is none.
    forms: Vec<ChannelForm>,
    channels: Vec<u16>,
    drawer: Drawer,
    /// The topics that are recorded, if not all are, and the numbers of the channels of drawings.
    chosen: Option<Vec<String>>,
    drawn: HashMap<String, u16>,
    /// What was lost before this file.
    lost: u64,
    /// True once the file has its end, until there is the next one.
    is_over: bool,
}

impl Place {
    pub(crate) fn new(path: PathBuf, mode: Option<u32>, limit: Option<u64>) -> Place {
        Place { path, mode, limit: limit.unwrap_or(u64::MAX), part: 1 }
    }

    fn part(&self, part: u32) -> PathBuf {
        path_of_part(&self.path, part)
    }
}

/// The path of a part of a recording, from 1 on: after `run.mcap` comes `run-2.mcap`.
pub fn path_of_part(recording: &Path, part: u32) -> PathBuf {
    if part <= 1 {
        return recording.to_owned();
    }
    let mut name = recording.file_stem().unwrap_or_default().to_owned();
    name.push(format!("-{part}"));
    if let Some(ending) = recording.extension() {
        name.push(".");
        name.push(ending);
    }
    recording.with_file_name(name)
}

impl Writing {
    pub(crate) fn begin(
        (place, file): (Place, File),
        head: Head,
        (drawer, chosen): (Drawer, Option<Vec<String>>),
        shared: Arc<Shared>,
    ) -> Writing {
        let (writer, forms, channels, drawn) = (FileWriter::begin(), Vec::new(), Vec::new(), HashMap::new());
        let (head_size, is_over, lost) = (None, false, 0);
        Writing { place, file, writer, head, head_size, shared, forms, channels, drawer, chosen, drawn, lost, is_over }
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
                self.draw_what_is_due(batch.is_last);
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
        for form in batch.channels.drain(..) {
            self.channels.push(self.writer.channel(&form));
            self.forms.push(form);
        }
        let count = batch.items.len() as u64;
        for item in &mut batch.items {
            item.channel = self.channels.get(usize::from(item.channel)).copied().unwrap_or(0);
        }
        // What has no room in the file does not fill the memory instead.
        let lost = if self.loses() { count } else { self.writer.write(&batch.items, &batch.bytes) };
        self.shared.lost.fetch_add(lost, Ordering::Relaxed);
        self.shared.written.fetch_add(count - lost, Ordering::Relaxed);
        let start = self.shared.start.load(Ordering::Relaxed);
        for heard in batch.heard.drain(..) {
            let at = |time: saoms_api::Time| start.saturating_add(time.as_nanos());
            if let Heard::Message(_, message) = &heard
                && let Some(due) = self.drawer.due_before(at(message.header().sent))
            {
                self.draw(due);
            }
            self.drawer.hear(heard, at);
        }
    }

    /// True if nothing is written now.
    fn loses(&self) -> bool {
        self.shared.is_stuck.load(Ordering::Relaxed) || self.is_over
    }

    /// Draws what waits for messages that do not come. In virtual time they come.
    fn draw_what_is_due(&mut self, is_last: bool) {
        let now = match (is_last, self.shared.waits.load(Ordering::Relaxed)) {
            (true, _) => u64::MAX,
            (false, true) => return,
            (false, false) => {
                let now = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default().as_nanos();
                u64::try_from(now).unwrap_or(u64::MAX)
            }
        };
        if let Some(due) = self.drawer.due_before(now) {
            self.draw(due);
        }
    }

    fn draw(&mut self, at: u64) {
        let drawn = self.drawer.draw(at);
        if self.loses() {
            return;
        }
        self.begin_file();
        let (mut items, mut bytes) = (Vec::new(), Vec::new());
        for one in drawn {
            if self.chosen.as_ref().is_some_and(|chosen| !chosen.contains(&one.topic)) {
                continue;
            }
            let channel = match self.drawn.get(&one.topic) {
                Some(known) => *known,
                None => {
                    let form = ChannelForm::of(&one.topic, one.schema, Some(DRAWING));
                    let channel = form.map_or(0, |form| self.writer.channel(&form));
                    self.drawn.insert(one.topic, channel);
                    channel
                }
            };
            bytes.extend_from_slice(&one.bytes);
            items.push(Item { channel, sender: None, time: at, end: bytes.len() });
        }
        self.writer.write(&items, &bytes);
    }

    /// Writes what stands before all messages. The start of the run is known with the first one.
    fn begin_file(&mut self) {
        if self.head_size.is_some() {
            return;
        }
        let Head { values, files } = &self.head;
        let (mut values, start) = (values.clone(), self.shared.start.load(Ordering::Relaxed));
        values.insert("start_ns".to_owned(), start.to_string());
        if self.place.part > 1 {
            values.insert("part".to_owned(), self.place.part.to_string());
        }
        self.writer.metadata(RUN, &values);
        for (name, text) in files {
            let is_xml = text.trim_start_matches('\u{feff}').trim_start().starts_with('<');
            let media_type = if is_xml { "application/xml" } else { "text/plain" };
            self.writer.attach(name, media_type, start, text.as_bytes());
        }
        self.head_size = Some(self.writer.size());
    }

    /// Brings to the file what has no place there yet, and begins another file where this one is full.
    fn bring(&mut self) {
        let of_messages = self.writer.size().saturating_sub(self.head_size.unwrap_or_default());
        let is_full = of_messages >= self.place.limit || self.writer.chunks() >= MOST_CHUNKS;
        if is_full && !self.loses() && self.writer.is_open() {
            self.end_part();
        }
        let brought = self.writer.bring(&mut self.file);
        match brought.and_then(|()| if self.is_over { self.next_part() } else { Ok(()) }) {
            Ok(()) => {
                if self.shared.is_stuck.swap(false, Ordering::Relaxed) {
                    // What was not drawn meanwhile is not known to those who read.
                    self.drawer.begin_again();
                    self.shared.tell_that_it_works();
                }
            }
            Err(error) => {
                if !self.shared.is_stuck.swap(true, Ordering::Relaxed) {
                    self.fails(&error);
                }
            }
        }
    }

    fn fails(&self, error: &io::Error) {
        let path = self.place.part(self.place.part + u32::from(self.is_over));
        let path = path.display();
        self.shared.events.fails(&format!("the recording cannot be written to `{path}`: {error}; messages are lost"));
    }

    /// Ends the file, which another one follows.
    fn end_part(&mut self) {
        self.say_what_is_lost();
        self.writer.finish();
        self.is_over = true;
    }

    fn next_part(&mut self) -> io::Result<()> {
        let part = self.place.part + 1;
        self.file = create_file(&self.place.part(part), self.place.mode)?;
        (self.place.part, self.writer, self.head_size, self.is_over) = (part, FileWriter::begin(), None, false);
        self.begin_file();
        self.channels = self.forms.iter().map(|form| self.writer.channel(form)).collect();
        self.drawn.clear();
        self.drawer.begin_again();
        Ok(())
    }

    /// Says what this file lacks.
    fn say_what_is_lost(&mut self) {
        let lost = self.shared.lost.load(Ordering::Relaxed);
        let here = lost - std::mem::replace(&mut self.lost, lost);
        self.writer.metadata(END, &BTreeMap::from([("lost".to_owned(), here.to_string())]));
    }

    /// Ends the last file with the report of the run.
    pub(crate) fn end(&mut self, time: u64, report: &[u8]) {
        if self.is_over {
            self.bring();
        }
        self.begin_file();
        self.writer.attach(REPORT, "application/json", time, report);
        self.say_what_is_lost();
        self.finish();
    }

    /// Ends the file.
    pub(crate) fn finish(&mut self) {
        self.is_over = false;
        self.writer.finish();
        self.bring();
        if self.shared.is_stuck.load(Ordering::Relaxed) {
            let path = self.place.part(self.place.part).display().to_string();
            self.shared
                .events
                .fails(&format!("the recording `{path}` has no end: no report, no index, and maybe not all messages"));
            // How much is missing nobody knows.
            self.shared.lost.fetch_add(1, Ordering::Relaxed);
        }
    }
}

/// Has nobody wait for a thread that is gone.
struct Ending(Arc<Shared>);

impl Drop for Ending {
    fn drop(&mut self) {
        self.0.queue.close();
    }
}
