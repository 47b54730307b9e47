#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

pub(super) mod power;

use std::collections::BTreeMap;
use std::fs;
use std::io::{self, ErrorKind};
use std::path::Path;
use std::sync::{Arc, Mutex};

use proptest::prelude::*;

use super::group;
use super::log::{Log, LogFile, ReplaceError, read};
use super::thread::{LaterChanges, Writer};
use super::{Batch, Change, Contents, Store, StoreEvents, StoreQueue};

mod full_disk;

/// A change from text: `A 1 bytes`, or `A 1` for a removal.
fn change(text: &str) -> Change {
    let mut words = text.split(' ');
    let (component, key) = (words.next().unwrap().into(), words.next().unwrap().parse().unwrap());
    Change { component, key, bytes: words.next().map(|bytes| bytes.as_bytes().into()) }
}

fn changes(text: &str) -> Vec<Change> {
    text.split("; ").map(change).collect()
}

/// The opposite: all that is kept.
fn shown(contents: &Contents) -> String {
    let text = |change: Change| {
        let bytes = String::from_utf8(change.bytes.unwrap().to_vec()).unwrap();
        format!("{} {} {bytes}", change.component, change.key)
    };
    contents.changes().map(text).collect::<Vec<_>>().join("; ")
}

/// A file in memory, whose disk can be full or fail.
#[derive(Clone, Default)]
struct TestFile(Arc<Mutex<TestDisk>>);

#[derive(Default)]
struct TestDisk {
    bytes: Vec<u8>,
    /// Number of bytes up to which everything is on the disk.
    synced: usize,
    /// Number of bytes that fit.
    space: Option<usize>,
    /// Number of bytes that are reserved for the log, and for one in its place.
    reserved: [usize; 2],
    /// Fails at the next call of this name.
    fails: Option<&'static str>,
    replaced: usize,
}

impl TestFile {
    fn log(self) -> Log<TestFile> {
        self.0.lock().unwrap().bytes = group::HEAD.to_vec();
        Log::new(self, group::HEAD.len() as u64, 0, Contents::default())
    }

    fn call(&self, name: &str) -> io::Result<std::sync::MutexGuard<'_, TestDisk>> {
        let mut disk = self.0.lock().unwrap();
        match disk.fails.take_if(|fails| *fails == name) {
            Some(_) => Err(ErrorKind::Other.into()),
            None => Ok(disk),
        }
    }
}

impl LogFile for TestFile {
    fn append(&mut self, bytes: &[u8]) -> io::Result<()> {
        let mut disk = self.call("append")?;
        let [reserved, spare] = disk.reserved;
        let space = disk.space.map_or(usize::MAX, |space| space.saturating_sub(spare).max(reserved));
        let space = space.saturating_sub(disk.bytes.len());
        disk.bytes.extend_from_slice(&bytes[..space.min(bytes.len())]);
        if space < bytes.len() { Err(ErrorKind::StorageFull.into()) } else { Ok(()) }
    }

    fn sync(&mut self) -> io::Result<()> {
        let mut disk = self.call("sync")?;
        disk.synced = disk.bytes.len();
        Ok(())
    }

    fn look(&self) -> io::Result<()> {
        self.call("look").map(drop)
    }

    fn cut(&mut self, size: u64) -> io::Result<()> {
        let mut disk = self.call("cut")?;
        disk.bytes.truncate(size as usize);
        // What was reserved beyond that is free again.
        disk.reserved[0] = 0;
        Ok(())
    }

    fn reserve(&mut self, size: u64) -> io::Result<()> {
        self.call("reserve")?.reserve(0, size as usize)
    }

    fn reserve_spare(&mut self, size: u64) -> io::Result<()> {
        self.call("reserve_spare")?.reserve(1, size as usize)
    }

    fn replace(&mut self, bytes: &[u8]) -> Result<(), ReplaceError> {
        let called = self.call("replace").map(drop);
        let mut disk = self.0.lock().unwrap();
        // The file is removed if that fails.
        let spare = std::mem::take(&mut disk.reserved[1]);
        called.map_err(ReplaceError::Before)?;
        let others = disk.bytes.len().max(disk.reserved[0]);
        if disk.space.is_some_and(|space| bytes.len() > space.saturating_sub(others).max(spare)) {
            return Err(ReplaceError::Before(ErrorKind::StorageFull.into()));
        }
        disk.reserved = [spare, 0];
        (disk.bytes, disk.synced, disk.replaced) = (bytes.to_vec(), bytes.len(), disk.replaced + 1);
        Ok(())
    }
}

