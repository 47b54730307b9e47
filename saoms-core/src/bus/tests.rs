use std::collections::VecDeque;
use std::sync::Arc;

use proptest::prelude::*;
use saoms_api::host::SharedMessage;
use saoms_api::{Cause, Header, Message, Time, Topic};

use super::{Bus, TopicReader};

#[derive(Clone, Debug, PartialEq, Message)]
#[message(key = "key")]
struct Keyed {
    key: u8,
    value: u32,
}

#[derive(Clone, Debug, PartialEq, Message)]
struct Plain {
    value: u32,
}

const STATE: Topic<Keyed> = Topic::state("T");
const OWN: Topic<Plain> = Topic::state("T");
const EVENT: Topic<Plain> = Topic::event("T");

fn who() -> Arc<str> {
    Arc::from("somebody")
}

fn header(sender: u32) -> Header {
    Header { sender, sent: Time::START, cause: Cause::default() }
}

fn collect(bus: &mut Bus, subscription: &mut TopicReader) -> (Vec<SharedMessage>, u64) {
    let mut inbox = Vec::new();
    let lost = bus.collect(subscription, &mut inbox);
    (inbox, lost)
}

#[derive(Clone, Debug)]
enum Step {
    Publish(u8),
    Join(usize),
    Leave(usize),
    Read(usize),
}

fn steps() -> impl Strategy<Value = Vec<Step>> {
    let step = prop_oneof![
        6 => any::<u8>().prop_map(Step::Publish),
        1 => (1..6_usize).prop_map(Step::Join),
        1 => (0..8_usize).prop_map(Step::Leave),
        3 => (0..8_usize).prop_map(Step::Read),
    ];
    prop::collection::vec(step, 0..300)
}

proptest! {
    /// Against queues that are kept one by one.
    #[test]
    fn each_reader_of_events_has_a_queue_of_its_own(steps in steps()) {
        let mut bus = Bus::default();
        let topic = bus.publisher("T", &EVENT.declaration(), &who()).unwrap();
        let mut readers: Vec<(TopicReader, usize, VecDeque<u32>, u64)> = Vec::new();
        let mut number = 0;
        for step in steps {
            match step {
                Step::Publish(_) => {
                    number += 1;
                    assert!(bus.publish(topic, SharedMessage::new(header(0), Plain { value: number })));
                    for (_, length, queue, lost) in &mut readers {
                        queue.push_back(number);
                        if queue.len() > *length {
                            queue.pop_front();
                            *lost += 1;
                        }
                    }
                }
                Step::Join(length) => {
                    let subscription = bus.subscribe("T", &EVENT.declaration(), &who(), length).unwrap();
                    readers.push((subscription, length, VecDeque::new(), 0));
                }
                Step::Leave(place) if place < readers.len() => {
                    let (subscription, _, _, lost) = readers.swap_remove(place);
                    prop_assert_eq!(bus.unsubscribe(subscription), lost);
                }
                Step::Read(place) if place < readers.len() => {
                    let (subscription, _, queue, lost) = &mut readers[place];
                    let (inbox, missing) = collect(&mut bus, subscription);
                    let values: Vec<u32> = inbox.iter().map(|shared| shared.get::<Plain>().unwrap().value).collect();
                    prop_assert_eq!(std::mem::take(queue), values);
                    prop_assert_eq!(missing, std::mem::take(lost));
                }
                Step::Leave(_) | Step::Read(_) => {}
            }
        }
    }

    /// Compares with a list of all changes, where the newest of each key counts.
    #[test]
    fn each_reader_of_a_state_gets_what_changed(steps in steps()) {
        let mut bus = Bus::default();
        let topic = bus.publisher("T", &STATE.declaration(), &who()).unwrap();
        let mut all: Vec<Keyed> = Vec::new();
        let mut readers: Vec<(TopicReader, usize)> = Vec::new();
        for step in steps {
            match step {
                Step::Publish(key) => {
                    let message = Keyed { key: key % 5, value: all.len() as u32 };
                    all.push(message.clone());
                    assert!(bus.publish(topic, SharedMessage::new(header(0), message)));
                }
                Step::Join(length) => {
                    readers.push((bus.subscribe("T", &STATE.declaration(), &who(), length).unwrap(), 0));
                }
                Step::Leave(place) if place < readers.len() => {
                    prop_assert_eq!(bus.unsubscribe(readers.swap_remove(place).0), 0);
                }
                Step::Read(place) if place < readers.len() => {
                    let (subscription, read) = &mut readers[place];
                    let (inbox, lost) = collect(&mut bus, subscription);
                    let values: Vec<Keyed> = inbox.iter().map(|shared| shared.get::<Keyed>().unwrap().clone()).collect();
                    let newest = |(place, entry): &(usize, &Keyed)| all[place + 1..].iter().all(|later| later.key != entry.key);
                    let expected: Vec<Keyed> =
                        all.iter().enumerate().skip(*read).filter(newest).map(|(_, entry)| entry.clone()).collect();
                    prop_assert_eq!(values, expected);
                    prop_assert_eq!(lost, 0);
                    *read = all.len();
                }
                Step::Leave(_) | Step::Read(_) => {}
            }
        }
    }
}

