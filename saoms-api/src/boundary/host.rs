//! The functions of a context that this side lends.

use std::ffi::c_void;
use std::time::Duration;

use saoms_abi::{
    Bytes, DepartedView, HostFunctions, KeptVisitor, LoopInstance, LoopVisitor, PublisherVisitor, RecordView,
    RegionView, ReportView, Sink, Status, StopView, TopicView, ValueView,
};

use crate::host::Host;
use crate::host::{Phase, SharedMessage, shown};
use crate::{Cause, Departed, Failure, Header, KnownPublisher, Level, Region, Time, Work};

use super::convert::{PropertyViews, read_record, read_report, read_topic, read_value};
use super::guard::{guarded, guarded_call, guarded_value};
use super::lease_cell::host;
use super::looping::export_loop;
use super::null::{self, given, place};
use super::service::BytesCall;
use super::stop;

/// The levels of [`HostFunctions::log`] in their order; behind them comes the console.
pub(super) const LEVELS: [Level; 4] = [Level::Error, Level::Warning, Level::Info, Level::Debug];

/// What answers of functions are for, where there is no place for one.
const INDEX: &str = "the place of the index";
const VALUE: &str = "a value of the entry";

/// Runs code with the host behind a state, for a function that cannot answer with a failure: then the answer is
/// `otherwise`.
///
/// # Safety
/// The state is that of a handle, however old.
unsafe fn with_host<T: Copy>(state: *mut c_void, otherwise: T, code: impl FnOnce(&mut dyn Host) -> T) -> T {
    // SAFETY: as the caller promises.
    guarded_value(otherwise, || unsafe { host(state) }.map_or(otherwise, |mut host| code(&mut *host)))
}

macro_rules! getters {
    ($($function:ident -> $type:ty, $otherwise:expr, |$host:ident| $value:expr;)*) => {
        $(unsafe extern "C" fn $function(state: *mut c_void) -> $type {
            // SAFETY: callers pass the state of their handle.
            unsafe { with_host(state, $otherwise, |$host| $value) }
        })*
    };
}

getters! {
    name -> Bytes, Bytes::NONE, |host| Bytes::text(host.name());
    sender -> u32, 0, |host| host.sender();
    now -> u64, 0, |host| host.now().as_nanos();
    date -> u64, u64::MAX, |host| host.date().map_or(u64::MAX, nanos);
    due -> u64, 0, |host| host.due().as_nanos();
    execution -> u64, 0, |host| host.execution();
    period -> u64, 0, |host| nanos(host.period());
    cancelled -> u32, 0, |host| u32::from(host.cancelled());
    chance -> *mut u64, std::ptr::null_mut(), |host| host.chance().state().cast();
    next_random -> u64, 0, |host| host.chance().next_u64();
    cause -> u64, 0, |host| host.cause().0;
}

fn nanos(duration: Duration) -> u64 {
    u64::try_from(duration.as_nanos()).unwrap_or(u64::MAX)
}

unsafe extern "C" fn publish(state: *mut c_void, view: *const TopicView, index: *mut u32, error: Sink) -> Status {
    // SAFETY: callers pass the state of their handle, and lend the rest to this call.
    unsafe {
        guarded(error, || {
            *place(index, INDEX)? = host(state)?.publish(&read_topic(view)?)?;
            Ok(())
        })
    }
}

unsafe extern "C" fn subscribe(state: *mut c_void, view: *const TopicView, index: *mut u32, error: Sink) -> Status {
    // SAFETY: as in `publish`.
    unsafe {
        guarded(error, || {
            *place(index, INDEX)? = host(state)?.subscribe(&read_topic(view)?)?;
            Ok(())
        })
    }
}

unsafe extern "C" fn send(state: *mut c_void, publisher: u32, key: *const u64, bytes: Bytes, error: Sink) -> Status {
    // SAFETY: callers pass the state of their handle, and lend the rest to this call.
    unsafe {
        guarded(error, || {
            let mut host = host(state)?;
            let header = Header { sender: host.sender(), sent: host.due(), cause: host.cause() };
            host.send(publisher, SharedMessage::from_bytes(header, key.as_ref().copied(), bytes.get()?.to_vec()))
        })
    }
}

