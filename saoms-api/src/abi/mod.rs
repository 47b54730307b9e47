//! The boundary between the program and a library that was built separately: plain C, so that either side can be built with another
//! compiler, another version of this crate, another allocator, or in another language.
//!
//! Authors do not use this module: [`plugin!`](crate::plugin) exports what they wrote, and the program loads it. Authors in C use the header
//! `saoms.h`, which says the same.
//!
//! # Rules
//! - Nothing is shared but the tables of functions in this module and the bytes that are lent for the time of a call. Each side frees what it
//!   allocated; text and bytes that a callee gives back go through a [`Sink`] of the caller.
//! - No function unwinds: each catches what panics inside it and answers [`Status::PANICKED`] with the message.
//! - A library is never unloaded, so texts that are part of it (of records, say) may be kept.
//! - A component, and all functions that it is lent, are used by one thread at a time. What is lent, contexts, knowledge and sinks, is for
//!   the time of the call and for the thread of the call. Functions of contexts and knowledge and sinks refuse any other use, and the component fails;
//!   what a pointer leads to beyond that, such as the bytes of a message, may be gone.
//! - All text is UTF-8. Messages, arguments and replies are [`cdr`](crate::cdr).
//!
//! # Versions
//! [`VERSION`] changes when a table, a structure or a rule changes. Within one version tables only grow at their end, and say their size. `docs/abi.txt` of the repository writes them down, and a test compares.

mod class;
mod component;
mod context;
mod data;
mod entries;
mod finding;
mod guard;
mod host;
mod import;
mod lease;
mod link;
mod looping;
mod metadata;
mod report;
mod rule;
mod service;

pub use class::{ClassTable, Construct, PluginTable};
pub use component::{ComponentTable, Instance};
pub use context::{HostFunctions, HostHandle, LoopVisitor, TopicView};
pub use data::{Bytes, Inbox, MAX_BYTES, MessageView, PropertyView, RecordView, Sink, Status, ValueView};
pub use entries::{EntriesFunctions, EntriesHandle, EntryView};
pub use finding::{FindingSink, FindingView, LabelView, PlaceView};
pub use import::{ImportedClass, ImportedComponent};
pub use looping::{ImportedLoopClass, LoopClassTable, LoopInstance, LoopTable, Step};
pub use metadata::{Entry, SECTION};
pub use report::ReportView;
pub use rule::{FleetList, ImportedRule, MemberView, RuleTable, TextList, WireView};

/// The version of the boundary. A program loads libraries of its own version alone.
pub const VERSION: u32 = 1;

/// The version of this crate.
#[doc(hidden)]
pub const API: &str = env!("CARGO_PKG_VERSION");
