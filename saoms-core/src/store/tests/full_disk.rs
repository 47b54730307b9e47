//! A log on a disk that is full, or becomes so: what it reserves, and what is still committed.

use std::sync::{Arc, Mutex};

use proptest::prelude::*;

use super::{TestDisk, TestFile, Told, changes, shown};
use crate::store::log::{CommitError, read};
use crate::store::thread::Writer;
use crate::store::{Batch, Change, StoreQueue};

#[test]
fn a_disk_that_is_full_stops_nothing_that_fits_into_what_is_reserved() {
    let file = TestFile::default();
    let (queue, told) = (StoreQueue::default(), Told::default());
    let mut writer = Writer { log: file.clone().log(), queue: &queue, events: &told, told: None };
    assert!(writer.log.reserve().unwrap());
    let [log, spare] = file.0.lock().unwrap().reserved;
    // From now on others take all that is left, whenever something is free.
    file.0.lock().unwrap().space = Some(log + spare);
    let mut count = 0;
    while writer.log.reserve().unwrap() {
        writer.log.commit(&[large(count, 100_000)]).unwrap();
        count += 1;
    }
    assert!(count > 5);
    for round in 0..500 {
        writer.log.commit(&[large(round % count, 100_000)]).unwrap();
        assert!(!writer.log.reserve().unwrap(), "{round}");
    }
    assert!(writer.log.complaint().is_none());
    // Its own space is not enough for new work; what somebody else frees is.
    file.0.lock().unwrap().space = Some(64 << 20);
    assert!(writer.log.reserve().unwrap());
}

#[test]
fn all_that_a_large_fleet_keeps_may_change_on_a_full_disk() {
    let file = TestFile::default();
    let mut log = file.clone().log();
    let all = |letter: &str| -> Vec<Change> {
        let bytes: Arc<[u8]> = letter.repeat(2000).as_bytes().into();
        let change = |robot| Change { component: format!("R{robot}").into(), key: 1, bytes: Some(Arc::clone(&bytes)) };
        (0..10_000).map(change).collect()
    };
    log.commit(&all("a")).unwrap();
    assert!(log.reserve().unwrap());
    let space: usize = file.0.lock().unwrap().reserved.iter().sum();
    file.0.lock().unwrap().space = Some(space);
    for round in 0..20 {
        let letter = if round % 2 == 0 { "b" } else { "c" };
        log.commit(&all(letter)).unwrap_or_else(|error| panic!("{round}: {error:?}"));
        log.reserve().unwrap();
    }
    assert!(log.complaint().is_none());
    assert_eq!(read(&file.0.lock().unwrap().bytes).contents, *log.contents());
}

/// A change of this number of bytes.
fn large(key: u64, size: usize) -> Change {
    Change { component: "A".into(), key, bytes: Some(vec![7; size].into()) }
}

#[test]
fn a_log_at_the_end_of_its_space_is_written_anew() {
    let file = TestFile::default();
    let mut log = file.clone().log();
    // What it holds grows in the space that is there, so that half of it is outdated once that is used up.
    file.0.lock().unwrap().space = Some(20 << 20);
    for round in 0..2000_u64 {
        log.commit(&[large(round % 40, 100_000)]).unwrap_or_else(|error| panic!("{round}: {error:?}"));
        log.reserve().unwrap();
    }
    assert!(log.complaint().is_none());
}

#[test]
fn as_much_is_reserved_as_the_disk_gives() {
    let file = TestFile::default();
    let mut log = file.clone().log();
    for key in 0..20 {
        log.commit(&[large(key, 1 << 20)]).unwrap();
    }
    let size = file.0.lock().unwrap().bytes.len();
    file.0.lock().unwrap().space = Some(size + (50 << 20));
    assert!(log.reserve().unwrap(), "all that it holds may change");
    let [reserved, spare] = file.0.lock().unwrap().reserved;
    assert!(reserved >= size + (4 << 20) && spare >= 2 * size, "{reserved} {spare}");
    // Others take the rest.
    file.0.lock().unwrap().space = Some(reserved + spare);
    let all: Vec<Change> = (0..20).map(|key| large(key, 1 << 20)).collect();
    for round in 0..10 {
        log.commit(&all).unwrap_or_else(|error| panic!("{round}: {error:?}"));
        log.reserve().unwrap();
    }
}

