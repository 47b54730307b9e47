//! Components that run in two programs: the one has them that began last, whomever others heard first.

use std::collections::BTreeSet;

use super::super::wire::{Begins, Vote};
use super::super::{Exchange, Settings};
use super::events;
use super::lossy::{Lossy, MILLISECOND, Weather};

const SECOND: u64 = 1_000 * MILLISECOND;

fn told(network: &Lossy, program: usize, what: &str) -> Vec<String> {
    network.told(program).into_iter().filter(|line| line.starts_with(what)).collect()
}

/// A program with the component of the first one, which is stopped, and one that reads.
fn replaced(seed: u64) -> Lossy {
    let mut network = Lossy::new(2, Weather::calm(), seed);
    network.run(SECOND);
    network.programs[0].is_stopped = true;
    network.run(2 * SECOND);
    network.join_with("Robot0", 0);
    network.run(SECOND);
    network
}

#[test]
fn a_stopped_program_that_returns_displaces_nobody_where_it_is_heard_last() {
    let mut network = replaced(1);
    // The reader starts again, and does not know the first one.
    network.programs[1].is_stopped = true;
    network.join_as("1", "Robot1", 0);
    network.run(2 * SECOND);
    let (later, reader) = (2, 3);
    (0..3).for_each(|_| network.send(later, "EVENTS"));
    network.run(SECOND);
    network.programs[0].is_stopped = false;
    network.run(2 * SECOND);
    for _ in 0..3 {
        network.send(0, "EVENTS");
        network.send(later, "EVENTS");
        network.send(reader, "EVENTS");
        network.run(SECOND);
    }
    let heard = events(&network, "EVENTS");
    assert_eq!(heard[&(later, reader)], (1..=6).collect::<Vec<u64>>());
    assert_eq!(heard[&(reader, later)], (1..=3).collect::<Vec<u64>>(), "what is kept for it goes on");
    assert_eq!(heard.get(&(0, reader)), None);
    assert_eq!(told(&network, reader, "Replaced"), ["Replaced 0"]);
    assert_eq!(told(&network, reader, "Twice"), ["Twice Robot0 0"]);
    assert_eq!(told(&network, reader, "Anew"), Vec::<String>::new());
    assert_eq!(told(&network, 0, "Superseded"), ["Superseded Robot0 2"], "it ends");
    assert_eq!(told(&network, later, "Superseded"), Vec::<String>::new());
}

#[test]
fn each_earlier_start_of_a_component_is_ignored_and_not_the_last_one_alone() {
    let mut network = replaced(1);
    network.send(2, "EVENTS");
    network.programs[2].is_stopped = true;
    network.run(2 * SECOND);
    network.join_with("Robot0", 0);
    network.run(SECOND);
    network.send(3, "EVENTS");
    network.run(SECOND);
    for earlier in [0, 2] {
        network.programs[earlier].is_stopped = false;
        network.run(2 * SECOND);
        network.send(earlier, "EVENTS");
        network.send(3, "EVENTS");
        network.run(2 * SECOND);
        assert_eq!(told(&network, earlier, "Superseded").len(), 1);
    }
    let heard = events(&network, "EVENTS");
    assert_eq!(heard[&(3, 1)], [1, 2, 3]);
    assert_eq!(heard.get(&(0, 1)), None);
    assert_eq!(heard.get(&(2, 1)).map_or(0, Vec::len), 1, "what it sent before it was stopped");
    assert_eq!(told(&network, 3, "Superseded"), Vec::<String>::new());
}

#[test]
fn a_program_that_returns_ends_although_messages_are_lost() {
    for seed in 1..40 {
        let mut network = replaced(seed);
        network.change(Weather { loss: 40, repeats: 10, jitter: 20 });
        network.programs[0].is_stopped = false;
        network.run(20 * SECOND);
        assert_eq!(told(&network, 0, "Superseded"), ["Superseded Robot0 2"], "{seed}");
        assert_eq!(told(&network, 2, "Superseded"), Vec::<String>::new());
    }
}

#[test]
fn the_vote_of_a_program_whose_components_run_elsewhere_does_not_count() {
    let mut network = replaced(1);
    network.programs[0].exchange.vote(Vote::Open);
    [1, 2].into_iter().for_each(|program| network.programs[program].exchange.vote(Vote::Done));
    network.programs[0].is_stopped = false;
    network.run(2 * SECOND);
    assert!(network.programs[1].exchange.is_done() && network.programs[2].exchange.is_done());
    assert!(network.programs[1].exchange.is_complete());
}

