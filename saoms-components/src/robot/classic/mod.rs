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

use saoms_api::{DynLoop, Failure, Loop, Loops};

pub use battery::BatteryMS;
pub use collision::CollisionMS;
pub use critical_situation::CriticalSituationMS;
pub use event_luggage::EventLuggageMS;
pub use path_follower::PathFollowerMS;
pub use robot_list::RobotListMS;
pub use robot_state::RobotMS;

/// These loops in their order.
pub(super) fn loops() -> Result<Loops, Failure> {
    let loops: [(&str, Box<dyn DynLoop>); 7] = [
        ("RobotMS", Box::new(RobotMS::new(())?)),
        ("BatteryMS", Box::new(BatteryMS::new(())?)),
        ("RobotListMS", Box::new(RobotListMS::new(())?)),
        ("CriticalSituationMS", Box::new(CriticalSituationMS::new(())?)),
        ("EventLuggageMS", Box::new(EventLuggageMS::new(())?)),
        ("CollisionMS", Box::new(CollisionMS::new(())?)),
        ("PathFollowerMS", Box::new(PathFollowerMS::new(())?)),
    ];
    Ok(Loops::of(loops.map(|(name, instance)| (name.to_owned(), instance))))
}
