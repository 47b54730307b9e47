//! When the work of a network is done.

use std::collections::BTreeSet;

use super::super::wire::{Alive, Begins, Reads, Sends, Vote, Welcome};
use super::super::{Action, Exchange, OwnMessage, Settings};
use super::lossy::{Lossy, MILLISECOND, Weather};

fn program(others: &[&str]) -> Exchange {
    Exchange::new(Settings {
        program: 1,
        began: 0,
        name: "own".to_owned(),
        patience: 1_000 * MILLISECOND,
        limit: 1 << 20,
        linger: 10_000 * MILLISECOND,
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
fn what_was_sent_before_a_program_saw_no_work_left_arrives_before_the_end() {
    let mut network = Lossy::new(2, Weather::calm(), 1);
    network.run(500 * MILLISECOND);
    network.is_cut = true;
    network.send(0, "EVENTS");
    network.run(50 * MILLISECOND);
    (0..2).for_each(|program| network.programs[program].exchange.vote(Vote::Done));
    network.is_cut = false;
    // The word that no work is left comes first, and what was lost before has to be asked for.
    network.run(0);
    let reader = &network.programs[1].exchange;
    assert!(reader.is_done() && reader.is_complete() && !reader.has_received_all());
    network.run(500 * MILLISECOND);
    assert!(network.programs[1].exchange.has_received_all());
    assert_eq!(network.delivered.len(), 1);
    // Who is not there any more sends nothing again.
    network.is_cut = true;
    network.send(0, "EVENTS");
    network.programs[0].is_stopped = true;
    network.run(2_000 * MILLISECOND);
    assert!(network.programs[1].exchange.has_received_all());
}

#[test]
fn what_is_never_sent_again_is_counted_as_lost_and_not_waited_for_any_more() {
    let mut own = program(&[]);
    own.read(&"EVENTS".into(), false, 0);
    let topic = || "EVENTS".to_owned();
    let sends = vec![Sends { topic: topic(), last: 3, oldest: 1, ..Sends::default() }];
    let welcomes = vec![Welcome { reader: 1, topic: topic(), first: 1 }];
    own.hear(&Alive { sends, welcomes, ..alive(2, "other", Vote::Done) }, 0);
    assert!(own.is_done() && !own.has_received_all());
    own.take_actions();
    own.give_up_missing();
    assert!(own.has_received_all());
    assert_eq!(lost_of(own.take_actions()), 3);
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

/// Another program that reads a topic on which this one has sent something that it has not received.
fn lacking(own: &mut Exchange, program: u64, name: &str) {
    let reads = vec![Reads { topic: "EVENTS".to_owned() }];
    own.hear(&Alive { reads, ..alive(program, name, Vote::Silent) }, MILLISECOND);
    let (topic, component) = ("EVENTS".into(), "C".into());
    own.send(OwnMessage {
        topic: &topic,
        is_state: false,
        component: &component,
        to: None,
        key: None,
        sent: 0,
        schema: 0,
        cause: 0,
        place: None,
        number: None,
        bytes: b"1",
    });
}

fn lost(own: &mut Exchange) -> u64 {
    own.leave();
    lost_of(own.take_actions())
}

/// Number of the messages that these actions tell as lost.
fn lost_of(actions: Vec<Action>) -> u64 {
    let news = actions.into_iter().filter_map(|action| match action {
        Action::Tell(news) => Some(news.lost()),
        _ => None,
    });
    news.sum()
}

#[test]
fn readers_that_are_away_are_waited_for_and_then_have_lost_what_they_lack() {
    let mut own = program(&[]);
    lacking(&mut own, 2, "reader");
    own.tick(9_000 * MILLISECOND);
    assert!(!own.is_complete(), "it was missed, and is waited for");
    assert_eq!(own.awaited(), [("reader".into(), 1, false)]);
    own.tick(11_000 * MILLISECOND);
    assert!(own.is_complete() && own.awaited().is_empty());
    assert_eq!(lost(&mut own), 1);
}

#[test]
fn nobody_waits_for_a_program_whose_components_have_begun_in_another_one() {
    let mut own = program(&[]);
    let begins = |program: u64| Begins { program, components: vec!["Robot1".to_owned()], ..Begins::default() };
    own.note_begin(begins(2));
    lacking(&mut own, 2, "reader");
    assert!(!own.is_complete());
    own.note_begin(begins(3));
    assert!(!own.is_complete(), "that one may be refused");
    own.hear(&alive(3, "reader", Vote::Silent), 500 * MILLISECOND);
    assert!(own.is_complete());
    assert_eq!(lost(&mut own), 0);
}