#[test]
fn a_log_that_cannot_be_written_anew_says_so_once() {
    let file = TestFile::default();
    let mut log = file.clone().log();
    file.0.lock().unwrap().space = Some(8 << 20);
    let mut complaints = 0;
    for round in 0..300_u64 {
        file.0.lock().unwrap().fails = Some("replace");
        log.commit(&[large(round % 3, 20_000)]).unwrap();
        log.reserve().unwrap();
        complaints += usize::from(log.complaint().is_some());
    }
    assert_eq!(complaints, 1);
    file.0.lock().unwrap().fails = None;
    let before = file.0.lock().unwrap().replaced;
    for round in 0..600 {
        log.commit(&[large(round % 3, 20_000)]).unwrap();
        log.reserve().unwrap();
    }
    assert!(file.0.lock().unwrap().replaced > before && log.complaint().is_none());
}

#[test]
fn a_full_disk_is_tried_again_until_it_has_space() {
    let file = TestFile(Arc::new(Mutex::new(TestDisk { space: Some(50), ..TestDisk::default() })));
    let (queue, told) = (StoreQueue::default(), Told::default());
    queue.put(Batch { index: 3, number: 1, changes: changes("A 1 one"), later: None });
    std::thread::scope(|scope| {
        scope.spawn(|| Writer { log: file.clone().log(), queue: &queue, events: &told, told: None }.write());
        while told.0.lock().unwrap().len() < 2 {
            std::thread::yield_now();
        }
        file.0.lock().unwrap().space = None;
        while told.0.lock().unwrap().len() < 4 {
            std::thread::yield_now();
        }
        queue.close();
    });
    let told = told.0.into_inner().unwrap();
    assert_eq!(told, ["is almost full", "is full", "committed [(3, 1)]", "has space"]);
    assert_eq!(shown(&read(&file.0.lock().unwrap().bytes).contents), "A 1 one");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    /// As long as a disk has space for a log and for one in its place, all is committed, whatever others take and
    /// leave.
    #[test]
    fn a_disk_that_has_space_for_the_log_twice_is_not_full(
        steps in prop::collection::vec((0..12_u64, prop_oneof![0..2000_usize, 0..600_000_usize], 0..24_usize), 1..60),
    ) {
        let file = TestFile::default();
        let mut log = file.clone().log();
        file.0.lock().unwrap().space = Some(4 << 20);
        log.reserve().unwrap();
        for (place, (key, size, space)) in steps.into_iter().enumerate() {
            let change = if size % 7 == 0 { Change { bytes: None, ..large(key, 0) } } else { large(key, size) };
            let (space, used) = {
                let mut disk = file.0.lock().unwrap();
                let [reserved, spare] = disk.reserved;
                // Nobody takes what is reserved.
                let taken = disk.bytes.len().max(reserved) + spare;
                let space = if space < 16 { taken.max(space << 20) } else { disk.space.unwrap() };
                disk.space = Some(space);
                (space, disk.bytes.len())
            };
            let least = used + size + 100 + (log.contents().size() as usize + (64 << 10));
            match log.commit(&[change]) {
                Ok(()) => {}
                Err(CommitError::Full(_)) => prop_assert!(space < least, "{place}: {space} of {least}"),
                Err(error) => prop_assert!(false, "{place}: {error:?}"),
            }
            log.reserve().unwrap();
            prop_assert!(log.complaint().is_none(), "{place}");
            let disk = file.0.lock().unwrap();
            let holds = log.contents().size() as usize;
            // It can be written anew for as long as there is space for that.
            prop_assert!(
                disk.reserved[1] >= holds || space < disk.bytes.len() + holds + (256 << 10),
                "{place}: {:?} of {space}, it has {} and holds {holds}", disk.reserved, disk.bytes.len()
            );
        }
        prop_assert_eq!(&read(&file.0.lock().unwrap().bytes).contents, log.contents());
    }
}
