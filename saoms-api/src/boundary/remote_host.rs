use std::collections::BTreeMap;
use std::ffi::c_void;
use std::fmt::{self, Write as _};
use std::mem::MaybeUninit;
use std::time::Duration;

use saoms_abi::{
    Bytes, HostFunctions, HostHandle, LoopInstance, PropertyView, RecordView, RegionView, Sink, Status, TopicView,
};

use crate::host::Host;
use crate::host::contain::contained;
use crate::host::present;
use crate::host::{
    DynLoop, LoopRegistration, NamedLoops, Phase, PropertyValue, ServiceCall, SharedMessage, SmolStr, TopicDeclaration,
};
use crate::{
    CallError, Cause, Chance, Departed, Failure, KnownPublisher, Level, Record, Region, ReportValue, StopFunction,
    Time, Value, Work,
};

use super::buffer::{Buffer, sink};
use super::convert::{read_properties, topic_view, value_view, with_report_view};
use super::guard::{call_outcome, outcome};
use super::host::{LEVELS, time};
use super::looping::import_loop;
use super::stop;

/// The host on the other side of the boundary.
pub(super) struct RemoteHost<'a> {
    handle: &'a HostHandle,
    functions: &'a HostFunctions,
    /// For messages and lines that are put together before they cross.
    buffer: &'a mut Vec<u8>,
    /// The subscriptions that are made here.
    subscribed: &'a mut Vec<u32>,
    /// By the index of the subscription: messages that left its region.
    departed: &'a [Vec<Departed>],
}

/// The level of the classic console, behind those of the log.
const CONSOLE: u32 = LEVELS.len() as u32;

impl<'a> RemoteHost<'a> {
    /// # Safety
    /// The handle, its functions and its state belong to a call that lasts for as long as the link is used.
    pub(super) unsafe fn new(
        handle: &'a HostHandle,
        buffer: &'a mut Vec<u8>,
        subscribed: &'a mut Vec<u32>,
        departed: &'a [Vec<Departed>],
    ) -> RemoteHost<'a> {
        // SAFETY: as the caller promises.
        let functions = unsafe { &*handle.functions };
        RemoteHost { handle, functions, buffer, subscribed, departed }
    }

    /// Asks for a topic.
    fn topic(
        &self,
        topic: &TopicDeclaration<'_>,
        ask: unsafe extern "C" fn(*mut c_void, *const TopicView, *mut u32, Sink) -> Status,
    ) -> Result<u32, Failure> {
        let view = topic_view(topic);
        let (mut index, mut error) = (u32::MAX, Buffer::default());
        // SAFETY: the handle is that of an active call; everything is lent for this call.
        let status = unsafe { ask(self.handle.state, &raw const view, &raw mut index, sink(&mut error)) };
        outcome(status, &error.bytes).map(|()| index)
    }

    /// A loop of the host, or of another library.
    fn made_by_host(&self, place: u32) -> Result<Box<dyn DynLoop>, Failure> {
        let (mut given, mut error) = (MaybeUninit::<LoopInstance>::uninit(), Buffer::default());
        // SAFETY: the handle is that of an active call; when it answers that all is well, the host has given a
        // loop away.
        unsafe {
            let make = self.functions.chosen_loop;
            outcome(make(self.handle.state, place, given.as_mut_ptr(), sink(&mut error)), &error.bytes)?;
            let given = given.assume_init();
            import_loop(given.instance, *given.table, present::subject(""))
        }
    }

    fn write(&mut self, level: u32, line: fmt::Arguments<'_>) {
        // SAFETY: the handle is that of an active call.
        if unsafe { (self.functions.listens)(self.handle.state, level) } == 0 {
            return;
        }
        self.buffer.clear();
        let mut text = Text(self.buffer);
        // A `Vec` takes everything; only the formatting of the line itself can fail, and then its beginning is shown.
        let _ = text.write_fmt(line);
        // SAFETY: the handle is that of an active call; the line is lent to it.
        unsafe { (self.functions.log)(self.handle.state, level, Bytes::lend(self.buffer)) }
    }
}

