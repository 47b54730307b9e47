//! Readers with regions, held to a model that looks at all messages.

use std::collections::BTreeMap;
use std::ops::RangeInclusive;
use std::sync::Arc;

use saoms_api::host::SharedMessage;
use saoms_api::{Cause, Chance, Departed, Field, Header, Message, Region, Time, Topic};

use super::regions::RegionReaders;
use super::state::StateTable;
use super::{Bus, TopicReader};

#[derive(Clone, Copy, Debug, PartialEq, Field)]
#[field(pair)]
struct Block {
    x: i32,
    y: i32,
}

#[derive(Clone, Debug, PartialEq, Message)]
#[message(key = "key", place = "block")]
struct Seen {
    key: u32,
    block: Block,
    value: u64,
}

const STATE: Topic<Seen> = Topic::state("STATE");
const EVENT: Topic<Seen> = Topic::event("EVENT");

fn message(sender: u32, key: u32, (x, y): (i32, i32), value: u64) -> SharedMessage {
    let header = Header { sender, sent: Time::START, cause: Cause::default() };
    SharedMessage::new(header, Seen { key, block: Block { x, y }, value })
}

fn who() -> Arc<str> {
    Arc::from("A")
}

fn values(messages: &[SharedMessage]) -> Vec<u64> {
    messages.iter().map(|message| message.get::<Seen>().unwrap().value).collect()
}

/// What a reader of a state topic knows, by sender and key.
type View = BTreeMap<(u32, u64), u64>;

struct Reader {
    reader: TopicReader,
    region: Option<Region>,
    view: View,
}

impl Reader {
    /// Collects, and takes in first what left, then what came, or the other way round.
    fn collect(&mut self, bus: &mut Bus, departed_first: bool) {
        let (mut inbox, mut departed) = (Vec::new(), Vec::new());
        match self.region {
            Some(_) => bus.collect_in_region(&self.reader, &mut inbox, &mut departed),
            None => bus.collect(&mut self.reader, &mut inbox),
        };
        let leave = |view: &mut View| {
            for Departed { sender, key } in &departed {
                assert!(view.remove(&(*sender, *key)).is_some(), "it left and was never there");
            }
        };
        if departed_first {
            leave(&mut self.view);
        }
        for message in &inbox {
            let value = message.get::<Seen>().unwrap().value;
            self.view.insert((message.header().sender, message.key().unwrap()), value);
        }
        if !departed_first {
            leave(&mut self.view);
        }
    }
}

#[test]
fn a_reader_knows_the_newest_messages_of_its_region_whatever_moves() {
    for seed in 0..60 {
        let mut chance = Chance::new(seed);
        let side = [3, 40, 400][seed as usize % 3];
        let mut block = {
            let mut chance = Chance::new(seed + 1000);
            move || (chance.below(2 * side) as i32 - side as i32, chance.below(2 * side) as i32 - side as i32)
        };
        let mut bus = Bus::default();
        let topic = bus.publisher("STATE", &STATE.declaration(), &who()).unwrap();
        let mut readers = Vec::new();
        let mut truth: BTreeMap<(u32, u64), ((i32, i32), u64)> = BTreeMap::new();
        for step in 0..400_u64 {
            match chance.below(8) {
                0 if readers.len() < 5 => {
                    let reader = bus.subscribe("STATE", &STATE.declaration(), &who(), 4).unwrap();
                    readers.push(Reader { reader, region: None, view: View::new() });
                }
                1 if !readers.is_empty() => {
                    let place = chance.below(readers.len() as u64) as usize;
                    let region = match chance.below(6) {
                        0 => Region::new(i32::MIN..=i32::MAX, 0..=i32::MAX),
                        1 => Region::new(RangeInclusive::new(2, 1), 0..=5),
                        _ => Region::around(block(), chance.below(side) as u32),
                    };
                    // Who had no region knows everything; who gets one begins with what is there.
                    let one = &mut readers[place];
                    if one.region.is_none() {
                        one.view.clear();
                    }
                    one.region = Some(region);
                    bus.set_region(&mut one.reader, Some(region), 4);
                }
                2 if !readers.is_empty() => {
                    let place = chance.below(readers.len() as u64) as usize;
                    let departed_first = chance.below(2) == 0;
                    readers[place].collect(&mut bus, departed_first);
                    let Reader { region, view, .. } = &readers[place];
                    let is_seen = |block: (i32, i32)| region.is_none_or(|region| region.contains(block));
                    let seen = truth.iter().filter(|(_, (block, _))| is_seen(*block));
                    let expected: View = seen.map(|(key, (_, value))| (*key, *value)).collect();
                    assert_eq!(*view, expected, "seed {seed}, step {step}, {region:?}");
                }
                3 if !readers.is_empty() => {
                    // A collection that is put back and comes again.
                    let place = chance.below(readers.len() as u64) as usize;
                    let one = &mut readers[place];
                    let (mut inbox, mut departed) = (Vec::new(), Vec::new());
                    match one.region {
                        Some(_) => bus.collect_in_region(&one.reader, &mut inbox, &mut departed),
                        None => bus.collect(&mut one.reader, &mut inbox),
                    };
                    bus.put_back(&mut one.reader, &mut inbox);
                    assert!(inbox.is_empty());
                }
                _ => {
                    let (sender, key, at) = (chance.below(3) as u32, chance.below(10) as u32, block());
                    assert!(bus.publish(topic, message(sender, key, at, step)));
                    truth.insert((sender, u64::from(key)), (at, step));
                }
            }
        }
    }
}

