//! The rules of the manual, with the numbers of its transcripts.
//!
//! They are kept for those transcripts and have known gaps: a robot that stops is invisible to others, swaps and idle
//! robots are not seen, and the battery is low at a fixed level, however far the charger is.

mod battery;
mod collision;
mod critical_situation;
mod event_luggage;
mod path_follower;
mod robot_list;
mod robot_state;

pub use battery::ClassicBattery;
pub use collision::ClassicCollision;
pub use critical_situation::ClassicCriticalSituation;
pub use event_luggage::ClassicEventLuggage;
pub use path_follower::ClassicPathFollower;
pub use robot_list::ClassicRobotList;
pub use robot_state::ClassicRobotState;
