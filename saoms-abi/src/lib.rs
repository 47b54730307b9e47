//! The boundary between the program and a library that was built separately: plain C, so that either side can be built
//! with another compiler, another version of these crates, another allocator, or in another language.
//!
//! Tables of functions, structures and status codes alone: no type of another crate, no allocation, no standard
//! library. Authors in Rust do not use this crate: `saoms_api::plugin!` exports their classes, loops and rules, and the
//! program loads them. Authors in C use the header `include/saoms.h`, which is generated from this crate.
//!
//! # Rules
//! - Nothing is shared but the tables of functions in this crate and the bytes that are lent for the time of a call.
//!   Each side frees what it allocated; text and bytes that a callee gives back go through a [`Sink`] of the caller.
//! - No function unwinds: each catches panics inside it and answers [`Status::PANICKED`] with the message.
//! - A library is never unloaded, so texts that are part of it (of records, say) may be kept.
//! - A component, and all functions that it is lent, are used by one thread at a time. Contexts, knowledge and sinks
//!   are lent for the time of the call and for the thread of the call. They refuse any other use, and the component
//!   fails; the memory behind a pointer that was lent with them, such as the bytes of a message, may be gone.
//! - All text is UTF-8. Messages, arguments and replies are CDR.
//!
//! # Versions
//! [`VERSION`] changes when a table, a structure or a rule changes. Within one version tables only grow at their end,
//! and say their size. `docs/abi.txt` of the repository writes them down, and a test compares.

#![no_std]

mod bytes;
mod component;
mod entries;
mod error;
mod finding;
mod host;
mod implementation;
mod looping;
mod message;
mod plugin;
mod region;
mod rule;
mod status;
mod stop;
mod topics;
mod transport;
mod value;

pub use bytes::{Bytes, MAX_BYTES, Sink, list};
pub use component::{ClassTable, ComponentTable, Construct};
pub use entries::{EntriesFunctions, EntriesHandle, EntryView};
pub use error::ReadError;
pub use finding::{FindingSink, FindingView, LabelView, PlaceView};
pub use host::{HostFunctions, HostHandle, KeptVisitor, LoopVisitor, PublisherVisitor};
pub use implementation::ImplementationTable;
pub use looping::{LoopClassTable, LoopInstance, LoopTable, Step};
pub use message::{Inbox, MessageView, TopicView};
pub use plugin::{EntryPoint, PluginTable, SECTION};
pub use region::{DepartedView, RegionView};
pub use rule::{FleetList, MemberView, RenamedView, RuleTable, TextList, WireView};
pub use status::Status;
pub use stop::StopView;
pub use topics::{TopicTransportEntry, TopicTransportTable};
pub use transport::{TRANSPORT_SECTION, TRANSPORT_VERSION, TransportEntry, TransportEvents, TransportTable};
pub use value::{PropertyView, RecordView, ReportView, ValueView};

/// The version of the boundary. A program loads libraries of its own version alone.
pub const VERSION: u32 = 3;
