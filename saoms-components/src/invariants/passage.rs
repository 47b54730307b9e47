//! Faults that keep the robots of a site from their grants.

use saoms_api::Time;
use saoms_api::event::fault::FaultCall;
use saoms_api::host::TopicDeclaration;

use super::tide::Tide;
use crate::messages::{AREA, GRANT, GRANT_REQUEST, POSITION, PRESENCE, TERRITORY, carries};

/// A topic without whose messages robots do not get on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Passage {
    /// One on which robots and zones speak with each other.
    Zones,
    /// That on which robots without zones agree who goes first.
    Peers,
}

impl Passage {
    /// The part that a topic has in it.
    pub(super) fn of(declared: &TopicDeclaration<'_>) -> Option<Passage> {
        let is_of_zones = carries(declared, &GRANT)
            || carries(declared, &GRANT_REQUEST)
            || carries(declared, &PRESENCE)
            || carries(declared, &TERRITORY);
        if is_of_zones { Some(Passage::Zones) } else { carries(declared, &POSITION).then_some(Passage::Peers) }
    }
}

/// True if robots do not get on without a component that publishes messages of this type: a world, a zone, or a robot,
/// which may be in the way.
pub(super) fn needs(message: &str) -> bool {
    let all = [AREA.declaration(), TERRITORY.declaration(), GRANT_REQUEST.declaration(), POSITION.declaration()];
    all.iter().any(|topic| topic.message == message)
}

/// The faults that act on the passage of the robots of a site.
#[derive(Debug, Default)]
pub(super) struct Passages {
    /// True once a zone has spoken.
    pub(super) has_zones: bool,
    zones: Tide,
    peers: Tide,
    components: Tide,
}

impl Passages {
    /// Notes a fault of the messages of a topic.
    pub(super) fn begin(&mut self, topic: Passage, at: Time, call: &FaultCall) {
        match topic {
            Passage::Zones => self.zones.begin(at, call),
            Passage::Peers => self.peers.begin(at, call),
        }
    }

    /// Notes a fault of a component.
    pub(super) fn begin_of_component(&mut self, at: Time, call: &FaultCall) {
        self.components.begin(at, call);
    }

    /// True if a fault may keep robots from their grants, or without zones from their turn.
    pub(super) fn are_kept(&self, at: Time) -> bool {
        let messages = if self.has_zones { &self.zones } else { &self.peers };
        [messages, &self.components].into_iter().any(|tide| tide.calm(Time::START, at).is_none())
    }
}