unsafe extern "C" fn reference(
    state: *mut c_void,
    name: Bytes,
    interface: Bytes,
    index: *mut u32,
    error: Sink,
) -> Status {
    // SAFETY: callers pass the state of their handle, and lend the rest to this call.
    unsafe {
        guarded(error, || {
            *place(index, INDEX)? = host(state)?.reference(name.get_text()?, interface.get_text()?)?;
            Ok(())
        })
    }
}

unsafe extern "C" fn register_stop(state: *mut c_void, view: *const StopView, error: Sink) -> Status {
    // SAFETY: callers pass the state of their handle, and lend the view to this call.
    unsafe { guarded(error, || host(state)?.register_stop(stop::import(view)?)) }
}

unsafe extern "C" fn keep(state: *mut c_void, key: u64, bytes: Bytes, error: Sink) -> Status {
    // SAFETY: callers pass the state of their handle, and lend the rest to this call.
    unsafe { guarded(error, || host(state)?.keep(key, bytes.get()?)) }
}

unsafe extern "C" fn kept(state: *mut c_void, visitor: *mut c_void, visit: KeptVisitor) -> u32 {
    // SAFETY: callers pass the state of their handle, and their own function and state; the bytes stay as they are
    // until the call in which they are lent has ended.
    unsafe {
        with_host(state, 0, |host| {
            for (key, bytes) in host.kept() {
                visit(visitor, key, Bytes::lend(bytes));
            }
            u32::from(host.kept_by_earlier_program())
        })
    }
}

unsafe extern "C" fn set_region(
    state: *mut c_void,
    subscription: u32,
    region: *const RegionView,
    error: Sink,
) -> Status {
    // SAFETY: callers pass the state of their handle, and lend the region to this call, or null.
    unsafe {
        guarded(error, || {
            let region =
                region.as_ref().map(|RegionView { least, most }| Region::new(least[0]..=most[0], least[1]..=most[1]));
            host(state)?.set_region(subscription, region)
        })
    }
}

unsafe extern "C" fn departed(state: *mut c_void, subscription: u32, place: usize, view: *mut DepartedView) -> u32 {
    // SAFETY: callers pass the state of their handle, and a place for the answer, or null.
    unsafe {
        with_host(state, 0, |host| match (host.departed(subscription).get(place), view.as_mut()) {
            (Some(Departed { sender, key }), Some(view)) => {
                *view = DepartedView { key: *key, sender: *sender };
                1
            }
            _ => 0,
        })
    }
}

unsafe extern "C" fn publishers(state: *mut c_void, topic: Bytes, visitor: *mut c_void, visit: PublisherVisitor) {
    // SAFETY: callers pass the state of their handle, their own function and state, and lend the name to this call.
    unsafe {
        with_host(state, (), |host| {
            for KnownPublisher { sender, has_begun, number } in host.publishers(topic.get_text().unwrap_or_default()) {
                visit(visitor, sender, u32::from(has_begun), number.map_or(-1, i64::from));
            }
        });
    }
}

unsafe extern "C" fn speaker(state: *mut c_void, topic: Bytes, number: u32) -> i64 {
    // SAFETY: callers pass the state of their handle, and lend the name to this call.
    unsafe {
        with_host(state, -1, |host| host.speaker(topic.get_text().unwrap_or_default(), number).map_or(-1, i64::from))
    }
}

unsafe extern "C" fn raise(state: *mut c_void, event: Bytes, error: Sink) -> Status {
    // SAFETY: callers pass the state of their handle, and lend the text to this call.
    unsafe { guarded(error, || host(state)?.raise(event.get_text()?)) }
}

unsafe extern "C" fn goes_on(state: *mut c_void) -> u32 {
    // SAFETY: callers pass the state of their handle.
    unsafe { with_host(state, 0, |host| u32::from(host.goes_on()) + u32::from(host.goes_on_from_earlier_program())) }
}

