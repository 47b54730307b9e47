use saoms_api::Message;

use super::{EventLuggage, ExceptionalEvent, Fault};

/// Something that happened outside the fleet: new luggage, an exceptional event, or several of both at once.
#[derive(Clone, Debug, Default, PartialEq, Eq, Message)]
pub struct EnvironmentEvent {
    /// Luggage to bring from one block to another; each is a request.
    pub luggage: Vec<EventLuggage>,
    /// Landings and take-offs.
    pub exceptional: Vec<ExceptionalEvent>,
    /// Robots that break.
    pub faults: Vec<Fault>,
}

impl From<EventLuggage> for EnvironmentEvent {
    fn from(luggage: EventLuggage) -> EnvironmentEvent {
        EnvironmentEvent { luggage: vec![luggage], ..EnvironmentEvent::default() }
    }
}

impl From<ExceptionalEvent> for EnvironmentEvent {
    fn from(event: ExceptionalEvent) -> EnvironmentEvent {
        EnvironmentEvent { exceptional: vec![event], ..EnvironmentEvent::default() }
    }
}

impl From<Fault> for EnvironmentEvent {
    fn from(fault: Fault) -> EnvironmentEvent {
        EnvironmentEvent { faults: vec![fault], ..EnvironmentEvent::default() }
    }
}
