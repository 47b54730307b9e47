//! Programs on a network that loses, repeats and delays what it carries.

mod cells;
mod ending;
mod hostile;
mod limit;
pub(in crate::network::exchange) mod lossy;
mod memory;
mod owners;

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use proptest::prelude::*;

use self::lossy::{Lossy, MILLISECOND, Weather};
use super::hear::MOST_PROGRAMS;
use super::wire::Alive;
use super::{Action, Exchange, News, Settings};

/// The numbers that each program has received from each other one.
type Heard = BTreeMap<(usize, usize), Vec<u64>>;

fn events(network: &Lossy, topic: &str) -> Heard {
    let mut heard = Heard::new();
    for one in network.delivered.iter().filter(|one| &*one.topic == topic) {
        heard.entry((one.sender, one.reader)).or_default().push(one.number);
    }
    heard
}

fn assert_in_order(heard: &Heard) {
    for ((sender, reader), numbers) in heard {
        for pair in numbers.windows(2) {
            assert_eq!(pair[1], pair[0] + 1, "{reader} heard {numbers:?} of {sender}");
        }
    }
}

#[test]
fn events_arrive_once_and_in_order() {
    let mut network = Lossy::new(2, Weather::calm(), 1);
    network.run(500 * MILLISECOND);
    for _ in 0..1000 {
        network.send(0, "EVENTS");
        network.run(MILLISECOND);
    }
    network.run(1_000 * MILLISECOND);
    let heard = events(&network, "EVENTS");
    assert_eq!(heard[&(0, 1)], (1..=1000).collect::<Vec<u64>>());
    assert!(network.programs[0].exchange.is_complete());
    assert_eq!(network.programs[0].exchange.kept_bytes(), 0);
}

#[test]
fn what_was_sent_while_the_network_was_away_arrives_when_it_is_back() {
    let mut network = Lossy::new(3, Weather::calm(), 1);
    network.run(500 * MILLISECOND);
    network.is_cut = true;
    for _ in 0..1000 {
        network.send(0, "EVENTS");
        network.run(10 * MILLISECOND);
    }
    assert!(network.told(1).iter().any(|line| line == "Unreachable 0"), "{:?}", network.told(1));
    network.is_cut = false;
    network.run(3_000 * MILLISECOND);
    let heard = events(&network, "EVENTS");
    assert_eq!(heard[&(0, 1)], (1..=1000).collect::<Vec<u64>>());
    assert_eq!(heard[&(0, 2)], (1..=1000).collect::<Vec<u64>>());
    assert!(network.told(1).iter().any(|line| line == "Back 0"), "{:?}", network.told(1));
}

#[test]
fn who_joins_late_gets_the_newest_state_and_events_from_then_on() {
    let mut network = Lossy::new(2, Weather::calm(), 1);
    network.run(500 * MILLISECOND);
    for _ in 0..20 {
        network.send(0, "EVENTS");
        network.put(0, "STATES", 3);
        network.put(0, "STATES", 4);
        network.run(10 * MILLISECOND);
    }
    network.join();
    network.run(1_000 * MILLISECOND);
    network.send(0, "EVENTS");
    network.run(1_000 * MILLISECOND);
    assert_eq!(events(&network, "EVENTS")[&(0, 2)], [21]);
    let states: Vec<(Option<u64>, u64)> = network
        .delivered
        .iter()
        .filter(|one| &*one.topic == "STATES" && one.reader == 2)
        .map(|one| (one.key, one.number))
        .collect();
    assert_eq!(states, [(Some(3), 39), (Some(4), 40)]);
}

#[test]
fn events_that_nobody_takes_in_time_are_counted_at_both_ends() {
    let mut network = Lossy::new(2, Weather::calm(), 1);
    network.run(500 * MILLISECOND);
    // All within the patience of the sender.
    network.is_cut = true;
    for _ in 0..2000 {
        network.send(0, "EVENTS");
    }
    network.is_cut = false;
    network.run(3_000 * MILLISECOND);
    let count = |told: Vec<String>, what: &str| -> u64 {
        told.iter().filter_map(|line| line.strip_prefix(what)?.parse::<u64>().ok()).sum()
    };
    let (sender, reader) = (count(network.told(0), "Overflow EVENTS "), count(network.told(1), "Lost 0 EVENTS "));
    assert!(sender > 0);
    assert_eq!(sender, reader);
    assert_eq!(events(&network, "EVENTS")[&(0, 1)].len() as u64 + reader, 2000);
}

