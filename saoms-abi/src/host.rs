use core::ffi::c_void;

use crate::{
    Bytes, DepartedView, Inbox, LoopInstance, PropertyView, RecordView, RegionView, ReportView, Sink, Status, StopView,
    TopicView, ValueView,
};

/// The context that a component is lent for the time of a call: its functions, and the messages that arrived.
#[repr(C)]
#[derive(Debug)]
pub struct HostHandle {
    /// The first argument of each function.
    pub state: *mut c_void,
    /// The functions.
    pub functions: *const HostFunctions,
    /// One for each subscription, in the order of subscribing; none at all when nothing arrived.
    pub inboxes: *const Inbox,
    /// Their number.
    pub inbox_count: usize,
}

/// The functions of a component's context. The first argument of each is the `state` of the handle that the present
/// call was lent.
///
/// Times are nanoseconds of the run, which starts at 0.
#[repr(C)]
#[derive(Debug)]
pub struct HostFunctions {
    /// The size of this table in bytes.
    pub size: usize,
    /// The component's name: its path in the composite.
    pub name: unsafe extern "C" fn(state: *mut c_void) -> Bytes,
    /// The component's index in the running fleet, as in the messages that it sends.
    pub sender: unsafe extern "C" fn(state: *mut c_void) -> u32,
    /// The name of the component with this index; null where there is none.
    pub name_of: unsafe extern "C" fn(state: *mut c_void, sender: u32) -> Bytes,
    /// The present time. In virtual time it stands still during an execution.
    pub now: unsafe extern "C" fn(state: *mut c_void) -> u64,
    /// The present date and time of day, in nanoseconds since 1970-01-01 00:00 of local time; `UINT64_MAX`: there is
    /// none, in virtual time.
    pub date: unsafe extern "C" fn(state: *mut c_void) -> u64,
    /// The time when the present execution was due.
    pub due: unsafe extern "C" fn(state: *mut c_void) -> u64,
    /// The number of the present execution, from 0.
    pub execution: unsafe extern "C" fn(state: *mut c_void) -> u64,
    /// The component's period in nanoseconds, 0 for a passive one.
    pub period: unsafe extern "C" fn(state: *mut c_void) -> u64,
    /// 1 if a long execution should end early: the component was unscheduled, or the run ends.
    pub cancelled: unsafe extern "C" fn(state: *mut c_void) -> u32,
    /// The state of the component's xoshiro256++, four numbers, which may be advanced in place until the call ends.
    pub chance: unsafe extern "C" fn(state: *mut c_void) -> *mut u64,
    /// The next random number of the component's own source: the same seed gives the same ones.
    pub next_random: unsafe extern "C" fn(state: *mut c_void) -> u64,
    /// Becomes a publisher of a topic that the class declares, in `initialize` alone; gives the index to send with.
    pub publish:
        unsafe extern "C" fn(state: *mut c_void, topic: *const TopicView, publisher: *mut u32, error: Sink) -> Status,
    /// Becomes a subscriber of a topic that the class declares, in `initialize` alone; gives the place of its inbox.
    pub subscribe: unsafe extern "C" fn(
        state: *mut c_void,
        topic: *const TopicView,
        subscription: *mut u32,
        error: Sink,
    ) -> Status,
    /// Sends a message in its CDR form; it leaves at the end of the present execution. The key is that of the
    /// message, as a number, or null.
    pub send: unsafe extern "C" fn(
        state: *mut c_void,
        publisher: u32,
        key: *const u64,
        message: Bytes,
        error: Sink,
    ) -> Status,
    /// Gives the index of a reference that the class declares, by its name and the name of its interface, in
    /// `initialize` alone.
    pub reference: unsafe extern "C" fn(
        state: *mut c_void,
        name: Bytes,
        interface: Bytes,
        reference: *mut u32,
        error: Sink,
    ) -> Status,
    /// 1 if the reference leads to a component.
    pub is_wired: unsafe extern "C" fn(state: *mut c_void, reference: u32) -> u32,
    /// The number of targets of a reference; the number of one, from 0, goes into the upper 16 bits of the reference's
    /// index.
    pub targets: unsafe extern "C" fn(state: *mut c_void, reference: u32) -> u32,
    /// Calls an operation, by its number, through a reference: arguments and reply in their CDR form.
    pub call: unsafe extern "C" fn(
        state: *mut c_void,
        reference: u32,
        operation: u32,
        arguments: Bytes,
        reply: Sink,
        error: Sink,
    ) -> Status,
    /// 1 if somebody reads the log at a level: 0 errors, 1 warnings, 2 information, 3 for debugging, 4 the classic
    /// console.
    pub listens: unsafe extern "C" fn(state: *mut c_void, level: u32) -> u32,
    /// Writes a line at such a level.
    pub log: unsafe extern "C" fn(state: *mut c_void, level: u32, line: Bytes),
    /// Sets a value of the run's report, such as `map.blocks`; dots lead into nested objects. The last value counts.
    pub report: unsafe extern "C" fn(state: *mut c_void, path: Bytes, value: *const ReportView),
    /// Adds to a number of the run's report, such as `luggage.delivered`, which several components may share.
    pub count: unsafe extern "C" fn(state: *mut c_void, path: Bytes, more: i64),
    /// Says that this component has work left (0), or that its work is done (1). The run ends by itself when at least
    /// one component voted and the work of all that voted is done. 2 says that some work was given up, so that the run
    /// is incomplete, and nothing about what is left; a program that does not know it takes it for 1, until the
    /// component says 0 or 1.
    pub vote: unsafe extern "C" fn(state: *mut c_void, work: u32),
    /// Shows each of the component's loops to `visit`, which gets `visitor` as its first argument.
    pub chosen_loops: unsafe extern "C" fn(state: *mut c_void, visitor: *mut c_void, visit: LoopVisitor),
    /// Makes the loop at this place of `chosen_loops`, of whatever library it is, and gives it away.
    pub chosen_loop:
        unsafe extern "C" fn(state: *mut c_void, place: u32, given: *mut LoopInstance, error: Sink) -> Status,
    /// Names the loop at this place.
    pub name_loop: unsafe extern "C" fn(state: *mut c_void, place: u32, name: Bytes),
    /// Says that the loop at this place acts from now on; `UINT32_MAX`: none.
    pub enter_loop: unsafe extern "C" fn(state: *mut c_void, place: u32),
    /// Says that records and messages from here on follow from a record of the journal, such as the cause of a message.
    pub because: unsafe extern "C" fn(state: *mut c_void, cause: u64),
    /// The cause that a message carries which is sent now.
    pub cause: unsafe extern "C" fn(state: *mut c_void) -> u64,
    /// Writes a record to the journal: of phase 0 a symptom, 1 a decision, 2 an effect.
    pub journal: unsafe extern "C" fn(state: *mut c_void, phase: u32, record: *const RecordView),
    /// Writes to the journal that the present loop changed an entry; its name has to be part of the library.
    pub changed:
        unsafe extern "C" fn(state: *mut c_void, entry: Bytes, before: *const ValueView, after: *const ValueView),
    /// Registers a function that stops the component's hardware from any thread, in `initialize` alone; the declaration
    /// of the class says `"stops": true`. The host frees its state with `release`, also when it refuses the function.
    pub register_stop: unsafe extern "C" fn(state: *mut c_void, stop: *const StopView, error: Sink) -> Status,
    /// Keeps these bytes under a number beyond a crash of the component; no bytes remove them. What this and later
    /// executions send goes out once they are committed; they are lost if this execution fails.
    pub keep: unsafe extern "C" fn(state: *mut c_void, key: u64, bytes: Bytes, error: Sink) -> Status,
    /// Passes all that is kept to `visit`, in the order of the numbers; the bytes are lent until the call of the
    /// component ends. Not 0 if an earlier program left it, and the component has kept nothing since.
    pub kept: unsafe extern "C" fn(state: *mut c_void, visitor: *mut c_void, visit: KeptVisitor) -> u32,
    /// Lets a subscription receive the messages of a region alone; with null it receives all. The schema of the topic
    /// has a `place`.
    pub set_region:
        unsafe extern "C" fn(state: *mut c_void, subscription: u32, region: *const RegionView, error: Sink) -> Status,
    /// The message at this place of those that left the region of a subscription since the execution before: 1 if there
    /// is one, else 0.
    pub departed:
        unsafe extern "C" fn(state: *mut c_void, subscription: u32, place: usize, departed: *mut DepartedView) -> u32,
    /// In `initialize` not 0 if the component takes the place of another one and goes on from what that saved:
    /// `restore` comes next, and nothing is to be begun or announced anew.
    pub goes_on: unsafe extern "C" fn(state: *mut c_void) -> u32,
    /// Lets an event happen that components of the same site take, at the end of the present execution: a line such as
    /// `fire at=(3,4) size=2 to Hall1`.
    pub raise: unsafe extern "C" fn(state: *mut c_void, event: Bytes, error: Sink) -> Status,
    /// Says that a person is needed: a kind such as `assistance`, what it is about, such as a number, or empty, and a
    /// line for that person. A null line says that the alert of this kind and subject is over.
    pub alert: unsafe extern "C" fn(state: *mut c_void, kind: Bytes, subject: Bytes, line: Bytes),
    /// Shows each other component of the fleet that may publish on a topic, as it is declared, to `visit`, which gets
    /// `visitor` as its first argument. The name of the topic is that in the declarations.
    pub publishers:
        unsafe extern "C" fn(state: *mut c_void, topic: Bytes, visitor: *mut c_void, visit: PublisherVisitor),
    /// The index in the running fleet of the component that says by a number who speaks in messages of a topic; -1 if
    /// there is none. The name of the topic is that in the declarations.
    pub speaker: unsafe extern "C" fn(state: *mut c_void, topic: Bytes, number: u32) -> i64,
}

/// The visitor of what a component keeps, called with a number and the bytes under it.
pub type KeptVisitor = unsafe extern "C" fn(visitor: *mut c_void, key: u64, bytes: Bytes);

/// The visitor of the publishers of a topic, called with the index of a component in the running fleet, and with 1 if
/// that component was ever scheduled, else 0, and with the number by which it says who speaks in messages, or -1.
pub type PublisherVisitor = unsafe extern "C" fn(visitor: *mut c_void, sender: u32, has_begun: u32, number: i64);

/// The visitor of a component's loops, called with a name, a class, values and their number.
pub type LoopVisitor = unsafe extern "C" fn(
    visitor: *mut c_void,
    name: Bytes,
    class_name: Bytes,
    values: *const PropertyView,
    value_count: usize,
);
