//! The loops of a robot that neither collides nor runs out of battery, whatever the periods of the others.
//!
//! - *Energy*: it takes only jobs for which the battery lasts to the end and back to the charger, and turns back in time. See [`BatteryMS`].
//! - *Rest*: it sleeps where it is not needed, until it is awaked. See [`RobotMS`].
//! - *Emergencies*: when it breaks, another robot takes over its job. See [`CriticalSituationMS`].
//! - *Jobs*: it takes an interest in the luggage that suits it best and says so; it takes the job once no other robot that is interested is
//!   closer. See [`EventLuggageMS`].
//! - *Right of way*: it says which block it wants, and goes there once nobody else holds or wants it. Where robots meet, the one with the
//!   lower priority makes way. See [`CollisionMS`] and [`PathFollowerMS`].

mod battery;
mod collision;
mod critical;
mod energy;
mod event_luggage;
mod gripper;
mod leg;
mod pace;
mod path_follower;
mod patience;
mod robot_list;
mod robot_state;
mod traffic;

pub use battery::BatteryMS;
pub use collision::CollisionMS;
pub use critical::CriticalSituationMS;
pub use event_luggage::EventLuggageMS;
pub use gripper::GripperMS;
pub use path_follower::PathFollowerMS;
pub use robot_list::RobotListMS;
pub use robot_state::RobotMS;

pub(super) use energy::Energy;
pub(crate) use energy::is_within;
pub(super) use leg::Leg;
pub(super) use traffic::Traffic;
