use saoms_api::{Message, Topic};
use saoms_components::grid::Block;

/// A flight, whose luggage has to be brought to the airplane.
#[derive(Clone, Debug, Default, PartialEq, Eq, Message)]
pub struct Flight {
    /// Number of the flight.
    pub number: u32,
    /// Number of pieces of luggage.
    pub pieces: u32,
    /// Block where the luggage waits.
    pub from: Block,
    /// Block of the airplane.
    pub to: Block,
}

/// Progress of the luggage of a flight.
#[derive(Clone, Debug, Default, PartialEq, Eq, Message)]
#[message(key = "number")]
pub struct FlightState {
    /// Number of the flight.
    pub number: u32,
    /// Number of pieces that are not at the airplane yet.
    pub open: u32,
    /// Number of pieces at the airplane.
    pub loaded: u32,
    /// Number of pieces that no robot can bring.
    pub lost: u32,
}

/// Flights, as airlines announce them.
pub const FLIGHT: Topic<Flight> = Topic::event("FLIGHTTOPIC");

/// Progress of each flight, the newest message of each.
pub const FLIGHT_STATE: Topic<FlightState> = Topic::state("FLIGHTSTATETOPIC");