#[test]
fn readers_learn_of_events_that_found_no_room_on_their_way_to_the_network() {
    let mut network = Lossy::new(2, Weather::calm(), 1);
    network.run(500 * MILLISECOND);
    network.send(0, "EVENTS");
    network.run(500 * MILLISECOND);
    network.programs[0].exchange.skip(&Arc::from("EVENTS"), 5, None);
    network.run(500 * MILLISECOND);
    assert!(network.told(1).contains(&"Lost 0 EVENTS 5".to_owned()), "{:?}", network.told(1));
    network.send(0, "EVENTS");
    network.run(500 * MILLISECOND);
    assert_eq!(events(&network, "EVENTS")[&(0, 1)], [1, 2]);
    // Those of a state folder have numbers of their own.
    network.programs[0].exchange.skip(&Arc::from("EVENTS"), 2, Some(20));
    network.programs[0].exchange.skip(&Arc::from("EVENTS"), 2, Some(20));
    network.send(0, "EVENTS");
    network.run(1_000 * MILLISECOND);
    assert_eq!(events(&network, "EVENTS")[&(0, 1)], [1, 2, 3]);
    assert!(network.told(1).contains(&"Lost 0 EVENTS 13".to_owned()), "{:?}", network.told(1));
    assert!(network.programs[0].exchange.is_complete());
}

#[test]
fn events_without_room_cost_none_of_those_that_are_on_their_way() {
    for leaves in [false, true] {
        let mut network = Lossy::new(2, Weather::calm(), 1);
        network.run(500 * MILLISECOND);
        network.send(0, "EVENTS");
        network.run(500 * MILLISECOND);
        // Nothing of this arrives at once, and the next signs of life do.
        network.is_cut = true;
        (0..3).for_each(|_| network.send(0, "EVENTS"));
        network.is_cut = false;
        network.programs[0].exchange.skip(&Arc::from("EVENTS"), 5, None);
        assert!(!network.programs[0].exchange.is_complete());
        network.send(0, "EVENTS");
        network.programs[0].exchange.skip(&Arc::from("EVENTS"), 2, None);
        network.run(2_000 * MILLISECOND);
        if leaves {
            network.programs[0].exchange.skip(&Arc::from("EVENTS"), 1, None);
            network.leave(0);
            network.run(500 * MILLISECOND);
        } else {
            network.send(0, "EVENTS");
            network.run(2_000 * MILLISECOND);
            assert!(network.programs[0].exchange.is_complete());
        }
        let received = if leaves { 5 } else { 6 };
        assert_eq!(events(&network, "EVENTS")[&(0, 1)].len(), received);
        let told = |program: usize, what: &str| -> u64 {
            let told = network.told(program);
            told.iter().filter_map(|line| line.strip_prefix(what)?.parse::<u64>().ok()).sum()
        };
        assert_eq!(told(1, "Lost 0 EVENTS "), if leaves { 8 } else { 7 }, "{:?}", network.told(1));
        // The sender has counted them where they found no room.
        assert_eq!((told(0, "Overflow EVENTS "), network.programs[0].lost), (0, 0), "{:?}", network.told(0));
    }
}

#[test]
fn who_leaves_before_all_is_received_says_how_many_events_found_no_room() {
    let mut network = Lossy::new(2, Weather::calm(), 1);
    network.run(500 * MILLISECOND);
    network.is_cut = true;
    (0..3).for_each(|_| network.send(0, "EVENTS"));
    network.is_cut = false;
    network.programs[0].exchange.skip(&Arc::from("EVENTS"), 5, None);
    network.leave(0);
    network.programs[0].is_stopped = true;
    network.run(500 * MILLISECOND);
    assert!(network.told(0).contains(&"Unreceived 1 EVENTS 3".to_owned()), "{:?}", network.told(0));
    assert!(network.told(1).contains(&"Lost 0 EVENTS 8".to_owned()), "{:?}", network.told(1));
}

#[test]
fn a_component_that_begins_anew_in_another_program_is_heard_at_once() {
    let mut network = Lossy::new(2, Weather::calm(), 1);
    network.run(500 * MILLISECOND);
    (0..5).for_each(|_| network.send(0, "EVENTS"));
    network.run(500 * MILLISECOND);
    network.programs[0].is_stopped = true;
    network.join_with("Robot0", 0);
    network.run(200 * MILLISECOND);
    network.send(2, "EVENTS");
    network.run(3_000 * MILLISECOND);
    assert_eq!(events(&network, "EVENTS")[&(2, 1)], [1]);
    let told = network.told(1);
    assert!(told.contains(&"Anew Robot0 2 5".to_owned()), "{told:?}");
    assert!(!told.iter().any(|line| line.starts_with("Twice")), "{told:?}");
    // The first one was stopped alone: it comes back, and the component runs twice.
    network.programs[0].is_stopped = false;
    network.send(0, "EVENTS");
    network.run(3_000 * MILLISECOND);
    assert_eq!(events(&network, "EVENTS")[&(0, 1)].len(), 5);
    let told: Vec<String> = network.told(1).into_iter().filter(|line| line.starts_with("Twice")).collect();
    assert_eq!(told, ["Twice Robot0 0"]);
}

#[test]
fn messages_of_another_schema_are_told_once_and_do_not_count() {
    let mut network = Lossy::new(1, Weather::calm(), 1);
    network.join_with("Robot1", 7);
    network.run(500 * MILLISECOND);
    (0..3).for_each(|_| network.send(0, "EVENTS"));
    network.run(2_000 * MILLISECOND);
    assert_eq!(events(&network, "EVENTS"), Heard::new());
    let told: Vec<String> = network.told(1).into_iter().filter(|line| line.starts_with("Differs")).collect();
    assert_eq!(told, ["Differs 0 Robot0 EVENTS"]);
    assert!(network.programs[0].exchange.is_complete(), "nothing is kept for who does not want it");
}

