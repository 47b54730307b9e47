use std::collections::BTreeMap;
use std::fs;
use std::io::{self, Write};
use std::os::unix::fs::PermissionsExt;
use std::path::Path;
use std::sync::atomic::Ordering;
use std::sync::{Arc, Mutex};

use saoms_api::extension::{DrawingRegistration, DrawnMessage, RunDrawing};
use saoms_api::host::{SharedMessage, TopicDeclaration};
use saoms_api::{Cause, Header, Level, Message, Time, Topic};
use saoms_core::observe::{Beginning, LostEvents, Observer, Occurrence, RunEvent, SentMessage, WriterEvents};

use crate::drawer::{Drawer, HeardTopic};
use crate::file::{ChannelForm, FileWriter, Item};
use crate::{Excerpt, Part, Reader, RecordedRun, Recording, drawer};

const LAMP: &str = r#"{"name":"Lamp","fields":[{"name":"on","type":"bool"},{"name":"mode","type":
    {"enumeration":"uint8","values":{"WARM":0,"COLD":1}}}]}"#;

/// A file with messages of a lamp, of which `cut` bytes are missing.
fn written(path: &Path, cut: usize) {
    let mut writer = FileWriter::begin();
    writer.metadata("saoms", &BTreeMap::from([("start_ns".to_owned(), "5".to_owned())]));
    let lamp = writer.channel(&ChannelForm::of("LAMP", LAMP, None).unwrap());
    let bytes = [[0, 1, 0, 0, 1, 1], [0, 1, 0, 0, 0, 0]].concat();
    let item = |sender: &str, end| Item { channel: lamp, sender: Some(Arc::from(sender)), time: 7, end };
    for _ in 0..2 {
        writer.write(&[item("hall/A", 6), item("hall/B", 12)], &bytes);
        writer.end_chunk();
    }
    writer.attach("f.composite", "application/xml", 5, b"<composite/>");
    writer.finish();
    let mut file = Vec::new();
    writer.bring(&mut file).unwrap();
    file.truncate(file.len() - cut);
    fs::write(path, file).unwrap();
}

fn read(path: &Path) -> (Vec<String>, Option<String>) {
    let mut reader = Reader::open(path).unwrap();
    let mut found = Vec::new();
    while let Some(part) = reader.next_part().unwrap() {
        found.push(match part {
            Part::Message(one) => format!("{:?} {} {}", one.component, one.channel.topic(), one.json().unwrap()),
            Part::File(file) => file.name,
            Part::Values(name, _) => name,
        });
    }
    (found, reader.cut().map(str::to_owned))
}

#[test]
fn what_is_written_is_read_and_copied_also_if_it_was_cut_off() {
    let folder = tempfile::tempdir().unwrap();
    let (whole, copy, cut) = (folder.path().join("w"), folder.path().join("c"), folder.path().join("x"));
    written(&whole, 0);
    let a = r#"Some("hall/A") LAMP {"mode":"COLD","on":true}"#;
    let b = r#"Some("hall/B") LAMP {"mode":"WARM","on":false}"#;
    assert_eq!(read(&whole), (["saoms", a, b, a, b, "f.composite"].map(str::to_owned).to_vec(), None));
    let mut bytes = Vec::new();
    let mut copied = Excerpt::begin(&mut bytes);
    let mut reader = Reader::open(&whole).unwrap();
    while let Some(part) = reader.next_part().unwrap() {
        copied.add(&part).unwrap();
    }
    copied.finish().unwrap();
    fs::write(&copy, bytes).unwrap();
    assert_eq!(read(&copy), read(&whole));
    // Wherever it ends, each part before is read.
    let length = fs::metadata(&whole).unwrap().len() as usize;
    let mut most = 0;
    for left in (20..length).step_by(7) {
        written(&cut, length - left);
        if let Ok(mut reader) = Reader::open(&cut) {
            let mut count = 0;
            while reader.next_part().unwrap().is_some() {
                count += 1;
            }
            assert!(reader.cut().is_some() && count >= most, "{left}: {count} after {most}");
            most = count;
        }
    }
    assert_eq!(most, 6);
    fs::write(&cut, "no recording").unwrap();
    let error = Reader::open(&cut).unwrap_err().to_string();
    assert!(error.contains("is no recording"), "{error}");
}

