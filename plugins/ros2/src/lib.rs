//! Topics of ROS 2 over Zenoh, as `rmw_zenoh` speaks it (`ros2://host:port`).
//!
//! A program is a node, `/saoms`. It joins the router of the nodes, or is that router if it listens. Of each topic it
//! has the name, the type and the hash of the type, as nodes have them: those with another definition of a type do not
//! hear each other.

mod key;
mod session;
mod settings;
#[cfg(test)]
mod tests;

use self::session::Session;

saoms_transport::topic_transport!(Session, saoms_transport_ros2, schemes: r#"["ros2"]"#);