#[test]
fn a_reader_gets_the_events_of_its_region_in_their_order() {
    let mut bus = Bus::default();
    let topic = bus.publisher("EVENT", &EVENT.declaration(), &who()).unwrap();
    let mut near = bus.subscribe("EVENT", &EVENT.declaration(), &who(), 3).unwrap();
    let mut all = bus.subscribe("EVENT", &EVENT.declaration(), &who(), 9).unwrap();
    bus.set_region(&mut near, Some(Region::around((0, 0), 1)), 3);
    for (value, block) in [(0, 0), (5, 5), (-1, 1), (1, 0), (2, 0)].into_iter().enumerate() {
        assert!(bus.publish(topic, message(1, 0, block, value as u64)));
    }
    let collect = |bus: &mut Bus, near: &TopicReader| {
        let (mut inbox, mut departed) = (Vec::new(), Vec::new());
        let lost = bus.collect_in_region(near, &mut inbox, &mut departed);
        (values(&inbox), lost, departed)
    };
    assert_eq!(collect(&mut bus, &near), (vec![0, 2, 3], 0, Vec::new()));
    assert!(!bus.has_news(&near));
    bus.set_region(&mut near, Some(Region::around((20, 20), 1)), 3);
    (5..10).for_each(|value| assert!(bus.publish(topic, message(1, 0, (20, 21), value))));
    assert!(bus.publish(topic, message(1, 0, (0, 0), 10)));
    assert_eq!(collect(&mut bus, &near), (vec![7, 8, 9], 2, Vec::new()));
    let mut inbox = Vec::new();
    assert_eq!((bus.collect(&mut all, &mut inbox), values(&inbox).len()), (2, 9));
    // Without a region it gets all that comes.
    bus.set_region(&mut near, None, 3);
    assert!(bus.publish(topic, message(1, 0, (-9, 9), 11)));
    inbox.clear();
    assert_eq!((bus.collect(&mut near, &mut inbox), values(&inbox)), (0, vec![11]));
    bus.set_region(&mut near, Some(Region::around((0, 0), 1)), 3);
    (0..5).for_each(|value| assert!(bus.publish(topic, message(1, 0, (0, 0), value))));
    assert_eq!(bus.unsubscribe(near), 2);
    assert!(bus.publish(topic, message(1, 0, (0, 0), 0)));
}

#[test]
fn changes_that_nobody_collects_take_no_memory_without_end() {
    let mut table = StateTable::default();
    let mut readers = RegionReaders::default();
    let place = readers.join(Region::around((0, 0), 1), 1, Some(&table));
    for value in 0..100_000 {
        let (entry, before) = table.publish(message(0, (value % 3) as u32, (0, 0), value)).unwrap();
        readers.changed(entry, before.and_then(|before| before.place()), Some((0, 0)));
        readers.move_to(place, Region::around((0, 0), 1 + (value % 2) as u32), Some(&table));
    }
    let waiting = readers.waiting_changes(place);
    assert!(waiting < 1000, "{waiting} changes of 3 messages wait");
    let (mut inbox, mut departed) = (Vec::new(), Vec::new());
    readers.collect(place, Some(&table), &mut inbox, &mut departed);
    assert_eq!((values(&inbox), departed), (vec![99_997, 99_998, 99_999], Vec::new()));
}