/// Checks that the program has all functions that this library was built for. Asked before a component or a loop is
/// initialized.
///
/// # Errors
/// The program is older than the library.
///
/// # Safety
/// The handle is that of an active call.
pub(super) unsafe fn check_size(handle: &HostHandle) -> Result<(), Failure> {
    // SAFETY: as the caller promises; the table begins with its size.
    let size = unsafe { (*handle.functions).size };
    if size < size_of::<HostFunctions>() {
        return Err(Failure::new(
            "the program is older than the library: use a newer program, or build the library with an older saoms-api",
        ));
    }
    Ok(())
}

/// A loop that the composite chose for a component.
struct ChosenLoop {
    name: String,
    class: String,
    values: Vec<(SmolStr, PropertyValue)>,
}

/// Adds a loop to the list of [`RemoteHost::loops`].
unsafe extern "C" fn visit_loop(
    list: *mut c_void,
    name: Bytes,
    class: Bytes,
    values: *const PropertyView,
    count: usize,
) {
    // SAFETY: the host passes on the list of `loops`, and lends the rest.
    unsafe {
        let list = &mut *list.cast::<Vec<Result<ChosenLoop, Failure>>>();
        let read = || {
            let (name, class) = (name.get_text()?.to_owned(), class.get_text()?.to_owned());
            Ok(ChosenLoop { name, class, values: read_properties(values, count)? })
        };
        list.push(contained(read).and_then(|read| read));
    }
}

/// Adds bytes to the map of [`RemoteHost::kept`].
unsafe extern "C" fn visit_kept(kept: *mut c_void, key: u64, bytes: Bytes) {
    // SAFETY: the host passes on the map of `kept`, and lends the bytes until the call ends in which that is used.
    unsafe {
        if let Some(kept) = kept.cast::<BTreeMap<u64, &[u8]>>().as_mut() {
            kept.insert(key, bytes.get().unwrap_or_default());
        }
    }
}

/// Adds a component to the list of [`RemoteHost::publishers`].
unsafe extern "C" fn visit_publisher(list: *mut c_void, sender: u32, has_begun: u32, number: i64) {
    // SAFETY: the host passes on the list of `publishers`.
    let list = unsafe { &mut *list.cast::<Vec<KnownPublisher>>() };
    list.push(KnownPublisher { sender, has_begun: has_begun != 0, number: u32::try_from(number).ok() });
}

struct Text<'a>(&'a mut Vec<u8>);

impl fmt::Write for Text<'_> {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        self.0.extend_from_slice(text.as_bytes());
        Ok(())
    }
}

macro_rules! get {
    ($link:ident.$function:ident $(, $argument:expr)*) => {
        // SAFETY: the handle is that of an active call.
        unsafe { ($link.functions.$function)($link.handle.state $(, $argument)*) }
    };
}