#[test]
fn without_a_key_each_publisher_has_its_own() {
    let mut bus = Bus::default();
    let topic = bus.publisher("T", &OWN.declaration(), &who()).unwrap();
    for (sender, value) in [(1, 10), (2, 20), (1, 11)] {
        assert!(bus.publish(topic, SharedMessage::new(header(sender), Plain { value })));
    }
    let mut reader = bus.subscribe("T", &OWN.declaration(), &who(), 1).unwrap();
    let (inbox, _) = collect(&mut bus, &mut reader);
    let values: Vec<u32> = inbox.iter().map(|shared| shared.get::<Plain>().unwrap().value).collect();
    assert_eq!(values, [20, 11]);
    bus.rewind(&mut reader);
    assert_eq!(collect(&mut bus, &mut reader).0.len(), 2);
    assert_eq!(collect(&mut bus, &mut reader).0.len(), 0);
}

#[test]
fn nobody_hides_what_another_publisher_said_under_the_same_key() {
    let mut bus = Bus::default();
    let topic = bus.publisher("T", &STATE.declaration(), &who()).unwrap();
    let mut reader = bus.subscribe("T", &STATE.declaration(), &who(), 1).unwrap();
    for (sender, value) in [(1, 10), (2, 20), (1, 11), (2, 21)] {
        assert!(bus.publish(topic, SharedMessage::new(header(sender), Keyed { key: 7, value })));
    }
    let mut values = || -> Vec<u32> {
        collect(&mut bus, &mut reader).0.iter().map(|shared| shared.get::<Keyed>().unwrap().value).collect()
    };
    assert_eq!(values(), [11, 21]);
    assert!(bus.publish(topic, SharedMessage::new(header(1), Keyed { key: 7, value: 12 })));
    let mut late = bus.subscribe("T", &STATE.declaration(), &who(), 1).unwrap();
    let late: Vec<u32> =
        collect(&mut bus, &mut late).0.iter().map(|shared| shared.get::<Keyed>().unwrap().value).collect();
    assert_eq!(late, [21, 12]);
}

#[test]
fn messages_that_all_have_read_are_let_go() {
    let mut bus = Bus::default();
    let topic = bus.publisher("T", &EVENT.declaration(), &who()).unwrap();
    let mut reader = bus.subscribe("T", &EVENT.declaration(), &who(), 1_000_000).unwrap();
    let mut peak = 0;
    for value in 0..10_000 {
        assert!(bus.publish(topic, SharedMessage::new(header(0), Plain { value })));
        assert_eq!(collect(&mut bus, &mut reader).0.len(), 1);
        peak = peak.max(bus.topics[topic.0 as usize].held());
    }
    assert!(peak <= 32, "{peak}");
}

#[test]
fn a_topic_that_nobody_uses_may_carry_something_else() {
    let mut bus = Bus::default();
    let topic = bus.publisher("T", &STATE.declaration(), &who()).unwrap();
    assert!(bus.publisher("T", &OWN.declaration(), &who()).is_err());
    bus.unpublish(topic);
    let reader = bus.subscribe("T", &EVENT.declaration(), &who(), 1).unwrap();
    let refused = bus.publisher("T", &OWN.declaration(), &who()).unwrap_err();
    assert_eq!(
        refused.to_string(),
        "topic `T` carries event messages `Plain`, as component `somebody` uses it, but here it would carry state messages \
         `Plain`: rename one of the two with `topicRename`, or use the same message in both"
    );
    bus.unsubscribe(reader);
    bus.publisher("T", &OWN.declaration(), &who()).unwrap();
}

#[test]
fn two_messages_of_one_name_show_what_differs() {
    mod other {
        #[derive(Clone, Debug, PartialEq, saoms_api::Message)]
        pub(super) struct Plain {
            pub(super) other: u32,
        }
    }
    const OTHER: Topic<other::Plain> = Topic::event("T");
    let mut bus = Bus::default();
    bus.publisher("T", &EVENT.declaration(), &who()).unwrap();
    let refused = bus.publisher("T", &OTHER.declaration(), &who()).unwrap_err().to_string();
    assert!(refused.contains("value") && refused.contains("other"), "{refused}");
}

#[test]
fn schemas_that_say_the_same_agree_however_they_are_written() {
    let mut bus = Bus::default();
    bus.publisher("T", &EVENT.declaration(), &who()).unwrap();
    let by_hand = r#"{ "fields": [ { "type": "uint32", "name": "value" } ], "name": "Plain" }"#;
    let declared = saoms_api::host::TopicDeclaration { schema: by_hand, ..EVENT.declaration() };
    assert!(bus.subscribe("T", &declared, &who(), 1).is_ok());
    let other = by_hand.replace("uint32", "int32");
    assert!(bus.subscribe("T", &saoms_api::host::TopicDeclaration { schema: &other, ..declared }, &who(), 1).is_err());
}

#[test]
fn a_publisher_has_a_bounded_number_of_keys_on_a_state_topic() {
    #[derive(Clone, Debug, PartialEq, Message)]
    #[message(key = "key")]
    struct Wide {
        key: u32,
    }
    let mut bus = Bus::default();
    let topic = bus.publisher("T", &Topic::<Wide>::state("T").declaration(), &who()).unwrap();
    let mut publish = |sender, key| bus.publish(topic, SharedMessage::new(header(sender), Wide { key }));
    assert!((0..super::MOST_KEYS).all(|key| publish(1, key)));
    assert!(!publish(1, super::MOST_KEYS), "a key too many");
    assert!(publish(1, 7) && publish(2, super::MOST_KEYS), "a known key, and another publisher");
    let mut reader = bus.subscribe("T", &Topic::<Wide>::state("T").declaration(), &who(), 1).unwrap();
    assert_eq!(collect(&mut bus, &mut reader).0.len(), super::MOST_KEYS as usize + 1);
}
