//! Transports: libraries that carry bytes between programs, behind a boundary of C ([`saoms_abi::TransportTable`]).

mod error;
mod library;
mod session;
mod topics;

pub use error::TransportError;
pub use library::{Carrier, TopicTransport, Transport, TransportInfo, peers, scheme};
pub use session::{
    Account, Delivered, Opened, Receiver, SessionSettings, SettingFault, TlsFiles, TransportSession, UserKeys,
};
pub use topics::{TopicForm, TopicSession};
