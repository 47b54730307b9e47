//! A small transport, as an example: `relay://host:port` is a program that listens and passes on what others send.
//!
//! No TLS, no user: it is for one machine, and to show what a transport is. `boundary.rs` is the boundary to the
//! program, `frame.rs` what goes over a connection, `session.rs` the connections.

mod boundary;
mod frame;
mod session;
