use saoms_api::{Message, Topic};
use saoms_components::grid::Block;

/// A flight whose luggage has to be brought to the airplane.
#[derive(Clone, Debug, Default, PartialEq, Eq, Message)]
pub struct Flight {
    /// The flight's number.
    pub number: u32,
    /// How many pieces of luggage there are.
    pub pieces: u32,
    /// Where they wait.
    pub from: Block,
    /// Where the airplane is.
    pub to: Block,
}

/// How far the luggage of a flight is.
#[derive(Clone, Debug, Default, PartialEq, Eq, Message)]
#[message(key = "number")]
pub struct FlightState {
    /// The flight's number.
    pub number: u32,
    /// How many pieces are not there yet.
    pub open: u32,
    /// How many are on board.
    pub loaded: u32,
    /// How many nobody can bring.
    pub lost: u32,
}

/// Flights, as airlines announce them.
pub const FLIGHT: Topic<Flight> = Topic::event("FLIGHTTOPIC");

/// How far each flight is.
pub const FLIGHT_STATE: Topic<FlightState> = Topic::state("FLIGHTSTATETOPIC");