impl TestDisk {
    fn reserve(&mut self, place: usize, size: usize) -> io::Result<()> {
        let other = if place == 0 { self.reserved[1] } else { self.reserved[0].max(self.bytes.len()) };
        if self.space.is_some_and(|space| size > space.saturating_sub(other)) {
            return Err(ErrorKind::StorageFull.into());
        }
        self.reserved[place] = self.reserved[place].max(size);
        Ok(())
    }
}

/// Writes down what the thread tells.
#[derive(Default)]
struct Told(Mutex<Vec<String>>);

impl StoreEvents for Told {
    fn committed(&self, batches: &[(u32, u64)]) {
        self.0.lock().unwrap().push(format!("committed {batches:?}"));
    }

    fn is_full(&self, text: Option<&str>) {
        let text = text.map_or("has space", |text| if text.contains("almost") { "is almost full" } else { "is full" });
        self.0.lock().unwrap().push(text.to_owned());
    }

    fn complain(&self, text: String) {
        self.0.lock().unwrap().push(text);
    }

    fn failed(&self, text: &str) {
        self.0.lock().unwrap().push(text.to_owned());
    }
}

#[test]
fn a_log_holds_what_was_committed() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path().join("deep/state");
    for (kept, expected) in [
        ("A 1 one; A 2 two; B/C 1 x", "A 1 one; A 2 two; B/C 1 x"),
        ("A 1; A 3 three; B/C 1 y", "A 2 two; A 3 three; B/C 1 y"),
        ("B/C 1; A 9", "A 2 two; A 3 three"),
    ] {
        let mut store = Store::open(&folder).unwrap();
        store.log.commit(&changes(kept)).unwrap();
        drop(store);
        let store = Store::open(&folder).unwrap();
        assert_eq!((shown(store.contents()), store.repaired()), (expected.to_owned(), None));
    }
}

#[test]
fn a_folder_that_is_no_store_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let refused = |folder: &Path| {
        let text = Store::open(folder).unwrap_err().to_string();
        text.replace(folder.to_str().unwrap(), "FOLDER")
    };
    fs::create_dir(path("other")).unwrap();
    fs::write(path("other/file"), "x").unwrap();
    let foreign =
        "the folder `FOLDER` has files, but no state of a fleet: name an empty folder, or one that does not exist";
    assert_eq!(refused(&path("other")), foreign);
    assert_eq!(fs::read_dir(path("other")).unwrap().count(), 1, "nothing is left there");

    let used = Store::open(&path("used")).unwrap();
    let told = "another program keeps its state in `FOLDER`: end it, or name another folder";
    assert_eq!(refused(&path("used")), told);
    fs::remove_file(path("used/lock")).unwrap();
    assert_eq!(refused(&path("used")), told);
    drop(used);
    Store::open(&path("used")).unwrap();

    fs::write(path("used/store.log"), "saoms-store 2\nand more").unwrap();
    let told = "`FOLDER/store.log` is of another version (`saoms-store 2`): run the version of SAOMS that wrote it, or name another folder";
    assert_eq!(refused(&path("used")), told);
    fs::write(path("used/store.log"), "something else").unwrap();
    assert_eq!(refused(&path("used")), "`FOLDER/store.log` is no state of a fleet: name another folder");
    assert!(refused(&path("other/file")).contains("`FOLDER` cannot be made"));
}

