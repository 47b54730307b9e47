//! The loops of a robot that neither collides nor runs out of battery, whatever the periods of the others.
//!
//! - *Energy*: the robot takes only jobs for which the battery lasts to the end and back to the charger, and returns in
//!   time. See [`SafeBattery`].
//! - *Rest*: it sleeps if it is not needed, until it is woken. See [`SafeRobotState`].
//! - *Emergencies*: when it breaks, another robot takes over its job. See [`SafeCriticalSituation`].
//! - *Jobs*: it announces its interest in the luggage that suits it best. It takes the job once no other interested
//!   robot is closer. See [`SafeEventLuggage`].
//! - *Right of way*: it announces the block that it wants, and enters it once no other robot holds or wants it. If
//!   robots meet, the one with the lower priority makes way. See [`SafeCollision`] and [`SafePathFollower`].

mod battery;
mod chargers;
mod collision;
mod critical;
mod dead_end;
mod energy;
mod event_luggage;
mod gripper;
mod leg;
mod pace;
mod path_follower;
mod patience;
mod robot_list;
mod robot_state;
mod sharing;
mod traffic;
mod waiting;
mod zoned;

pub use battery::SafeBattery;
pub use collision::SafeCollision;
pub use critical::SafeCriticalSituation;
pub use event_luggage::SafeEventLuggage;
pub use gripper::SafeGripper;
pub use path_follower::SafePathFollower;
pub use robot_list::SafeRobotList;
pub use robot_state::SafeRobotState;

pub(super) use energy::Energy;
pub(crate) use energy::{RESERVE, is_within};
pub(super) use leg::Leg;
pub(super) use traffic::{Traffic, TrafficMemory};
