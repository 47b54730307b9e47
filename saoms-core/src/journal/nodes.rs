//! The journals of the nodes of a fleet as one.

use std::collections::HashMap;

use saoms_api::{Cause, Time};

use super::{Journal, JournalEntry};

/// Bits of the number of a record. Those above say the node of a record of another program, from 1.
const BITS: u32 = 40;
/// Nodes whose records can be named, at most: a number with all bits is one of JSON.
const MOST_NODES: u64 = 1 << 12;

/// A record of another node, by the place of the node among all nodes of the fleet, as a cause of one of this program.
/// `None` is the cause where it cannot be named.
pub(crate) fn of_node(node: usize, record: u64) -> Cause {
    let node = node as u64 + 1;
    let is_named = record != 0 && record >> BITS == 0 && node < MOST_NODES;
    if is_named { Cause(node << BITS | record) } else { Cause::default() }
}

/// The node of a record of another program, and its number there.
pub fn node_of(cause: Cause) -> Option<(usize, u64)> {
    let node = (cause.0 >> BITS).checked_sub(1)?;
    Some((usize::try_from(node).ok()?, cause.0 & ((1 << BITS) - 1)))
}

impl Journal {
    /// The journals of nodes as one: each with the place of the node among all nodes of the fleet, and the nanoseconds
    /// from the first begin of a program to that of this one. Records get new numbers, in the order of their times, but
    /// after what they follow from: the clocks of machines differ.
    pub(crate) fn of_nodes(journals: Vec<(usize, u64, Journal)>) -> Journal {
        let mut all = Journal::default();
        let mut waiting: Vec<((usize, u64), JournalEntry)> = Vec::new();
        for (node, offset, journal) in journals {
            let Journal { records, overwritten, lost, loops, entries } = journal;
            all.records += records;
            all.overwritten += overwritten;
            all.lost += lost;
            all.loops.extend(loops);
            for entry in entries {
                let time = Time::from_nanos(entry.time.as_nanos().saturating_add(offset));
                waiting.push(((node, entry.id.0), JournalEntry { time, ..entry }));
            }
        }
        waiting.sort_by_key(|((node, id), entry)| (entry.time, *node, *id));
        let places: HashMap<(usize, u64), usize> = waiting.iter().map(|(key, _)| *key).zip(0..).collect();
        let cause = |(node, _): (usize, u64), entry: &JournalEntry| match node_of(entry.cause) {
            Some(elsewhere) => elsewhere,
            None => (node, entry.cause.0),
        };
        // The new number of each record, from 1; 0 while it has none.
        let mut numbers = vec![0_u64; waiting.len()];
        let mut order = Vec::with_capacity(waiting.len());
        for start in 0..waiting.len() {
            // Back to what has a number: a program cannot know a record that follows from its own later ones, so that
            // there is no circle, but for files that somebody made up.
            let mut chain = Vec::new();
            let mut next = Some(start);
            while let Some(place) = next.filter(|place| numbers[*place] == 0) {
                numbers[place] = u64::MAX;
                chain.push(place);
                next = places.get(&cause(waiting[place].0, &waiting[place].1)).copied();
            }
            for place in chain.into_iter().rev() {
                order.push(place);
                numbers[place] = order.len() as u64;
            }
        }
        let mut entries: Vec<Option<((usize, u64), JournalEntry)>> = waiting.into_iter().map(Some).collect();
        for place in order {
            let Some((key, entry)) = entries[place].take() else { continue };
            let id = numbers[place];
            let known = places.get(&cause(key, &entry)).map(|place| numbers[*place]);
            let cause = match known {
                // A circle of a file that somebody made up.
                Some(number) if number >= id => Cause::default(),
                Some(number) => Cause(number),
                None if entry.cause == Cause::default() => Cause::default(),
                // It stays one that is missing.
                None if node_of(entry.cause).is_some() => entry.cause,
                None => of_node(key.0, entry.cause.0),
            };
            all.entries.push(JournalEntry { id: Cause(id), cause, ..entry });
        }
        all
    }
}