#[test]
fn a_log_that_was_changed_is_refused_and_a_torn_end_is_removed() {
    let folder = tempfile::tempdir().unwrap();
    let mut store = Store::open(folder.path()).unwrap();
    let sizes: Vec<usize> = ["A 1 one", "A 2 two", "A 3 three"]
        .map(|kept| {
            store.log.commit(&changes(kept)).unwrap();
            fs::metadata(folder.path().join("store.log")).unwrap().len() as usize
        })
        .to_vec();
    drop(store);
    let log = folder.path().join("store.log");
    let whole = fs::read(&log).unwrap();
    let opened = |bytes: &[u8]| {
        fs::write(&log, bytes).unwrap();
        Store::open(folder.path()).map(|store| shown(store.contents()))
    };
    for end in 0..=whole.len() {
        let groups = sizes.iter().filter(|size| **size <= end).count();
        let expected = ["", "A 1 one", "A 1 one; A 2 two", "A 1 one; A 2 two; A 3 three"][groups];
        assert_eq!(opened(&whole[..end]).unwrap(), expected, "{end}");
    }
    for end in 0..group::HEAD.len() {
        fs::write(&log, &whole[..end]).unwrap();
        let told = Store::open(folder.path()).unwrap().repaired().unwrap().to_owned();
        let begins = format!("store.log` has {end} bytes, which are no whole first line, as after");
        assert!(told.contains(&begins), "{told}");
        assert_eq!(fs::read(&log).unwrap(), group::HEAD);
    }
    for place in group::HEAD.len()..whole.len() {
        let mut bytes = whole.clone();
        bytes[place] ^= 0x10;
        match opened(&bytes) {
            Ok(contents) => assert_eq!((contents.as_str(), place >= sizes[1]), ("A 1 one; A 2 two", true), "{place}"),
            Err(error) => assert!(place < sizes[1] && error.to_string().contains("is damaged"), "{place}: {error}"),
        }
    }
    let mut bytes = whole[..sizes[0]].to_vec();
    bytes.extend_from_slice(&[0; 5000]);
    fs::write(&log, bytes).unwrap();
    let store = Store::open(folder.path()).unwrap();
    assert!(store.repaired().unwrap().starts_with("the last 5000 bytes of `"), "{store:?}");
    assert_eq!(fs::metadata(&log).unwrap().len() as usize, sizes[0]);
}

#[test]
fn a_log_is_written_anew_when_it_is_much_larger_than_what_it_holds() {
    let file = TestFile::default();
    let mut log = file.clone().log();
    let large = "x".repeat(10_000);
    for number in 0..1000 {
        log.commit(&changes(&format!("A {} {large}; B 1 {number}", number % 7))).unwrap();
    }
    let (size, replaced) = {
        let disk = file.0.lock().unwrap();
        (disk.bytes.len(), disk.replaced)
    };
    assert!(size < 1 << 21 && replaced > 3, "{size} {replaced}");
    let again = read(&file.0.lock().unwrap().bytes);
    assert_eq!(again.contents, *log.contents());
    // Where that is not possible, it grows.
    file.0.lock().unwrap().fails = Some("replace");
    for number in 0..200 {
        log.commit(&changes(&format!("A {} {large}; B 1 {number}", number % 7))).unwrap();
    }
    assert!(log.complaint().is_some() && log.complaint().is_none());
    assert_eq!(read(&file.0.lock().unwrap().bytes).contents, *log.contents());
}

#[test]
fn all_that_waits_is_committed_together_and_nothing_after_a_failure() {
    let run = |disk: TestDisk, kept: &[&str]| {
        let file = TestFile(Arc::new(Mutex::new(disk)));
        let (queue, told) = (StoreQueue::default(), Told::default());
        for (number, kept) in (1..).zip(kept) {
            queue.put(Batch { index: 0, number, changes: changes(kept), later: None });
        }
        queue.close();
        Writer { log: file.clone().log(), queue: &queue, events: &told, told: None }.write();
        let bytes = file.0.lock().unwrap().bytes.clone();
        (told.0.into_inner().unwrap().join("; "), shown(&read(&bytes).contents), queue.refusal())
    };
    let kept = ["A 1 one", "A 2 two", "A 1 three"];
    let all = "A 1 three; A 2 two";
    assert_eq!(run(TestDisk::default(), &kept), ("committed [(0, 1), (0, 2), (0, 3)]".into(), all.into(), None));
    let failure = "the state folder cannot be written: other error; what is kept from now on would be lost";
    for fails in ["append", "sync", "look"] {
        let (told, _, refusal) = run(TestDisk { fails: Some(fails), ..TestDisk::default() }, &kept);
        assert_eq!((told.as_str(), refusal.as_deref()), (failure, Some(failure)));
    }
    // The reserve is less than wanted, but there is space for these.
    let (told, shown, _) = run(TestDisk { space: Some(1000), ..TestDisk::default() }, &kept);
    assert_eq!((told.as_str(), shown.as_str()), ("is almost full; committed [(0, 1), (0, 2), (0, 3)]", all));
    let (told, shown, _) = run(TestDisk { space: Some(50), ..TestDisk::default() }, &kept);
    let full = "is almost full; is full; the state folder cannot be written: no storage space; what is kept from now on would be lost";
    assert_eq!((told.as_str(), shown.as_str()), (full, ""));
}