unsafe extern "C" fn is_wired(state: *mut c_void, reference: u32) -> u32 {
    // SAFETY: callers pass the state of their handle.
    unsafe { with_host(state, 0, |host| u32::from(host.is_wired(reference))) }
}

unsafe extern "C" fn targets(state: *mut c_void, reference: u32) -> u32 {
    // SAFETY: callers pass the state of their handle.
    unsafe { with_host(state, 0, |host| host.targets(reference)) }
}

unsafe extern "C" fn name_of(state: *mut c_void, sender: u32) -> Bytes {
    // SAFETY: callers pass the state of their handle.
    unsafe { with_host(state, Bytes::NONE, |host| host.name_of(sender).map_or(Bytes::NONE, Bytes::text)) }
}

unsafe extern "C" fn chosen_loops(state: *mut c_void, visitor: *mut c_void, visit: LoopVisitor) {
    // SAFETY: callers pass the state of their handle, and their own function and state; the rest is lent to that.
    unsafe {
        with_host(state, (), |host| {
            host.chosen_loops(&mut |name, class, values| {
                let views = PropertyViews::of(values);
                visit(visitor, Bytes::text(name), Bytes::text(class), views.top.as_ptr(), views.top.len());
            });
        });
    }
}

unsafe extern "C" fn chosen_loop(state: *mut c_void, place: u32, given: *mut LoopInstance, error: Sink) -> Status {
    // SAFETY: callers pass the state of their handle, and a place for the loop.
    unsafe {
        guarded(error, || {
            let given = null::place(given, "the place of a loop")?;
            *given = export_loop(host(state)?.chosen_loop(place)?);
            Ok(())
        })
    }
}

unsafe extern "C" fn name_loop(state: *mut c_void, place: u32, name: Bytes) {
    // SAFETY: callers pass the state of their handle, and lend the name.
    unsafe { with_host(state, (), |host| host.name_loop(place, name.get_text().unwrap_or_default())) }
}

unsafe extern "C" fn call(
    state: *mut c_void,
    reference: u32,
    operation: u32,
    arguments: Bytes,
    reply: Sink,
    error: Sink,
) -> Status {
    // SAFETY: callers pass the state of their handle, and lend the rest to this call.
    unsafe {
        guarded_call(error, || {
            let mut call = BytesCall::new(operation, arguments.get()?, reply);
            host(state)?.call(reference, &mut call)
        })
    }
}

unsafe extern "C" fn listens(state: *mut c_void, level: u32) -> u32 {
    // SAFETY: callers pass the state of their handle.
    unsafe { with_host(state, 0, |host| u32::from(host.listens(LEVELS.get(level as usize).copied()))) }
}

/// A line that cannot be read is left out with a warning.
unsafe extern "C" fn log(state: *mut c_void, level: u32, line: Bytes) {
    // SAFETY: callers pass the state of their handle, and lend the line to this call.
    unsafe {
        with_host(state, (), |host| {
            let line = match line.get() {
                Ok(line) => shown(line),
                Err(error) => return warn(host, "a line of the log", &error.into()),
            };
            match LEVELS.get(level as usize) {
                Some(level) => host.log(*level, format_args!("{line}")),
                None => host.console(format_args!("{line}")),
            }
        });
    }
}

/// An alert whose kind or subject is no text is left out with a warning.
unsafe extern "C" fn alert(state: *mut c_void, kind: Bytes, subject: Bytes, line: Bytes) {
    // SAFETY: callers pass the state of their handle, and lend the texts to this call.
    unsafe {
        with_host(state, (), |host| {
            let read = || Ok::<_, Failure>((kind.get_text()?, subject.get_text()?, line.get()?));
            match read() {
                Ok((kind, subject, _)) if line.data.is_null() => host.alert(kind, subject, None),
                Ok((kind, subject, line)) => host.alert(kind, subject, Some(format_args!("{}", shown(line)))),
                Err(failure) => warn(host, "an alert", &failure),
            }
        });
    }
}

