//! What transports share.
//!
//! [`transport!`] puts a [`Transport`] in Rust behind the boundary to the program, [`topic_transport!`] a
//! [`TopicTransport`]. [`tls`] has the files for TLS and [`connect`] the look at who listens somewhere, with the words
//! for what goes wrong. [`Session`] joins a network at a broker of others, which speaks a [`Language`]: [MQTT](mqtt),
//! [STOMP](stomp). Whatever is the same for all of them is done here: the threads, the room for messages, and that it
//! connects again.

mod boundary;
mod connect;
mod language;
mod link;
pub mod mqtt;
mod session;
mod settings;
pub mod stomp;
pub mod tls;
pub mod topics;
mod waiting;

pub use boundary::{Failure, Transport, close, judge, open, put, subscribe, unsubscribe};
pub use connect::{Greeting, connect};
pub use language::{Ended, Heard, Language, Message, fits};
pub use link::Link;
pub use saoms_abi::{Bytes, Status, TRANSPORT_VERSION, TopicTransportTable, TransportEvents, TransportTable};
pub use session::{Listener, Session};
pub use settings::Settings;
pub use topics::{Program, Topic, TopicTransport};
