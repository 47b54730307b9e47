//! The masters: of the environment, which distributes its events, and of the robots, which wakes them.

mod assignment;
mod environment;
mod event_filter;
mod open_luggage;
mod part;
pub mod robot;
mod unanswered;

pub use assignment::{
    AssignmentDecision, AssignmentPolicy, Crew, MasterAssignment, MasterEnvironmentKnowledge, Member, Unassigned,
};
pub use environment::{MasterEnvironment, MasterEnvironmentProperties};
pub use open_luggage::{OpenLuggage, WaitingPiece};
pub(crate) use part::FIRST;
pub use robot::MasterRobot;
