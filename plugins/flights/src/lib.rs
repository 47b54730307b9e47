//! A master of the environment that also knows flights: listing 6.13 of the manual.
//!
//! [`MasterEnvironment`] wraps the master that ships, and does everything that it does. Beside that it hears of [`Flight`]s on a topic of its own,
//! turns each into requests for luggage, and says on another topic how far it is.

mod airline;
mod master;
mod messages;
mod open;

pub use airline::{Airline, AirlineProperties};
pub use master::{MasterEnvironment, MasterEnvironmentProperties};
pub use messages::{FLIGHT, FLIGHT_STATE, Flight, FlightState};

saoms_api::plugin! {
    classes: [MasterEnvironment, Airline],
}