#[test]
fn who_leaves_waits_for_readers_that_are_away_and_then_says_what_they_lack() {
    let mut network = Lossy::new(2, Weather::calm(), 1);
    network.run(500 * MILLISECOND);
    network.programs[1].is_stopped = true;
    (0..3).for_each(|_| network.send(0, "EVENTS"));
    network.run(5_000 * MILLISECOND);
    assert!(!network.programs[0].exchange.is_complete(), "it may come back");
    network.run(10_000 * MILLISECOND);
    assert!(network.programs[0].exchange.is_complete(), "it was missed for long");
    network.leave(0);
    assert_eq!(network.told(0).last().map(String::as_str), Some("Unreceived 1 EVENTS 3"));
}

fn weather() -> impl Strategy<Value = Weather> {
    (0..40_u32, 0..30_u32, 0..120_u64).prop_map(|(loss, repeats, jitter)| Weather { loss, repeats, jitter })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, ..ProptestConfig::default() })]

    #[test]
    fn nothing_is_lost_doubled_or_reordered(
        weather in weather(),
        seed in any::<u64>(),
        steps in prop::collection::vec((0..4_usize, 0..8_u8, 0..60_u64), 1..200),
    ) {
        // What a program sends is for those that it has heard of.
        let mut network = Lossy::new(3, Weather::calm(), seed);
        network.run(800 * MILLISECOND);
        network.change(weather);
        for (program, what, time) in steps {
            match what {
                0 if network.programs.len() < 5 => network.join(),
                1 => network.is_cut = !network.is_cut,
                2 => network.put(program % 3, "STATES", u64::from(what) % 2),
                _ => network.send(program % 3, "EVENTS"),
            }
            network.run(time * MILLISECOND);
        }
        network.is_cut = false;
        // What is lost again and again takes longer.
        for round in 0..10 {
            if round < 2 || (0..3).any(|sender| !network.programs[sender].exchange.is_complete()) {
                network.run(10_000 * MILLISECOND);
            }
        }
        let heard = events(&network, "EVENTS");
        assert_in_order(&heard);
        for sender in 0..3 {
            let last = network.sent(sender, "EVENTS");
            for reader in 0..3 {
                if reader != sender && last > 0 {
                    let numbers = heard.get(&(sender, reader)).cloned().unwrap_or_default();
                    prop_assert_eq!(numbers, (1..=last).collect::<Vec<u64>>());
                }
            }
            for reader in 3..network.programs.len() {
                if let Some(numbers) = heard.get(&(sender, reader)) {
                    prop_assert_eq!(numbers.last(), Some(&last));
                }
            }
            prop_assert!(network.programs[sender].exchange.is_complete());
        }
        for (key, number) in network.newest_states() {
            for reader in 0..network.programs.len() {
                let heard = network.delivered.iter().filter(|one| {
                    &*one.topic == "STATES" && one.reader == reader && (one.sender, one.key) == key
                });
                let last = heard.map(|one| one.number).next_back();
                prop_assert!(reader == key.0 || last == Some(number), "{reader} has {last:?} of {key:?}, not {number}");
            }
        }
    }
}

#[test]
fn programs_that_died_make_room_for_new_ones() {
    let mut exchange = Exchange::new(Settings {
        program: 0,
        began: 0,
        name: "own".to_owned(),
        patience: 1_000 * MILLISECOND,
        limit: 8 << 10,
        linger: 10_000 * MILLISECOND,
        components: BTreeSet::new(),
        others: BTreeSet::new(),
        memory: None,
    });
    let alive = |program: u64| Alive {
        program,
        number: 1,
        name: format!("crashes-{program}"),
        patience: 1_000,
        ..Alive::default()
    };
    let joined = |exchange: &mut Exchange, name: &str| {
        let is_it = |action: &Action| matches!(action, Action::Tell(News::Joined { name: one, .. }) if &**one == name);
        exchange.take_actions().iter().any(is_it)
    };
    let most = MOST_PROGRAMS as u64;
    (1..=most).for_each(|program| exchange.hear(&alive(program), program * MILLISECOND));
    assert!(joined(&mut exchange, &format!("crashes-{most}")));
    // All of them are there.
    exchange.hear(&alive(most + 1), most * MILLISECOND);
    assert!(!joined(&mut exchange, &format!("crashes-{}", most + 1)));
    exchange.tick((most + 2_000) * MILLISECOND);
    exchange.hear(&alive(most + 2), (most + 2_000) * MILLISECOND);
    assert!(joined(&mut exchange, &format!("crashes-{}", most + 2)));
    let known: Vec<u64> = exchange.others().map(|(program, _)| program).collect();
    assert!(known.len() == MOST_PROGRAMS && !known.contains(&1), "{}", known.len());
}
