use saoms_api::{Message, Topic};

use super::{EventLuggage, ExceptionalEvent, Fault};

/// Events of any kind from the environment.
pub const ENVIRONMENT: Topic<EnvironmentEvent> = Topic::event("ETOPIC");

/// Events outside the fleet: new luggage, exceptional events and faults, one or several at once.
#[derive(Clone, Debug, Default, PartialEq, Eq, Message)]
pub struct EnvironmentEvent {
    /// Requests to bring luggage.
    pub luggage: Vec<EventLuggage>,
    /// Landings and take-offs.
    pub exceptional: Vec<ExceptionalEvent>,
    /// Faults of robots.
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
