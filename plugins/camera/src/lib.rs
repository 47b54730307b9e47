//! A robot of the airport fleet that also takes pictures: listing 10.1 of the manual.
//!
//! [`CameraRobot`] wraps the robot that ships, does everything that it does, and publishes a [`CameraPicture`] on a
//! topic of its own. Nothing of the robot is changed or copied: `#[extends]` says that the class is one of robots.

mod picture;
mod robot;
mod viewer;

pub use picture::{CAMERA, CameraPicture};
pub use robot::CameraRobot;
pub use viewer::Viewer;

saoms_api::plugin! {
    classes: [CameraRobot, Viewer],
}