#[test]
fn a_file_that_is_damaged_anywhere_is_read_without_a_panic() {
    let folder = tempfile::tempdir().unwrap();
    let (path, wrong) = (folder.path().join("w"), folder.path().join("x"));
    written(&path, 0);
    let file = fs::read(&path).unwrap();
    let mut told = 0;
    for place in (8..file.len()).step_by(5) {
        let mut bytes = file.clone();
        bytes[place] ^= 0x55;
        fs::write(&wrong, bytes).unwrap();
        let mut reader = Reader::open(&wrong).unwrap();
        let mut parts = 0;
        let ended = loop {
            match reader.next_part() {
                Ok(Some(_)) => parts += 1,
                ended => break ended,
            }
        };
        assert!(parts <= 6);
        told += u64::from(ended.is_err() || reader.cut().is_some());
    }
    assert!(told > 50, "{told}");
    // An attachment without its checksum.
    let mut bytes = [mcap::MAGIC, &[9, 32], &[0; 7]].concat();
    bytes.extend([0; 32]);
    fs::write(&wrong, bytes).unwrap();
    assert_eq!(read(&wrong), (vec![], Some("it is damaged".to_owned())));
}

/// A disk with so much room.
struct Disk(Vec<u8>, usize);

impl Write for Disk {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let count = bytes.len().min(self.1);
        if count == 0 && !bytes.is_empty() {
            return Err(io::ErrorKind::StorageFull.into());
        }
        self.1 -= count;
        self.0.extend_from_slice(&bytes[..count]);
        Ok(count)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[test]
fn a_full_disk_gets_the_rest_when_it_has_room() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("f");
    let mut writer = FileWriter::begin();
    writer.metadata("saoms", &BTreeMap::new());
    let mut disk = Disk(Vec::new(), 10);
    assert!(writer.bring(&mut disk).is_err());
    disk.1 = 1000;
    writer.bring(&mut disk).unwrap();
    writer.finish();
    writer.bring(&mut disk).unwrap();
    fs::write(&path, disk.0).unwrap();
    assert_eq!(read(&path), (vec!["saoms".to_owned()], None));
}

/// What was told of failures.
#[derive(Clone, Default)]
struct Told(Arc<Mutex<Vec<String>>>);

impl WriterEvents for Told {
    fn fails(&self, text: &str) {
        self.0.lock().unwrap().push(text.to_owned());
    }

    fn works(&self) {}
}

#[test]
fn what_the_disk_does_not_take_is_counted_and_told_once() {
    let told = Told::default();
    let recording = Recording::new(Path::new("/dev/full"), None, RecordedRun::default(), Box::new(told.clone()));
    recording.begin(&Beginning { seed: 0, is_virtual: true, components: &[] }).unwrap();
    let event = |text: &str| {
        let what = Occurrence::Note { level: Level::Info, text: text.to_owned() };
        recording.event(&RunEvent { time: Time::START, component: None, what });
    };
    // More than wakes the thread at once.
    event(&"a".repeat(1 << 20));
    while told.0.lock().unwrap().is_empty() {
        std::thread::yield_now();
    }
    (0..7).for_each(|_| event("b"));
    Observer::lost(&recording, LostEvents { alerts: 1, messages: 5 });
    let lost = recording.lost();
    drop(recording);
    assert!(lost.load(Ordering::Relaxed) >= 7 + 5, "{lost:?}");
    let told = told.0.lock().unwrap();
    assert!(told.len() == 2 && told[0].contains("cannot be written to `/dev/full`"), "{told:?}");
    assert!(told[1].contains("`/dev/full` has no end"), "{told:?}");
}

/// A lamp, before and after a change of the fleet.
#[derive(Clone, Debug, Message)]
#[message(name = "Lamp")]
struct OldLamp {
    on: bool,
}

#[derive(Clone, Debug, Message)]
#[message(name = "Lamp")]
struct NewLamp {
    level: f64,
}

fn sent<M: Message>(nanos: u64, message: M) -> SentMessage {
    let header = Header { sender: 0, sent: Time::from_nanos(nanos), cause: Cause::default() };
    let message = SharedMessage::new(header, message);
    SentMessage { topic: Arc::from("LAMP"), component: Arc::from("hall/A"), message, is_of_other: false }
}

