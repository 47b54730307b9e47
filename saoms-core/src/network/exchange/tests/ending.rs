//! When the work of a network is done.

use std::collections::BTreeSet;

use super::super::wire::{Alive, Vote};
use super::super::{Exchange, Settings};
use super::lossy::MILLISECOND;

fn program(others: &[&str]) -> Exchange {
    Exchange::new(Settings {
        program: 1,
        name: "own".to_owned(),
        patience: 1_000 * MILLISECOND,
        limit: 1 << 20,
        components: BTreeSet::new(),
        others: others.iter().map(|name| (*name).to_owned()).collect(),
        memory: None,
    })
}

fn alive(program: u64, name: &str, vote: Vote) -> Alive {
    Alive { program, name: name.to_owned(), number: 1, patience: 1_000, vote: vote as u8, ..Alive::default() }
}

#[test]
fn no_work_is_done_before_each_node_has_been_there() {
    let mut own = program(&["gate-a", "gate-b"]);
    own.vote(Vote::Open);
    own.hear(&alive(2, "gate-a", Vote::Silent), 0);
    assert_eq!(own.waits_for(), None, "it sees work itself");
    own.vote(Vote::Done);
    assert!(!own.is_done());
    assert_eq!(own.waits_for(), Some(&BTreeSet::from(["gate-b".to_owned()])));
    own.hear(&alive(3, "gate-b", Vote::Silent), 0);
    assert_eq!((own.is_done(), own.waits_for()), (true, None));
}

#[test]
fn nobody_is_heard_when_all_others_are_missed() {
    let mut own = program(&[]);
    assert!(!own.hears_nobody(), "nobody was there yet");
    own.hear(&alive(2, "one", Vote::Silent), 0);
    own.hear(&alive(3, "other", Vote::Silent), 500 * MILLISECOND);
    own.tick(1_200 * MILLISECOND);
    assert!(!own.hears_nobody());
    own.tick(2_000 * MILLISECOND);
    assert!(own.hears_nobody());
    own.hear(&Alive { number: 2, ..alive(2, "one", Vote::Silent) }, 2_100 * MILLISECOND);
    assert!(!own.hears_nobody());
}

#[test]
fn who_was_held_up_itself_misses_nobody() {
    let mut own = program(&[]);
    own.hear(&alive(2, "one", Vote::Silent), 0);
    own.hold_up(20_000 * MILLISECOND, 20_000 * MILLISECOND);
    own.tick(20_500 * MILLISECOND);
    assert!(!own.hears_nobody());
    own.tick(22_000 * MILLISECOND);
    assert!(own.hears_nobody());
    // Who was heard meanwhile is not missed later for that.
    own.hear(&Alive { number: 2, ..alive(2, "one", Vote::Silent) }, 39_000 * MILLISECOND);
    own.hold_up(18_000 * MILLISECOND, 40_000 * MILLISECOND);
    own.tick(41_500 * MILLISECOND);
    assert!(own.hears_nobody());
}

#[test]
fn a_program_that_said_that_all_is_done_and_vanished_has_said_so() {
    let mut own = program(&[]);
    own.vote(Vote::Silent);
    own.hear(&alive(2, "work", Vote::Done), 0);
    own.tick(10_000 * MILLISECOND);
    assert!(own.is_done(), "its last sign of life was lost");
    own.hear(&alive(3, "other", Vote::Open), 10_000 * MILLISECOND);
    assert!(!own.is_done());
}
