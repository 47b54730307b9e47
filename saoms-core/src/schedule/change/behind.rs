//! What code that a change may leave behind has on the bus. Its thread has the body then, and may never give it back:
//! what it reads and publishes ends at once, so that it holds up nobody, and what it does later has no effect on
//! others.

use std::collections::BTreeMap;

use saoms_api::Failure;

use crate::bus::{ReaderMark, TopicId, TopicReader};
use crate::schedule::component::body::Body;
use crate::schedule::component::part::Part;
use crate::schedule::engine::Engine;
use crate::schedule::engine::slot::SlotState;

/// Why code has no effect any more.
const LEFT_BEHIND: &str = "it did not return in time, and the change of the fleet has left it behind";

/// Bodies whose code runs in a change, on threads that may be left behind, by their numbers.
#[derive(Debug, Default)]
pub(crate) struct ApartBodies {
    count: u64,
    all: BTreeMap<u64, BusEnds>,
}

/// What a body has on the bus.
#[derive(Debug, Default)]
struct BusEnds {
    publishers: Vec<TopicId>,
    readers: Vec<ReaderMark>,
}

impl Engine {
    /// Notes that code of a body runs on a thread that may be left behind; the number of the body.
    pub(super) fn goes_apart(&mut self, body: &mut Body) -> u64 {
        let part = &mut body.part;
        let readers = part.subscriptions.iter().chain(&part.kept).map(TopicReader::mark).collect();
        let ends = BusEnds { publishers: part.publishers.clone(), readers };
        self.apart.count += 1;
        self.apart.all.insert(self.apart.count, ends);
        part.apart = Some(self.apart.count);
        self.apart.count
    }

    /// Notes that the code of a body has returned. False if it was left behind, and has nothing on the bus any more.
    pub(super) fn returns_from_apart(&mut self, body: &mut Body) -> bool {
        body.part.apart.take().is_none_or(|number| self.apart.all.remove(&number).is_some())
    }

    /// Forgets the number of a body whose code runs on no such thread any more.
    pub(super) fn no_longer_apart(&mut self, number: u64) {
        self.apart.all.remove(&number);
    }

    /// Takes off the bus what a body has there whose thread is left behind.
    pub(super) fn take_off(&mut self, number: u64) {
        let Some(BusEnds { publishers, readers }) = self.apart.all.remove(&number) else { return };
        publishers.into_iter().for_each(|topic| self.bus.unpublish(topic));
        // The newest mark of one that is there twice says what it triggers.
        for reader in readers.into_iter().rev() {
            self.bus.take_off(reader);
            self.tell_interest(reader.topic());
        }
    }

    /// True if a change has left the code of this component behind.
    pub(crate) fn is_left_behind(&self, part: &Part) -> bool {
        part.apart.is_some_and(|number| !self.apart.all.contains_key(&number))
    }

    /// True if the component has another instance than one whose code a change has left behind: in its place, or under
    /// its name in one of another class.
    pub(super) fn has_other_instance(&self, part: &Part) -> bool {
        let places = [Some(part.index), self.numbers.get(&part.name).copied()];
        places.into_iter().flatten().any(|number| {
            let slot = &self.slots[number as usize];
            match &slot.body {
                Some(body) => body.instance.is_some(),
                None => slot.state != SlotState::Abandoned,
            }
        })
    }

    /// Judges whether code of this component may act on others.
    ///
    /// # Errors
    /// A change has left it behind.
    pub(crate) fn may_act(&self, part: &Part) -> Result<(), Failure> {
        if self.is_left_behind(part) { Err(Failure::new(LEFT_BEHIND)) } else { Ok(()) }
    }

    /// Notes what code that runs apart publishes from now on.
    pub(crate) fn note_publisher(&mut self, part: &Part, topic: TopicId) {
        if let Some(ends) = part.apart.and_then(|number| self.apart.all.get_mut(&number)) {
            ends.publishers.push(topic);
        }
    }

    /// Notes what code that runs apart reads from now on.
    pub(crate) fn note_reader(&mut self, part: &Part, reader: &TopicReader) {
        if let Some(ends) = part.apart.and_then(|number| self.apart.all.get_mut(&number)) {
            ends.readers.push(reader.mark());
        }
    }
}