#[test]
fn a_topic_may_have_messages_of_another_type_after_a_change() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("f");
    let told = Box::new(Told::default());
    // Permissions are those that are wanted, whatever the mask of the process is.
    let recording = Recording::new(&path, Some(0o666), RecordedRun::default(), told);
    recording.begin(&Beginning { seed: 0, is_virtual: true, components: &[] }).unwrap();
    assert!(recording.wants_topic("LAMP", &Topic::<OldLamp>::state("LAMP").declaration()));
    recording.message(&sent(1, OldLamp { on: true }));
    assert!(recording.wants_topic("LAMP", &Topic::<NewLamp>::state("LAMP").declaration()));
    recording.message(&sent(2, NewLamp { level: 0.5 }));
    drop(recording);
    let lines = [r#"Some("hall/A") LAMP {"on":true}"#, r#"Some("hall/A") LAMP {"level":0.5}"#];
    assert_eq!(read(&path), (["saoms", lines[0], lines[1]].map(str::to_owned).to_vec(), None));
    assert_eq!(fs::metadata(&path).unwrap().permissions().mode() & 0o777, 0o666);
}

#[test]
fn a_full_file_is_whole_and_the_next_one_goes_on() {
    let folder = tempfile::tempdir().unwrap();
    let (path, next) = (folder.path().join("run.mcap"), folder.path().join("run-2.mcap"));
    let run = RecordedRun { limit: Some(1), ..RecordedRun::default() };
    let recording = Recording::new(&path, None, run, Box::new(Told::default()));
    recording.begin(&Beginning { seed: 0, is_virtual: true, components: &[] }).unwrap();
    let event = |text: String| {
        let what = Occurrence::Note { level: Level::Info, text };
        recording.event(&RunEvent { time: Time::START, component: None, what });
    };
    // More than wakes the thread at once.
    event("a".repeat(1 << 20));
    while !next.exists() {
        std::thread::yield_now();
    }
    event("b".to_owned());
    drop(recording);
    let (first, cut) = read(&path);
    assert_eq!((first.len(), &*first[0], &*first[2], cut), (3, "saoms", "saoms.end", None));
    let (second, cut) = read(&next);
    assert!(second[0] == "saoms" && second[1].contains("\"msg\":\"b\"") && cut.is_none(), "{second:?}");
}

/// A drawing that says how many messages it heard.
#[derive(Default)]
struct Heard(u8, bool);

static HEARD: DrawingRegistration =
    DrawingRegistration { topics: &["heard"], wants: |_| true, new: || Box::new(Heard::default()) };

impl RunDrawing for Heard {
    fn topic(&mut self, _: &str, _: &TopicDeclaration<'_>) {}

    fn message(&mut self, _: &str, _: &SharedMessage) {
        self.0 += 1;
    }

    fn draw(&mut self, _: Time) -> Vec<DrawnMessage> {
        vec![DrawnMessage { topic: "/heard".to_owned(), schema: LAMP, bytes: vec![self.0] }]
    }

    fn begin_again(&mut self) {
        self.1 = true;
    }
}

#[test]
fn a_run_is_drawn_ten_times_a_second_at_most_and_only_where_it_has_changed() {
    let mut drawer = Drawer::new(&[&HEARD]);
    let declared = Topic::<OldLamp>::state("LAMP").declaration();
    drawer.hear(drawer::Heard::Topic(HeardTopic::of("LAMP", &declared)), Time::as_nanos);
    let mut drawn = Vec::new();
    let mut draw = |drawer: &mut Drawer, before: u64| {
        if let Some(due) = drawer.due_before(before) {
            drawn.push((due / 1_000_000, drawer.draw(due)[0].bytes[0]));
        }
    };
    for millis in [0, 0, 50, 120, 130, 700] {
        let message = sent(millis * 1_000_000, OldLamp { on: true }).message;
        draw(&mut drawer, millis * 1_000_000);
        drawer.hear(drawer::Heard::Message(0, message), Time::as_nanos);
    }
    draw(&mut drawer, u64::MAX);
    draw(&mut drawer, u64::MAX);
    assert_eq!(drawn, [(0, 2), (100, 3), (200, 5), (700, 6)]);
}
