use std::collections::BTreeMap;
use std::fs;
use std::io::{self, Write};
use std::path::Path;
use std::sync::atomic::Ordering;
use std::sync::{Arc, Mutex};

use saoms_api::{Level, Time};
use saoms_core::observe::{Beginning, LostEvents, Observer, Occurrence, RunEvent};

use crate::file::{ChannelForm, FileWriter, Item};
use crate::{Excerpt, Part, Reader, RecordedRun, Recording, RecordingEvents, RosType};

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

#[test]
fn types_have_the_form_that_ros_gives_the_same_bytes() {
    let schema = r#"{"name":"Plan","fields":[
        {"name":"stage","type":{"enumeration":"uint8","values":{"ASKED":0,"DONE":1}}},
        {"name":"at","type":"time"},
        {"name":"chargeX","type":{"array":"int32","length":2}},
        {"name":"names","type":{"bounded":{"sequence":{"bounded":"string","most":5}},"most":3}},
        {"name":"rows","type":{"sequence":{"sequence":{"name":"Block","fields":[{"name":"x","type":"int32"}]}}}},
        {"name":"stamp","type":{"name":"builtin_interfaces/msg/Time","fields":[{"name":"sec","type":"int32"}]}},
        {"name":"other","type":{"optional":{"name":"Block","fields":[]}}}]}"#;
    let line = "=".repeat(80);
    let expected = format!(
        "uint8 STAGE_ASKED=0\nuint8 STAGE_DONE=1\nuint8 stage\n# Nanoseconds since the start of the run.\nuint64 at\n\
         int32[2] charge_x\nstring<=5[<=3] names\nsaoms_msgs/PlanRows[] rows\nbuiltin_interfaces/Time stamp\n\
         saoms_msgs/Block2[<=1] other\n{line}\nMSG: saoms_msgs/Block\nint32 x\n{line}\nMSG: saoms_msgs/PlanRows\n\
         saoms_msgs/Block[] value\n{line}\nMSG: builtin_interfaces/Time\nint32 sec\n{line}\nMSG: saoms_msgs/Block2\n\
         uint8 structure_needs_at_least_one_member\n"
    );
    let found = RosType::of(schema).unwrap();
    assert_eq!((&*found.name, &*found.text), ("saoms_msgs/msg/Plan", &*expected));
    assert_eq!(RosType::of(r#"{"name":"nav_msgs/msg/Path","fields":[]}"#).unwrap().name, "nav_msgs/msg/Path");
}

/// What was told of failures.
#[derive(Default)]
struct Told(Mutex<Vec<String>>);

impl RecordingEvents for Arc<Told> {
    fn fails(&self, text: &str) {
        self.0.lock().unwrap().push(text.to_owned());
    }

    fn works(&self) {}
}

#[test]
fn what_the_disk_does_not_take_is_counted_and_told_once() {
    let told = Arc::new(Told::default());
    let recording = Recording::new(Path::new("/dev/full"), None, RecordedRun::default(), Box::new(Arc::clone(&told)));
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
    assert!(told.len() == 1 && told[0].contains("cannot be written to `/dev/full`"), "{told:?}");
}
