//! What of the bus outlives the program: the events that readers have not read, and what state topics retain.

use saoms_api::host::{SharedMessage, TopicKind};

use super::topic::{BusTopic, ReadPosition};
use super::{Bus, TopicId};

impl Bus {
    /// Visits the events of a topic that wait for its readers, each with the component that reads it.
    pub fn unread(&self, topic: TopicId, mut visit: impl FnMut(u32, &SharedMessage)) {
        let main = &self.topics[topic.0 as usize];
        let links = main.readers.have_links();
        if main.kind() != TopicKind::Event || !links && !main.has_unread() {
            return;
        }
        for (number, component, position) in main.readers.positions() {
            let own = main.readers.link(number).map_or(main, |link| &self.topics[link.0 as usize]);
            own.unread_at(&position, |message| visit(component, message));
        }
    }

    /// Appends what a state topic retains and that changed after the `since`-th change, oldest first.
    pub fn changed_states(&self, topic: TopicId, since: &mut u64, messages: &mut Vec<SharedMessage>) {
        self.topics[topic.0 as usize].changed_states(since, messages);
    }
}

impl BusTopic {
    fn unread_at(&self, position: &ReadPosition, visit: impl FnMut(&SharedMessage)) {
        match position {
            ReadPosition::Event(place) => {
                self.log().map(|log| log.unread(*place)).into_iter().flatten().for_each(visit)
            }
            ReadPosition::Region(place) => {
                self.regions().map(|regions| regions.unread(*place)).into_iter().flatten().for_each(visit);
            }
            ReadPosition::State { .. } => {}
        }
    }
}
