//! What is kept for programs that are away, and when they are given up.

use std::collections::BTreeSet;

use super::super::wire::{Alive, Reads, Received};
use super::super::{Action, Exchange, News, OwnMessage, Settings};
use super::events;
use super::lossy::{Lossy, MILLISECOND, Weather};

#[test]
fn beyond_the_limit_programs_that_are_away_are_given_up_first() {
    let mut network = Lossy::new(3, Weather::calm(), 1);
    network.run(500 * MILLISECOND);
    network.programs[2].is_stopped = true;
    for _ in 0..2000 {
        network.send(0, "EVENTS");
        network.run(2 * MILLISECOND);
    }
    assert_eq!(events(&network, "EVENTS")[&(0, 1)].len(), 2000);
    let told = network.told(0);
    assert!(network.programs[0].lost > 0, "{told:?}");
    assert!(told.contains(&"GivenUp 2".to_owned()), "{told:?}");
    assert!(!told.iter().any(|line| line.starts_with("Overflow")), "{told:?}");
    network.programs[2].is_stopped = false;
    network.run(1_000 * MILLISECOND);
    network.send(0, "EVENTS");
    network.run(2_000 * MILLISECOND);
    let heard = events(&network, "EVENTS");
    assert_eq!(heard[&(0, 2)].last(), Some(&2001));
    let lost: u64 =
        network.told(2).iter().filter_map(|line| line.strip_prefix("Lost 0 EVENTS ")?.parse::<u64>().ok()).sum();
    assert_eq!(heard[&(0, 2)].len() as u64 + lost, 2001);
    assert_eq!(network.programs[0].lost, lost, "both ends count the same: {:?}", network.told(0));
}

/// A program with room for about 40 events.
fn own() -> Exchange {
    Exchange::new(Settings {
        program: 1,
        began: 0,
        name: "own".to_owned(),
        patience: 1_000 * MILLISECOND,
        limit: 50_000,
        linger: 60_000 * MILLISECOND,
        components: BTreeSet::new(),
        others: BTreeSet::new(),
        memory: None,
    })
}

/// Another program gives its sign of this number, reads a topic, and has received all before these messages.
fn hear(own: &mut Exchange, name: &str, number: u64, topic: &str, next: u64, at: u64) {
    let program = u64::from(name.as_bytes()[0]);
    let received = Received { program: 1, topic: topic.to_owned(), next };
    let alive = Alive {
        program,
        name: name.to_owned(),
        number,
        patience: 1_000,
        reads: vec![Reads { topic: topic.to_owned() }],
        received: Some(received).filter(|one| one.next > 0).into_iter().collect(),
        ..Alive::default()
    };
    own.hear(&alive, at * MILLISECOND);
}

fn send(own: &mut Exchange, topic: &str, count: u64) -> Vec<News> {
    for _ in 0..count {
        own.send(OwnMessage {
            topic: &topic.into(),
            is_state: false,
            component: &"C".into(),
            to: None,
            key: None,
            sent: 0,
            schema: 0,
            cause: 0,
            place: None,
            number: None,
            bytes: &[0; 1_000],
        });
    }
    told(own)
}

fn told(own: &mut Exchange) -> Vec<News> {
    let tell = |action| if let Action::Tell(news) = action { Some(news) } else { None };
    own.take_actions().into_iter().filter_map(tell).collect()
}

fn given_up(told: &[News]) -> Vec<&str> {
    let all = told.iter().filter_map(|news| match news {
        News::GivenUp { name, .. } => Some(&**name),
        _ => None,
    });
    all.collect()
}

#[test]
fn a_program_for_which_nothing_is_kept_is_not_given_up() {
    let mut own = own();
    // The one that was heard first reads another topic, on which nothing is sent.
    hear(&mut own, "idle", 1, "OTHER", 0, 1);
    hear(&mut own, "reader", 1, "EVENTS", 0, 100);
    send(&mut own, "EVENTS", 1);
    own.tick(5_000 * MILLISECOND);
    assert_eq!(given_up(&send(&mut own, "EVENTS", 100)), ["reader"]);
    hear(&mut own, "idle", 2, "OTHER", 0, 5_000);
    send(&mut own, "OTHER", 2);
    assert_eq!(own.awaited(), [("idle".into(), 2, true)]);
}

#[test]
fn the_program_is_given_up_for_which_most_is_kept() {
    let mut own = own();
    hear(&mut own, "almost", 1, "EVENTS", 0, 1);
    hear(&mut own, "behind", 1, "EVENTS", 0, 100);
    send(&mut own, "EVENTS", 35);
    hear(&mut own, "almost", 2, "EVENTS", 36, 100);
    own.tick(5_000 * MILLISECOND);
    let told = send(&mut own, "EVENTS", 10);
    assert_eq!(given_up(&told), ["behind"]);
    // It lacks what was forgotten, and may receive what is kept for the other one.
    assert_eq!(told.iter().map(News::lost).sum::<u64>(), 35);
}

#[test]
fn nobody_is_given_up_in_vain_while_a_program_that_is_there_needs_the_same() {
    let mut own = own();
    hear(&mut own, "away", 1, "EVENTS", 0, 1);
    hear(&mut own, "slow", 1, "EVENTS", 0, 4_900);
    own.tick(5_000 * MILLISECOND);
    let told = send(&mut own, "EVENTS", 100);
    assert_eq!(given_up(&told), Vec::<&str>::new());
    own.leave();
    assert!(self::told(&mut own).iter().any(|news| matches!(news, News::Overflow { .. })));
}

#[test]
fn each_event_that_a_reader_lost_counts_once_also_if_that_never_returns() {
    let mut own = own();
    hear(&mut own, "reader", 1, "EVENTS", 0, 1);
    let mut all = send(&mut own, "EVENTS", 10);
    // It has received three of them.
    hear(&mut own, "reader", 2, "EVENTS", 4, 100);
    own.tick(5_000 * MILLISECOND);
    all.extend(send(&mut own, "EVENTS", 90));
    assert_eq!(given_up(&all), ["reader"]);
    own.leave();
    all.extend(told(&mut own));
    assert_eq!(all.iter().map(News::lost).sum::<u64>(), 97, "{all:?}");
}

#[test]
fn what_was_lost_for_want_of_room_counts_once() {
    let mut own = own();
    hear(&mut own, "reader", 1, "EVENTS", 0, 1);
    let mut all = send(&mut own, "EVENTS", 100);
    own.leave();
    all.extend(told(&mut own));
    assert_eq!(all.iter().map(News::lost).sum::<u64>(), 100, "{all:?}");
}

#[test]
fn a_reader_that_returns_has_lost_what_was_not_kept_for_it() {
    let mut own = own();
    hear(&mut own, "reader", 1, "EVENTS", 0, 1);
    own.tick(5_000 * MILLISECOND);
    let mut all = send(&mut own, "EVENTS", 60);
    all.extend(send(&mut own, "EVENTS", 40));
    // It says that it had received two, which is news.
    hear(&mut own, "reader", 2, "EVENTS", 3, 6_000);
    all.extend(told(&mut own));
    let not_kept = all.iter().find(|news| matches!(news, News::NotKept { .. }));
    assert!(not_kept.is_some_and(|news| news.lost() >= 40), "{all:?}");
    all.extend(send(&mut own, "EVENTS", 1));
    assert_eq!(own.awaited(), [("reader".into(), 1, true)]);
    assert!((98..=100).contains(&all.iter().map(News::lost).sum::<u64>()), "{all:?}");
}
