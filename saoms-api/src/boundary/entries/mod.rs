//! Entries across the boundary: the functions of those on this side, and those on the other side behind theirs.

mod functions;
mod knowledge;
mod remote;

pub(super) use functions::{KNOWLEDGE, export_entries};
pub(super) use knowledge::RemoteKnowledge;
pub(super) use remote::{OwnedRemoteEntries, RemoteEntries};
