//! Other programs that say what cannot be.

use std::collections::BTreeSet;
use std::sync::Arc;

use proptest::prelude::*;
use saoms_api::host::cdr;

use super::lossy::MILLISECOND;
use crate::network::exchange::wire::{
    Again, Alive, Around, AroundState, CellChange, CellName, Covered, Enclosed, Envelope, InCell, KnownState, Look,
    Reads, Received, Sends, Welcome,
};
use crate::network::exchange::{Action, Destination, Exchange, OwnMessage, Settings};

/// Numbers at the edges of what there is.
fn edge() -> impl Strategy<Value = u64> {
    prop_oneof![Just(0), 1..6_u64, 6..3_000_u64, Just(u64::MAX - 1), Just(u64::MAX)]
}

fn topic() -> impl Strategy<Value = &'static str> {
    prop_oneof![Just("EVENTS"), Just("STATES"), Just("OTHER")]
}

#[derive(Clone, Debug)]
enum Said {
    Alive(Alive),
    Message(&'static str, Envelope),
    Again(Again),
    Covered(Covered),
    Look(Look),
    Around(Around),
    Want(u8),
    Own(bool),
    Tick(u64),
}

fn said() -> impl Strategy<Value = Said> {
    let numbers = || prop::collection::vec(edge(), 12);
    let alive =
        (0..4_u64, numbers(), topic(), any::<[bool; 2]>()).prop_map(|(program, number, topic, [is_state, leaves])| {
            let topic = topic.to_owned();
            Said::Alive(Alive {
                program,
                origin: number[10] % 4,
                start: number[11],
                began: number[11] % 4,
                name: "stranger".to_owned(),
                number: number[0],
                patience: number[1],
                sends: vec![Sends {
                    topic: topic.clone(),
                    is_state,
                    last: number[2],
                    oldest: number[3],
                    by_cells: is_state && number[3] % 2 == 0,
                    since: number[5],
                    cells: vec![CellChange { x: 0, y: 0, last: number[6] }],
                    before: number[9],
                }],
                reads: vec![Reads { topic: topic.clone() }],
                received: vec![Received { program: number[4] % 4, topic: topic.clone(), next: number[5] }],
                welcomes: vec![Welcome { reader: number[6] % 4, topic, first: number[7] }],
                vote: number[8] as u8,
                leaves: leaves && number[8] > 2,
            })
        });
    let sizes = prop_oneof![Just(vec![7]), prop::collection::vec(0..8_u32, 0..5), Just(vec![u32::MAX, 8])];
    let message =
        (0..4_u64, edge(), topic(), any::<bool>(), sizes).prop_map(|(program, number, topic, has_key, sizes)| {
            let enclosed = |size| Enclosed { size, to: String::new(), key: 1, has_key, sent: 0, cause: 0 };
            let (component, messages) = ("Stranger".to_owned(), sizes.into_iter().map(enclosed).collect());
            let cell = InCell { x: 0, y: (number % 2) as i32, before: number / 2, has_left: has_key };
            let cells = if number % 3 == 0 { Vec::new() } else { vec![cell, InCell { x: i32::MIN, ..cell }] };
            Said::Message(topic, Envelope { program, number, component, schema: number % 2, messages, cells })
        });
    let again = (numbers(), topic()).prop_map(|(number, topic)| Again {
        reader: 1,
        topic: topic.to_owned(),
        first: number[0],
        last: number[1],
    });
    let covered = (0..4_u64, numbers(), topic()).prop_map(|(program, number, topic)| {
        let (topic, first, last) = (topic.to_owned(), number[0], number[1]);
        Said::Covered(Covered { program, topic, first, last, numbers: number })
    });
    let look = (numbers(), topic()).prop_map(|(number, topic)| {
        let known = KnownState { component: "Own".to_owned(), number: number[1], ..KnownState::default() };
        let cells = vec![CellName { x: 0, y: 0 }, CellName { x: i32::MAX, y: i32::MIN }];
        Said::Look(Look { reader: 1, topic: topic.to_owned(), number: number[0], cells, known: vec![known] })
    });
    let around = (0..4_u64, numbers(), topic()).prop_map(|(program, number, topic)| {
        let message = |number: &u64| AroundState {
            number: *number,
            component: "Stranger".to_owned(),
            key: number % 3,
            has_key: number.is_multiple_of(2),
            ..AroundState::default()
        };
        Said::Around(Around {
            program,
            topic: topic.to_owned(),
            number: number[0] % 8,
            last: number[1],
            cells: vec![CellName { x: 0, y: 0 }, CellName { x: 7, y: 7 }],
            schema: number[2] % 2,
            here: number.clone(),
            messages: number.iter().map(message).collect(),
        })
    });
    prop_oneof![
        1 => look,
        2 => around,
        1 => (0..4_u8).prop_map(Said::Want),
        3 => alive,
        3 => message,
        1 => again.prop_map(Said::Again),
        1 => covered,
        1 => any::<bool>().prop_map(Said::Own),
        1 => (0..3_000_u64).prop_map(Said::Tick),
    ]
}

/// A program that another one tells of its newest message on both topics, which has this number.
fn told(own: &mut Exchange, number: u64, last: u64) {
    let sends = |(topic, is_state): (&str, bool)| Sends {
        topic: topic.to_owned(),
        is_state,
        last,
        oldest: 1,
        ..Sends::default()
    };
    let welcome = |topic: &str| Welcome { reader: 0, topic: topic.to_owned(), first: 1 };
    let alive = Alive {
        program: 2,
        name: "other".to_owned(),
        number,
        patience: 1_000,
        sends: [("EVENTS", false), ("STATES", true)].map(sends).to_vec(),
        welcomes: ["EVENTS", "STATES"].map(welcome).to_vec(),
        ..Alive::default()
    };
    own.hear(&alive, 0);
}

#[test]
fn one_message_that_says_that_all_is_outdated_cuts_no_program_off() {
    let mut own = Exchange::new(Settings {
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
    own.read(&Arc::from("EVENTS"), false, 0);
    own.read(&Arc::from("STATES"), true, 0);
    told(&mut own, 1, 3);
    for topic in ["EVENTS", "STATES"] {
        let (topic, last) = (topic.to_owned(), u64::MAX);
        own.cover(&Covered { program: 2, topic, first: 1, last, numbers: vec![u64::MAX] }, 0);
    }
    told(&mut own, 2, 5);
    own.take_actions();
    own.tick(100 * MILLISECOND);
    let asked: Vec<Again> = own
        .take_actions()
        .into_iter()
        .filter_map(|action| match action {
            Action::Put { to: Destination::Ask(2), bytes } => cdr::decode(&bytes).ok(),
            _ => None,
        })
        .collect();
    let asked: Vec<_> = asked.iter().map(|again| (again.topic.as_str(), again.first, again.last)).collect();
    assert_eq!(asked, [("EVENTS", 1, 5), ("STATES", 4, 5)], "states up to the third one may be outdated");
}

proptest! {
    #[test]
    fn nothing_that_is_said_ends_a_program(all in prop::collection::vec(said(), 1..60)) {
        let mut exchange = Exchange::new(Settings {
            program: 0,
            began: 3,
            name: "own".to_owned(),
            patience: 1_000 * MILLISECOND,
            limit: 8 << 10,
            linger: 10_000 * MILLISECOND,
            components: BTreeSet::from(["Own".to_owned()]),
            others: BTreeSet::new(),
            memory: None,
        });
        exchange.read(&Arc::from("EVENTS"), false, 0);
        exchange.read(&Arc::from("STATES"), true, 0);
        let mut now = 0;
        for said in all {
            match said {
                Said::Alive(alive) => exchange.hear(&alive, now),
                Said::Message(topic, envelope) => {
 exchange.receive(topic, b"message", &cdr::encode(&envelope), now);
}
                Said::Again(again) => exchange.answer(&again),
                Said::Covered(covered) => exchange.cover(&covered, now),
                Said::Look(look) => exchange.show(&look),
                Said::Around(around) => {
                    exchange.see(around, now);
                }
                Said::Want(what) => {
                    let cells = BTreeSet::from([(0, i32::from(what)), (i32::MIN, 0)]);
                    exchange.want(&Arc::from("STATES"), Some(&cells).filter(|_| what > 0), now);
                }
                Said::Own(is_state) => exchange.send(OwnMessage {
                    topic: &Arc::from(if is_state { "STATES" } else { "EVENTS" }),
                    is_state,
                    component: &Arc::from("Own"),
                    to: None,
                    key: None,
                    sent: 0,
                    schema: 0,
                    cause: 0,
                    place: is_state.then_some((0, now as i32)),
                    number: None,
                    bytes: &[0; 1_000],
                }),
                Said::Tick(milliseconds) => {
                    now += milliseconds * MILLISECOND;
                    exchange.tick(now);
                }
            }
            prop_assert!(exchange.take_actions().len() < 4_096);
        }
        exchange.leave();
    }
}
