//! The rules of the manual, with the numbers of its transcripts.
//!
//! They are kept for those transcripts: a robot that stops is invisible to others, nobody sees swaps or idle robots, and the battery is low at a
//! fixed level, however far the charger is.

mod battery;
mod collision;
mod critical_situation;
mod event_luggage;
mod path_follower;
mod robot_list;
mod robot_state;

pub use battery::BatteryMS;
pub use collision::CollisionMS;
pub use critical_situation::CriticalSituationMS;
pub use event_luggage::EventLuggageMS;
pub use path_follower::PathFollowerMS;
pub use robot_list::RobotListMS;
pub use robot_state::RobotMS;