#[test]
fn the_link_is_not_lost_because_a_program_is_away_whose_components_run_elsewhere() {
    let mut network = replaced(1);
    network.leave(2);
    network.programs[2].is_stopped = true;
    network.run(SECOND);
    assert!(told(&network, 1, "Left").len() == 1 && !network.programs[1].exchange.hears_nobody());
}

/// A reader and a program whose clock is ahead; that ends while the reader is cut off, and one begins anew with its
/// component.
fn ahead(leaves: bool) -> (Lossy, usize, usize, usize) {
    let (reader, first, second) = (0, 1, 2);
    let mut network = Lossy::new(1, Weather::calm(), 1);
    network.join_at("P", "Robot", 1_000);
    network.run(SECOND);
    network.send(first, "EVENTS");
    network.run(SECOND);
    network.is_cut = true;
    if !leaves {
        network.programs[first].is_stopped = true;
    }
    network.run(200 * MILLISECOND);
    network.join_at("P", "Robot", 10);
    network.is_cut = false;
    network.run(300 * MILLISECOND);
    (network, reader, first, second)
}

#[test]
fn a_program_that_is_missed_does_not_block_the_living_one_although_its_clock_was_ahead() {
    let (mut network, reader, first, second) = ahead(false);
    assert_eq!(told(&network, reader, "Unreachable"), Vec::<String>::new());
    // It is heard, and ignored.
    network.send(second, "EVENTS");
    network.run(3 * SECOND);
    assert_eq!(told(&network, reader, "Unreachable"), ["Unreachable 1"]);
    (0..3).for_each(|_| network.send(second, "EVENTS"));
    network.send(reader, "EVENTS");
    network.run(SECOND);
    let heard = events(&network, "EVENTS");
    assert_eq!(heard[&(second, reader)], [2, 3, 4]);
    assert_eq!(heard[&(reader, second)], [1], "what is kept for it goes on");
    assert_eq!(told(&network, reader, "Anew"), ["Anew Robot 2 1"]);
    // If it was stopped alone after all, it goes on, and the other one learns it.
    network.programs[first].is_stopped = false;
    network.run(2 * SECOND);
    network.send(first, "EVENTS");
    network.run(SECOND);
    assert_eq!(events(&network, "EVENTS")[&(first, reader)], [1, 2]);
    assert_eq!(told(&network, second, "Superseded"), ["Superseded Robot P"]);
}

#[test]
fn a_program_that_leaves_does_not_block_the_living_one_although_its_clock_was_ahead() {
    let (mut network, reader, first, second) = ahead(true);
    network.send(second, "EVENTS");
    network.run(SECOND);
    network.leave(first);
    network.programs[first].is_stopped = true;
    network.run(SECOND);
    network.send(second, "EVENTS");
    network.send(reader, "EVENTS");
    network.run(SECOND);
    let heard = events(&network, "EVENTS");
    assert_eq!((&heard[&(second, reader)], &heard[&(reader, second)]), (&vec![2], &vec![1]));
}

#[test]
fn who_asks_hears_when_the_last_program_began_with_one_of_its_components() {
    let mut own = Exchange::new(Settings {
        program: 1,
        began: 20,
        name: "own".to_owned(),
        patience: SECOND,
        limit: 1 << 20,
        linger: 0,
        components: BTreeSet::from(["Own".to_owned()]),
        others: BTreeSet::new(),
        memory: None,
    });
    let begins = |program, began, component: &str| Begins {
        program,
        began,
        components: vec![component.to_owned()],
        ..Begins::default()
    };
    for (program, began) in [(2, 50), (3, 70)] {
        own.note_begin(begins(program, began, "Robot"));
    }
    let latest = |begins: &Begins| own.answer_begin(begins, 0).map(|runs| (runs.components, runs.began, runs.latest));
    assert_eq!(latest(&begins(4, 60, "Robot")), Some((Vec::new(), 20, 70)));
    assert_eq!(latest(&begins(3, 70, "Robot")), Some((Vec::new(), 20, 50)), "it is not its own predecessor");
    assert_eq!(latest(&begins(4, 60, "Other")), None);
    assert_eq!(latest(&begins(4, 60, "Own")), Some((vec!["Own".to_owned()], 20, 0)));
    assert_eq!(latest(&begins(1, 20, "Own")), None);
}