/// Keeps this under one key, unless the store has it.
#[derive(Debug)]
struct Wanted(&'static str);

impl LaterChanges for Wanted {
    fn add_to(&self, changes: &mut Vec<Change>, known: &Contents) {
        let change = change(&format!("A 1 {}", self.0));
        let bytes = known.of("A").and_then(|entries| entries.get(&1));
        if bytes.map(|bytes| &bytes[..]) != change.bytes.as_deref() {
            changes.push(change);
        }
    }
}

#[test]
fn changes_that_are_made_of_what_the_store_has_see_those_before_them() {
    let file = TestFile::default();
    let (queue, told) = (StoreQueue::default(), Told::default());
    for (number, wanted) in (1..).zip(["one", "two", "one"]) {
        queue.put(Batch { index: 0, number, changes: Vec::new(), later: Some(Box::new(Wanted(wanted))) });
    }
    queue.close();
    Writer { log: file.clone().log(), queue: &queue, events: &told, told: None }.write();
    assert_eq!(shown(&read(&file.0.lock().unwrap().bytes).contents), "A 1 one");
}

proptest! {
    /// After a failure of the power at any time, a log holds what was committed before, and of what was being committed
    /// all or nothing.
    #[test]
    fn a_log_is_read_up_to_its_last_whole_group(
        groups in prop::collection::vec(prop::collection::vec((0..3_u8, 0..4_u64, prop::option::of(".{0,20}")), 1..5), 1..8),
        lost in 0..200_usize,
        noise in prop::collection::vec(any::<u8>(), 0..40),
    ) {
        let file = TestFile::default();
        let mut log = file.clone().log();
        let mut expected = vec![(file.0.lock().unwrap().bytes.len(), Contents::default())];
        for group in &groups {
            let changes: Vec<Change> = group
                .iter()
                .map(|(component, key, bytes)| Change {
                    component: format!("C{component}").into(),
                    key: *key,
                    bytes: bytes.as_ref().map(|bytes| bytes.as_bytes().into()),
                })
                .collect();
            log.commit(&changes).unwrap();
            expected.push((file.0.lock().unwrap().bytes.len(), log.contents().clone()));
        }
        let all = file.0.lock().unwrap().bytes.clone();
        let mut bytes = all.clone();
        bytes.truncate(bytes.len().saturating_sub(lost).max(group::HEAD.len()));
        bytes.extend_from_slice(&noise);
        // The noise may be what was lost.
        let is_whole = |size: usize| bytes.get(..size) == all.get(..size);
        let whole = expected.iter().rev().find(|(size, _)| is_whole(*size)).unwrap();
        let again = read(&bytes);
        prop_assert_eq!(&again.contents, &whole.1);
        prop_assert_eq!((again.size, again.is_damaged), (whole.0, false));
    }

    /// Anything is read without a panic.
    #[test]
    fn any_bytes_are_read(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        let mut all = group::HEAD.to_vec();
        all.extend_from_slice(b"grp\n");
        all.extend_from_slice(&bytes);
        let _ = read(&all);
    }
}

#[test]
fn contents_know_their_size() {
    let mut contents = Contents::default();
    let mut sizes: BTreeMap<&str, u64> = BTreeMap::new();
    for text in ["A 1 one", "A 1 x", "A 2 y", "B 1", "A 1", "A 2"] {
        contents.apply(&change(text));
        sizes.insert(text, contents.size());
    }
    assert_eq!(contents.size(), 0, "{sizes:?}");
    assert_eq!((sizes["A 1 one"], sizes["A 1 x"], sizes["A 2 y"]), (20, 18, 36));
}
