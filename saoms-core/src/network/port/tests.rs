//! What finds no room at the port, and who is woken.

use std::thread;
use std::time::Instant;

use saoms_api::{Cause, Header, Time};

use super::*;

/// Longest time for something that has to happen at once.
const LONGEST: Duration = Duration::from_secs(60);

#[test]
fn what_components_read_is_never_lost() {
    let port = Port::default();
    let beat = || FromRun::Beat { node: String::new(), component: String::new(), caller: "".into(), period: 0 };
    port.put((0..=MOST_MESSAGES).map(|_| beat()));
    port.put([FromRun::Reads { topic: "TOPIC".into(), is_state: false, schema: 0 }].into_iter());
    let waiting = port.take();
    assert_eq!((waiting.from_run.len(), waiting.lost), (MOST_MESSAGES + 1, 0));
    assert!(matches!(waiting.from_run.last(), Some(FromRun::Reads { .. })));
}

fn message(topic: &str, is_state: bool, key: u64, bytes: usize) -> FromRun {
    let header = Header { sender: 0, sent: Time::default(), cause: Cause::default() };
    FromRun::Message {
        topic: topic.into(),
        component: "Own".into(),
        to: None,
        is_state,
        schema: 0,
        number: None,
        message: SharedMessage::from_bytes(header, None, vec![key as u8; bytes]).of(Some(key), None),
    }
}

/// What waits beyond the first messages.
fn beyond(port: &Port, first: usize) -> (Vec<String>, u64) {
    let waiting = port.take();
    let shown = waiting.from_run.iter().skip(first).map(|from_run| match from_run {
        FromRun::Message { topic, message, .. } => format!("{topic} {:?} {}", message.key(), message.bytes()[0]),
        FromRun::Skipped { topic, count, last } => format!("{topic} skipped {count} {last:?}"),
        FromRun::Wants { topic, cells } => format!("{topic} wants {cells:?}"),
        other => format!("{other:?}"),
    });
    let mut shown: Vec<String> = shown.collect();
    shown.sort_unstable();
    (shown, waiting.lost)
}

#[test]
fn of_what_finds_no_room_the_newest_states_wait_and_lost_events_are_told_behind_those_that_wait() {
    let port = Port::default();
    port.put((0..MOST_MESSAGES).map(|_| message("EVENTS", false, 0, 1)));
    let late = [("STATES", true, 1), ("EVENTS", false, 2), ("STATES", true, 2), ("OTHER", false, 3)];
    port.put(late.into_iter().map(|(topic, is_state, key)| message(topic, is_state, key, 1)));
    port.put(std::iter::once(message("EVENTS", false, 4, 1)));
    for cells in [None, Some(BTreeSet::from([(0, 0)])), Some(BTreeSet::from([(1, 0)]))] {
        port.put(std::iter::once(FromRun::Wants { topic: "STATES".into(), cells }));
    }
    let expected = [
        "EVENTS skipped 2 None", "OTHER skipped 1 None", "STATES Some(1) 1", "STATES Some(2) 2",
        "STATES wants Some({(1, 0)})",
    ];
    assert_eq!(beyond(&port, MOST_MESSAGES), (expected.map(str::to_owned).to_vec(), 3));
    port.put(std::iter::once(message("EVENTS", false, 5, 1)));
    assert_eq!(beyond(&port, 0), (vec!["EVENTS Some(5) 5".to_owned()], 0));
}

#[test]
fn the_bytes_of_what_waits_are_bounded_and_no_later_message_overtakes_one_that_found_no_room() {
    let port = Port::default();
    let half = MOST_MESSAGE_BYTES / 2;
    port.put((0..2).map(|_| message("EVENTS", false, 0, half)));
    port.put(std::iter::once(message("STATES", true, 7, 2)));
    port.put(std::iter::once(message("STATES", true, 7, 1)));
    port.put(std::iter::once(message("EVENTS", false, 8, 1)));
    let expected = ["EVENTS skipped 1 None", "STATES Some(7) 7"].map(str::to_owned).to_vec();
    let waiting = port.lock().from_run.len();
    assert_eq!((waiting, beyond(&port, 2)), (2, (expected, 1)));
    // One that is longer than all that may wait is taken alone.
    port.put(std::iter::once(message("EVENTS", false, 0, MOST_MESSAGE_BYTES + 1)));
    assert_eq!(port.take().lost, 0);
}

#[test]
fn the_states_that_find_no_room_are_bounded_and_the_newest_of_a_known_one_stays() {
    let port = Port::default();
    let (long, rest) = (MOST_BEYOND_BYTES / 2, MOST_BEYOND_BYTES / 2 - 4_096);
    port.put((0..2).map(|_| message("EVENTS", false, 0, MOST_MESSAGE_BYTES / 2)));
    port.put(
        [(1, long), (2, rest), (3, 8_192), (4, 1)].into_iter().map(|(key, bytes)| message("STATES", true, key, bytes)),
    );
    // A known one is replaced whatever its length, and makes room when it becomes shorter.
    port.put(
        [(2, long), (3, 1), (1, 1), (5, 8_192)].into_iter().map(|(key, bytes)| message("STATES", true, key, bytes)),
    );
    let states = [1, 2, 4, 5].map(|key| format!("STATES Some({key}) {key}"));
    assert_eq!(beyond(&port, 2), (states.to_vec(), 2));
}

#[test]
fn who_sleeps_is_woken_after_another_thread_has_taken_what_waited() {
    let port = Port::default();
    let begin = Instant::now();
    thread::scope(|scope| {
        scope.spawn(|| port.wait(LONGEST, false));
        while !port.lock().sleeps && begin.elapsed() < LONGEST {
            thread::yield_now();
        }
        port.take();
        port.nudge();
    });
    assert!(begin.elapsed() < LONGEST / 2);
}
