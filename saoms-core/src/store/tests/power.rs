//! Losses of power at each moment at which something is reported as committed: a disk has what was synchronized alone.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::fs::{self, File};
use std::os::fd::AsRawFd;
use std::os::unix::fs::MetadataExt;
use std::path::Path;

use crate::store::log::read;
use crate::store::thread::Writer;
use crate::store::{Batch, Change, Contents, Store, StoreEvents, StoreQueue};

/// What is on the disk, whatever the system has in memory: the bytes of files and the files of folders as they were
/// when somebody waited for the disk last.
#[derive(Clone, Debug, Default)]
struct Disk {
    files: BTreeMap<u64, Vec<u8>>,
    folders: BTreeMap<u64, BTreeMap<String, u64>>,
}

thread_local! {
    static DISK: RefCell<Disk> = RefCell::default();
}

/// Notes that a file or a folder is on the disk as it is now.
pub(in crate::store) fn note_synced(file: &File) {
    let about = file.metadata().unwrap();
    DISK.with_borrow_mut(|disk| {
        // The files of a folder are read by the path behind its descriptor.
        let path = format!("/proc/self/fd/{}", file.as_raw_fd());
        if about.is_dir() {
            let entries = fs::read_dir(path).unwrap().flatten();
            let entry = |one: fs::DirEntry| Some((one.file_name().into_string().ok()?, one.metadata().ok()?.ino()));
            let entries = entries.filter_map(entry);
            disk.folders.insert(about.ino(), entries.collect());
        } else {
            disk.files.insert(about.ino(), fs::read(path).unwrap());
        }
    });
}

impl Disk {
    /// The bytes of a file after a loss of power, on the way of these names from a folder; `None` if it is not there.
    fn file(&self, from: u64, way: &[&str]) -> Option<Vec<u8>> {
        let (last, folders) = way.split_last()?;
        let folder = folders.iter().try_fold(from, |folder, name| self.folders.get(&folder)?.get(*name).copied())?;
        let file = self.folders.get(&folder)?.get(*last)?;
        Some(self.files.get(file).cloned().unwrap_or_default())
    }
}

/// Loses the power at each commit, and hands the next batch over.
struct Losses<'a> {
    queue: &'a StoreQueue,
    /// Where the state is: the folder around it, and the way to the log.
    folder: u64,
    way: [&'a str; 3],
    state: RefCell<State>,
}

#[derive(Default)]
struct State {
    /// The batches that were handed over, and what is kept once they are committed.
    given: Vec<Vec<Change>>,
    expected: Contents,
    /// Number of batches that were reported as committed.
    committed: u64,
    /// Number of bytes of the log, and how often it was written anew.
    size: u64,
    written_anew: u64,
}

impl Losses<'_> {
    /// The number of bytes of each of the batches, of which many together make the log so large that it is
    /// written anew.
    const SIZE: usize = 40_000;
    const BATCHES: u64 = 150;

    fn give(&self, state: &mut State) {
        let number = state.given.len() as u64 + 1;
        if number > Self::BATCHES {
            return self.queue.close();
        }
        let bytes = vec![number as u8; if number.is_multiple_of(5) { 10 } else { Self::SIZE }];
        let kept = |key: u64, bytes: Option<Vec<u8>>| Change {
            component: if key.is_multiple_of(2) { "A".into() } else { "B/C".into() },
            key,
            bytes: bytes.map(Into::into),
        };
        let mut changes = vec![kept(number % 7, Some(bytes)), kept(100, Some(number.to_le_bytes().to_vec()))];
        if number.is_multiple_of(11) {
            changes.push(kept((number + 3) % 7, None));
        }
        state.given.push(changes.clone());
        self.queue.put(Batch { index: 0, number, changes, later: None });
    }
}

impl StoreEvents for Losses<'_> {
    fn committed(&self, batches: &[(u32, u64)]) {
        let mut state = self.state.borrow_mut();
        for (_, number) in batches {
            assert_eq!(*number, state.committed + 1);
            state.committed = *number;
            let changes = state.given[*number as usize - 1].clone();
            changes.iter().for_each(|change| state.expected.apply(change));
        }
        let bytes = DISK.with_borrow(|disk| disk.file(self.folder, &self.way)).unwrap_or_default();
        let found = read(&bytes);
        assert!(!found.is_damaged && found.contents == state.expected, "after batch {}", state.committed);
        // A log that was written anew is smaller than the one before.
        state.written_anew += u64::from((bytes.len() as u64) < state.size);
        state.size = bytes.len() as u64;
        self.give(&mut state);
    }

    fn is_full(&self, text: Option<&str>) {
        assert_eq!(text, None);
    }

    fn complain(&self, text: String) {
        panic!("{text}");
    }

    fn failed(&self, text: &str) {
        panic!("{text}");
    }
}

#[test]
fn what_is_reported_as_committed_is_there_after_a_loss_of_power() {
    let around = tempfile::tempdir().unwrap();
    let folder = around.path().join("deep/state");
    DISK.take();
    let store = Store::open(&folder).unwrap();
    let queue = StoreQueue::default();
    let inode = |path: &Path| fs::metadata(path).unwrap().ino();
    let losses = Losses {
        queue: &queue,
        folder: inode(around.path()),
        way: ["deep", "state", "store.log"],
        state: RefCell::default(),
    };
    losses.give(&mut losses.state.borrow_mut());
    Writer { log: store.log, queue: &queue, events: &losses, told: None }.write();
    let state = losses.state.into_inner();
    assert_eq!(state.committed, Losses::BATCHES);
    assert!(state.written_anew > 1, "{}", state.written_anew);
}
