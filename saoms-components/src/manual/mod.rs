//! The robot, the navigator and the GPS of the manual's figures 3.1 and 3.2.

mod gps;
mod navigator;
mod robot;

pub use gps::{Gps, GpsInterface, GpsInterfaceReference, Point};
pub use navigator::{Navigator, NavigatorProperties};
pub use robot::{ManualRobot, ManualRobotProperties, RobotInterface, RobotInterfaceReference};
