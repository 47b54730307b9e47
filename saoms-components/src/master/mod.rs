//! The masters: one sorts what the environment says, one keeps an eye on the robots.

mod environment;
mod gate;
mod open;
pub mod robot;

pub use environment::MasterEnvironment;
pub use robot::MasterRobot;
