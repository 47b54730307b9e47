//! Transports: libraries that carry bytes between programs, behind a boundary of C ([`saoms_abi::TransportTable`]).

mod error;
mod library;
mod session;

pub use error::TransportError;
pub use library::{Transport, TransportInfo, peers, scheme};
pub use session::{
    Account, Delivered, Opened, Receiver, SessionSettings, SettingFault, TlsFiles, TransportSession, UserKeys,
};
