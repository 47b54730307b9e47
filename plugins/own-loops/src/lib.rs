//! A loop in place of each that ships.
//!
//! None of them shares a Rust type of a robot's inside: they reach its knowledge entry by entry, so that they work in
//! any robot, linked in or loaded. `saoms components saoms.Robot` lists the entries with their meaning.

mod battery;
mod classic;
mod collision;
mod critical;
mod gripper;
mod luggage;
mod master;
mod path;
mod robot_list;
mod robot_state;
mod step;

pub use battery::FixedBattery;
pub use classic::{ClassicWalker, EarlyBattery, Rested};
pub use collision::Distance;
pub use critical::Loner;
pub use gripper::SlowGripper;
pub use luggage::Zone;
pub use master::{AllHands, MeanBattery};
pub use path::Straight;
pub use robot_list::Announcer;
pub use robot_state::Naps;

saoms_api::plugin! {
    loops: [
        Naps, FixedBattery, Announcer, Loner, SlowGripper, Zone, Distance, Straight, Rested, EarlyBattery, ClassicWalker,
        AllHands, MeanBattery
    ],
}
