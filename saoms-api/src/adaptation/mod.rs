//! MAPE-K: components that adapt themselves by loops over their knowledge.
//!
//! A component's [`Knowledge`] consists of declared, typed entries. Its behaviour is an ordered list of [loops](Loop),
//! which a composite can extend, reorder, replace and parametrise. In each execution all loops *monitor* first, in
//! their order; then each of them *analyzes* and, where it finds a symptom, *plans* and *executes*. Symptom, decision
//! and effect go to the journal as [`Record`]s.

mod class;
mod cycle;
mod entries;
mod entry;
mod extras;
mod knowledge;
mod lasting;
mod loops;
mod record;
mod simple;
mod snapshot;
mod text;

pub use class::{LoopClass, LoopRegistration, fits, member};
pub use cycle::{DynLoop, Loop};
pub use entries::{DynEntries, Entries, EntryDeclaration};
pub use entries::{are_unique, decode_field, joined, no_entry, set_field};
pub(crate) use entry::Change;
pub use entry::{Effector, Entry};
pub use extras::Extras;
pub(crate) use extras::Writable;
pub use knowledge::{Knowledge, KnowledgeClass, Subject};
pub use lasting::SavedLoops;
pub use loops::{Loops, NamedLoops};
pub use record::{Cause, Phase, Record, Recordable, Value};
pub use simple::{Adaptation, Decided, SimpleLoop};
pub use snapshot::Snapshot;
pub use text::ShortText;
pub(crate) use text::kept;
