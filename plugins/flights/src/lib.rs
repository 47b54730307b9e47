//! A master of the environment that also handles flights: listing 6.13 of the manual.
//!
//! [`FlightMaster`] wraps the master that ships, and does everything that it does. In addition it subscribes to
//! [`Flight`]s on a topic of its own, turns each into requests for luggage, and publishes their progress on another
//! topic.

mod airline;
mod master;
mod messages;
mod open;

pub use airline::Airline;
pub use master::FlightMaster;
pub use messages::{FLIGHT, FLIGHT_STATE, Flight, FlightState};

saoms_api::plugin! {
    classes: [FlightMaster, Airline],
}