/// A value for the report that cannot be read, or a path that is no text, is left out with a warning.
unsafe extern "C" fn report(state: *mut c_void, path: Bytes, value: *const ReportView) {
    // SAFETY: callers pass the state of their handle, and lend the rest to this call.
    unsafe {
        with_host(state, (), |host| {
            let read = path
                .get_text()
                .map_err(Failure::from)
                .and_then(|path| Ok((path, read_report(given(value, "the value")?)?)));
            match read {
                Ok((path, value)) => host.report(path, value),
                Err(failure) => warn(host, "a value for the report", &failure),
            }
        });
    }
}

/// A path that is no text is left out with a warning.
unsafe extern "C" fn count(state: *mut c_void, path: Bytes, more: i64) {
    // SAFETY: callers pass the state of their handle, and lend the path to this call.
    unsafe {
        with_host(state, (), |host| match path.get_text() {
            Ok(path) => host.count(path, more),
            Err(error) => warn(host, "a count for the report", &error.into()),
        });
    }
}

unsafe extern "C" fn vote(state: *mut c_void, work: u32) {
    let work = match work {
        0 => Work::Open,
        2 => Work::GivenUp,
        _ => Work::Done,
    };
    // SAFETY: callers pass the state of their handle.
    unsafe { with_host(state, (), |host| host.vote(work)) }
}

unsafe extern "C" fn enter_loop(state: *mut c_void, place: u32) {
    // SAFETY: callers pass the state of their handle.
    unsafe { with_host(state, (), |host| host.enter_loop((place != u32::MAX).then_some(place))) }
}

unsafe extern "C" fn because(state: *mut c_void, cause: u64) {
    // SAFETY: callers pass the state of their handle.
    unsafe { with_host(state, (), |host| host.because(Cause(cause))) }
}

/// A record that cannot be read is left out with a warning.
unsafe extern "C" fn journal(state: *mut c_void, phase: u32, view: *const RecordView) {
    // SAFETY: callers pass the state of their handle, and lend the view; its texts are part of their library, which
    // stays.
    unsafe {
        with_host(state, (), |host| {
            let phase = [Phase::Symptom, Phase::Decision, Phase::Effect].get(phase as usize).copied();
            let phase = phase.ok_or_else(|| Failure::new("its phase is unknown"));
            match phase.and_then(|phase| Ok((phase, read_record(given(view, "the record")?)?))) {
                Ok((phase, record)) => host.journal(phase, &record),
                Err(failure) => warn(host, "a record", &failure),
            }
        });
    }
}

/// A change that cannot be read is left out with a warning.
unsafe extern "C" fn changed(state: *mut c_void, entry: Bytes, before: *const ValueView, after: *const ValueView) {
    // SAFETY: callers pass the state of their handle, and lend the views; texts are part of their library, which stays.
    unsafe {
        with_host(state, (), |host| {
            let read =
                || Ok((entry.get_text()?, read_value(*given(before, VALUE)?)?, read_value(*given(after, VALUE)?)?));
            match read() {
                Ok((entry, before, after)) => host.changed(entry, before, after),
                Err(failure) => warn(host, "a changed entry", &failure),
            }
        });
    }
}

fn warn(host: &mut dyn Host, what: &str, failure: &Failure) {
    host.log(Level::Warning, format_args!("{what} was left out: {failure}"));
}

/// The functions of this program.
pub(super) static HOST_FUNCTIONS: HostFunctions = HostFunctions {
    size: size_of::<HostFunctions>(),
    name,
    sender,
    name_of,
    now,
    date,
    due,
    execution,
    period,
    cancelled,
    chance,
    next_random,
    publish,
    subscribe,
    send,
    reference,
    is_wired,
    targets,
    call,
    listens,
    log,
    report,
    count,
    vote,
    chosen_loops,
    chosen_loop,
    name_loop,
    enter_loop,
    because,
    cause,
    journal,
    changed,
    register_stop,
    keep,
    kept,
    set_region,
    departed,
    goes_on,
    raise,
    alert,
    publishers,
    speaker,
};

/// A time of the other side.
pub(super) const fn time(nanos: u64) -> Time {
    Time::from_nanos(nanos)
}
