//! The masters: of the environment, which distributes its events, and of the robots, which wakes them.

mod environment;
mod event_filter;
mod open_luggage;
pub mod robot;

pub use environment::MasterEnvironment;
pub use robot::MasterRobot;