impl Host for RemoteHost<'_> {
    fn name(&self) -> &str {
        let name = get!(self.name);
        // SAFETY: the host's name for the component lasts as long as the call that the handle is that of.
        unsafe { name.get_text() }.unwrap_or_default()
    }

    fn sender(&self) -> u32 {
        get!(self.sender)
    }

    fn name_of(&self, sender: u32) -> Option<&str> {
        let name = get!(self.name_of, sender);
        // SAFETY: the host's names for components last as long as the call that the handle is that of.
        (!name.data.is_null()).then(|| unsafe { name.get_text() }.unwrap_or_default())
    }

    fn now(&self) -> Time {
        time(get!(self.now))
    }

    fn date(&self) -> Option<Duration> {
        let nanos = get!(self.date);
        (nanos != u64::MAX).then(|| Duration::from_nanos(nanos))
    }

    fn due(&self) -> Time {
        time(get!(self.due))
    }

    fn execution(&self) -> u64 {
        get!(self.execution)
    }

    fn period(&self) -> Duration {
        Duration::from_nanos(get!(self.period))
    }

    fn cancelled(&self) -> bool {
        get!(self.cancelled) != 0
    }

    fn chance(&mut self) -> &mut Chance {
        let state = get!(self.chance);
        assert!(!state.is_null(), "the host provides no random numbers");
        // SAFETY: the host lends the state until the call ends, which is longer than `self` is borrowed; `Chance` is
        // that state.
        unsafe { &mut *state.cast::<Chance>() }
    }

    fn publish(&mut self, topic: &TopicDeclaration<'_>) -> Result<u32, Failure> {
        self.topic(topic, self.functions.publish)
    }

    fn subscribe(&mut self, topic: &TopicDeclaration<'_>) -> Result<u32, Failure> {
        let index = self.topic(topic, self.functions.subscribe)?;
        self.subscribed.push(index);
        Ok(index)
    }

    fn send(&mut self, publisher: u32, message: SharedMessage) -> Result<(), Failure> {
        message.encode_into(self.buffer);
        let key = message.key();
        let key = key.as_ref().map_or(std::ptr::null(), std::ptr::from_ref);
        let mut error = Buffer::default();
        outcome(get!(self.send, publisher, key, Bytes::lend(self.buffer), sink(&mut error)), &error.bytes)
    }

    fn reference(&mut self, name: &str, interface: &str) -> Result<u32, Failure> {
        let (mut index, mut error) = (u32::MAX, Buffer::default());
        let (name, interface) = (Bytes::text(name), Bytes::text(interface));
        let status = get!(self.reference, name, interface, &raw mut index, sink(&mut error));
        outcome(status, &error.bytes).map(|()| index)
    }

    fn set_region(&mut self, subscription: u32, region: Option<Region>) -> Result<(), Failure> {
        let view = region.map(|region| {
            let [least, most] = [region.least(), region.most()].map(|(x, y)| [x, y]);
            RegionView { least, most }
        });
        let view = view.as_ref().map_or(std::ptr::null(), std::ptr::from_ref);
        let mut error = Buffer::default();
        outcome(get!(self.set_region, subscription, view, sink(&mut error)), &error.bytes)
    }

    fn departed(&self, subscription: u32) -> &[Departed] {
        self.departed.get(subscription as usize).map_or(&[], Vec::as_slice)
    }

    fn publishers(&self, topic: &str) -> Vec<KnownPublisher> {
        let mut known: Vec<KnownPublisher> = Vec::new();
        get!(self.publishers, Bytes::text(topic), (&raw mut known).cast(), visit_publisher);
        known
    }

    fn speaker(&self, topic: &str, number: u32) -> Option<u32> {
        u32::try_from(get!(self.speaker, Bytes::text(topic), number)).ok()
    }

    fn keep(&mut self, key: u64, bytes: &[u8]) -> Result<(), Failure> {
        let mut error = Buffer::default();
        outcome(get!(self.keep, key, Bytes::lend(bytes), sink(&mut error)), &error.bytes)
    }

    fn kept(&self) -> BTreeMap<u64, &[u8]> {
        let mut kept: BTreeMap<u64, &[u8]> = BTreeMap::new();
        get!(self.kept, (&raw mut kept).cast(), visit_kept);
        kept
    }

    fn kept_by_earlier_program(&self) -> bool {
        let mut kept: BTreeMap<u64, &[u8]> = BTreeMap::new();
        get!(self.kept, (&raw mut kept).cast(), visit_kept) != 0
    }

    fn raise(&mut self, event: &str) -> Result<(), Failure> {
        let mut error = Buffer::default();
        outcome(get!(self.raise, Bytes::text(event), sink(&mut error)), &error.bytes)
    }

    fn goes_on(&self) -> bool {
        get!(self.goes_on) != 0
    }

    fn goes_on_from_earlier_program(&self) -> bool {
        get!(self.goes_on) == 2
    }

    fn register_stop(&mut self, stop: StopFunction) -> Result<(), Failure> {
        let (view, mut error) = (stop::export(stop), Buffer::default());
        let status = get!(self.register_stop, &raw const view, sink(&mut error));
        outcome(status, &error.bytes)
    }

    fn is_wired(&self, reference: u32) -> bool {
        get!(self.is_wired, reference) != 0
    }

    fn targets(&self, reference: u32) -> u32 {
        get!(self.targets, reference)
    }

    fn call(&mut self, reference: u32, call: &mut dyn ServiceCall) -> Result<(), CallError> {
        let arguments = call.arguments();
        let (mut reply, mut error) = (Buffer::default(), Buffer::default());
        let (into_reply, into_error) = (sink(&mut reply), sink(&mut error));
        let status = get!(self.call, reference, call.operation(), Bytes::lend(&arguments), into_reply, into_error);
        call_outcome(status, &error.bytes)?;
        call.reply(reply.get()?)
    }

    fn loops(&mut self) -> Result<NamedLoops, Failure> {
        let mut chosen: Vec<Result<ChosenLoop, Failure>> = Vec::new();
        // SAFETY: the handle is that of an active call; `visit_loop` gets the list that it expects.
        unsafe { (self.functions.chosen_loops)(self.handle.state, (&raw mut chosen).cast(), visit_loop) }
        (0..)
            .zip(chosen)
            .map(|(place, chosen)| {
                let ChosenLoop { name, class, values } = chosen?;
                // What is built into this library works on the structs of this library.
                let own = LoopRegistration::linked().find(|known| known.name() == class);
                let made = match own {
                    Some(own) => contained(|| own.construct(&values)).and_then(|made| made),
                    None => self.made_by_host(place),
                };
                Ok((name.clone(), made.map_err(|failure| Failure::new(format!("loop `{name}`: {failure}")))?))
            })
            .collect()
    }

    fn name_loop(&mut self, place: u32, name: &str) {
        get!(self.name_loop, place, Bytes::text(name));
    }

    fn enter_loop(&mut self, place: Option<u32>) {
        get!(self.enter_loop, place.unwrap_or(u32::MAX));
    }

    fn because(&mut self, cause: Cause) {
        get!(self.because, cause.0);
    }

    fn cause(&self) -> Cause {
        Cause(get!(self.cause))
    }

    fn journal(&mut self, phase: Phase, record: &Record) {
        let mut values = [value_view(&Value::Bool(false)); 6];
        let used = record.used();
        for (place, value) in values.iter_mut().zip(used) {
            *place = value_view(value);
        }
        let view = RecordView {
            id: Bytes::text(record.id()),
            text: Bytes::text(record.text()),
            names: Bytes::text(record.names()),
            values: values.as_ptr(),
            count: used.len(),
        };
        let phase = match phase {
            Phase::Symptom => 0,
            Phase::Decision => 1,
            Phase::Effect => 2,
        };
        get!(self.journal, phase, &raw const view);
    }

    fn changed(&mut self, entry: &'static str, before: Value, after: Value) {
        let (before, after) = (value_view(&before), value_view(&after));
        get!(self.changed, Bytes::text(entry), &raw const before, &raw const after);
    }

    fn listens(&self, level: Option<Level>) -> bool {
        let level = level.map_or(CONSOLE, |level| level as u32);
        get!(self.listens, level) != 0
    }

    fn log(&mut self, level: Level, line: fmt::Arguments<'_>) {
        self.write(level as u32, line);
    }

    fn alert(&mut self, kind: &str, subject: &str, line: Option<fmt::Arguments<'_>>) {
        let line = line.map(|line| line.to_string());
        // A null line means the end of the alert; the data of an empty text is not null.
        let line = line.as_deref().map_or(Bytes::NONE, Bytes::text);
        get!(self.alert, Bytes::text(kind), Bytes::text(subject), line);
    }

    fn console(&mut self, line: fmt::Arguments<'_>) {
        self.write(CONSOLE, line);
    }

    fn report(&mut self, path: &str, value: ReportValue) {
        with_report_view("", &value, &mut |view| get!(self.report, Bytes::text(path), &raw const *view));
    }

    fn count(&mut self, path: &str, more: i64) {
        get!(self.count, Bytes::text(path), more);
    }

    fn vote(&mut self, work: Work) {
        let work = match work {
            Work::Open => 0,
            Work::Done => 1,
            Work::GivenUp => 2,
        };
        get!(self.vote, work);
    }
}
