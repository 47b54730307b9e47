//! The transport over Zenoh.
//!
//! A url `host:port` or `tcp/host:port` is TCP, `tls/host:port` is TLS. The program that listens is a router; the
//! others are its clients. A url `peers://NAME=host:port,NAME=host:port`, or `peers+tls://`, names all programs: each
//! listens at its own address, and the later ones connect to those before them. No multicast, no gossip: nothing is
//! heard that the url does not name.

mod causes;
mod certificates;
mod probe;
mod session;
mod settings;

use self::session::Session;

saoms_transport::transport!(Session, saoms_transport_zenoh, schemes: r#"["","tcp","tls","peers","peers+tls"]"#);
