//! Runs a fleet: every component when it is due, under a clock that is real or virtual.
//!
//! One engine holds the state: due times (a heap of absolute times), states of components, topics. One thread does the
//! timer's work: it sleeps until something is due, takes the component out of the engine, runs it on this thread
//! without holding the lock, and gives it back; its messages are delivered then. In real time a spare thread watches
//! it, and takes over its work when an execution holds up the others for longer than a budget; the slow component runs
//! on a thread of its own from then on. In virtual time the same engine runs on one thread alone, and time jumps from
//! one due execution to the next.
//!
//! The entry point is [`RunningFleet`]. A component sees only its [`Context`](saoms_api::Context).

mod change;
mod component;
mod drive;
mod engine;
mod fleet;
mod handle;
mod hold;
mod inject;
mod members;
mod metrics;
mod names;
mod networks;
mod order;
mod os;
mod settings;
mod shared;
mod stop;
#[cfg(test)]
mod tests;
mod topics;
mod why;

pub use change::{
    ChangeError, ChangeOptions, ChangeWithdrawal, Changed, HandedOver, PlannedChanges, PlannedDifference,
    PlannedMember, PlannedRefusal, PlannedReplacement, PlannedValue, SetError, StartError, Takeover,
};
pub use engine::memory::SharedText;
pub use fleet::RunningFleet;
pub use handle::{Handle, Hold, NotCommitted, OfferedService, Together};
pub use hold::{HoldError, Speed};
pub use inject::{InjectError, InjectedContent, Injection, is_from_outside};
pub use members::UnknownComponent;
pub use metrics::TimerSign;
pub use networks::{NetworkHooks, NetworkedFleet};
pub use order::{Order, OrderError, OrderTicket, OrderWithdrawal, TimedOrder};
pub use os::realtime::RealtimeError;
pub use os::thread::start_thread;
pub use settings::{ClockKind, Settings};
pub use stop::{hears_stops, stop_hardware};
pub use topics::speakers::ForeignSpeaker;
pub use topics::takers::{EventMessage, RaiseError, Takers};
