//! Topics over rosbridge: JSON over WebSocket (`rosbridge://host:port`).
//!
//! The program that listens is a server, for browsers and for programs with `roslibpy`; others are clients of a server,
//! such as the `rosbridge_server` of ROS 2. A message is what its schema says, with the names that ROS 2 has: what does
//! not fit never reaches the fleet.

mod client;
mod form;
mod handshake;
mod incoming;
mod op;
mod rosapi;
mod server;
mod session;
mod settings;
mod socket;
#[cfg(test)]
mod tests;

use self::session::Session;

saoms_transport::topic_transport!(Session, saoms_transport_rosbridge, schemes: r#"["rosbridge"]"#);
