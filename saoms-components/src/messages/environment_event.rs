use saoms_api::Message;

use super::{EventLuggage, ExceptionalEvent};

/// Something that happened outside the fleet: new luggage, an exceptional event, or several of both at once.
#[derive(Clone, Debug, Default, PartialEq, Eq, Message)]
pub struct EnvironmentEvent {
    /// Luggage to bring from one block to another; each is a request.
    pub luggage: Vec<EventLuggage>,
    /// Landings and take-offs.
    pub exceptional: Vec<ExceptionalEvent>,
}

impl From<EventLuggage> for EnvironmentEvent {
    fn from(luggage: EventLuggage) -> EnvironmentEvent {
        EnvironmentEvent { luggage: vec![luggage], exceptional: Vec::new() }
    }
}

impl From<ExceptionalEvent> for EnvironmentEvent {
    fn from(event: ExceptionalEvent) -> EnvironmentEvent {
        EnvironmentEvent { luggage: Vec::new(), exceptional: vec![event] }
    }
}
