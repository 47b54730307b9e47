//! The module `_saoms`: the functions of a component's context, for Python.

use std::cell::{Cell, RefCell};
use std::collections::HashSet;
use std::ffi::{CString, c_void};
use std::ptr;
use std::sync::{LazyLock, Mutex, PoisonError};

use saoms_abi::{
    Bytes, HostFunctions, HostHandle, Inbox, MessageView, RecordView, ReportView, Sink, Status, TopicView, ValueView,
};

use crate::interpreter::inside;
use crate::object::{Object, Python};
use crate::symbols::{Function, Method, Raw};

thread_local! {
    /// The context that the present call lends this thread.
    static HOST: Cell<*const HostHandle> = const { Cell::new(ptr::null()) };
    /// What the component of the present call said of itself.
    static STATUS: RefCell<Option<String>> = const { RefCell::new(None) };
}

/// A context that is lent until this is dropped; calls may be nested.
pub(crate) struct Lent(*const HostHandle);

/// Lends a context to this thread.
///
/// # Safety
/// It is there until the result is dropped.
pub(crate) unsafe fn lent(host: *const HostHandle) -> Lent {
    Lent(HOST.replace(host))
}

impl Drop for Lent {
    fn drop(&mut self) {
        HOST.set(self.0);
    }
}

/// What the component said of itself since the last time.
pub(crate) fn take_status() -> Option<String> {
    STATUS.take()
}

/// The arguments of a call from Python.
struct Call<'a> {
    python: Python<'a>,
    arguments: Raw,
    host: Option<&'a HostHandle>,
}

impl Call<'_> {
    fn argument(&self, place: isize) -> Result<Raw, String> {
        // SAFETY: the lock is held; the item is borrowed from the tuple, which the caller has.
        let found = unsafe { (self.python.symbols.PyTuple_GetItem)(self.arguments, place) };
        if found.is_null() { Err(self.python.error()) } else { Ok(found) }
    }

    fn text(&self, place: isize) -> Result<String, String> {
        self.python.read_text(self.argument(place)?)
    }

    fn bytes(&self, place: isize) -> Result<Vec<u8>, String> {
        self.python.read_bytes(self.argument(place)?)
    }

    fn number(&self, place: isize) -> Result<u64, String> {
        // SAFETY: the lock is held.
        unsafe {
            let number = (self.python.symbols.PyLong_AsUnsignedLongLong)(self.argument(place)?);
            if (self.python.symbols.PyErr_Occurred)().is_null() { Ok(number) } else { Err(self.python.error()) }
        }
    }

    fn index(&self, place: isize) -> Result<u32, String> {
        self.number(place)?.try_into().map_err(|_| "found a number beyond 32 bits".to_owned())
    }

    /// The functions of the context, and their first argument.
    fn host(&self) -> Result<(&HostFunctions, *mut c_void), String> {
        let host = self.host.ok_or(
            "the context is lent to a component for the time of a call, on the thread of the call: it is used outside of that",
        )?;
        // SAFETY: the functions are there as long as the handle.
        Ok((unsafe { &*host.functions }, host.state))
    }

    /// Calls a function that may fail.
    fn checked(&self, call: impl FnOnce(Sink) -> Status) -> Result<(), String> {
        let mut text = Vec::new();
        match call(sink(&mut text)) {
            Status::OK => Ok(()),
            _ => Err(String::from_utf8_lossy(&text).into_owned()),
        }
    }

    /// Which class of values an object is of, by the name of its type.
    fn kind(&self, object: Raw) -> Result<String, String> {
        let class = self.python.attribute(object, "__class__")?;
        let name = self.python.attribute(class.0, "__name__");
        self.python.free(class);
        let name = name?;
        let text = self.python.read_text(name.0);
        self.python.free(name);
        text
    }

    fn float(&self, object: Raw) -> Result<f64, String> {
        // SAFETY: the lock is held.
        unsafe {
            let number = (self.python.symbols.PyFloat_AsDouble)(object);
            if (self.python.symbols.PyErr_Occurred)().is_null() { Ok(number) } else { Err(self.python.error()) }
        }
    }

    fn integer(&self, object: Raw) -> Result<i64, String> {
        // SAFETY: the lock is held.
        unsafe {
            let number = (self.python.symbols.PyLong_AsLongLong)(object);
            if (self.python.symbols.PyErr_Occurred)().is_null() { Ok(number) } else { Err(self.python.error()) }
        }
    }

    fn is_true(&self, object: Raw) -> bool {
        // SAFETY: the lock is held.
        unsafe { (self.python.symbols.PyObject_IsTrue)(object) == 1 }
    }

    fn items(&self, tuple: Raw) -> Vec<Raw> {
        // SAFETY: the lock is held; items are borrowed from the tuple, which the caller has.
        unsafe {
            let count = (self.python.symbols.PyTuple_Size)(tuple);
            (0..count).map(|place| (self.python.symbols.PyTuple_GetItem)(tuple, place)).collect()
        }
    }
}

/// A sink that appends to bytes, for the time of a call.
fn sink(bytes: &mut Vec<u8>) -> Sink {
    unsafe extern "C" fn put(state: *mut c_void, bytes: Bytes) {
        // SAFETY: the state is the bytes of whoever waits for the call; those that are put are lent.
        unsafe {
            if let Ok(bytes) = bytes.get() {
                (*state.cast::<Vec<u8>>()).extend_from_slice(bytes);
            }
        }
    }
    Sink { state: ptr::from_mut(bytes).cast(), put }
}

/// The most texts of records: they stay in memory.
const MOST_TEXTS: usize = 10_000;

/// A text that stays as long as the program runs. Equal ones are kept once.
fn kept(text: String) -> Result<&'static str, String> {
    static KEPT: LazyLock<Mutex<HashSet<&'static str>>> = LazyLock::new(Mutex::default);
    let mut all = KEPT.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(known) = all.get(text.as_str()) {
        return Ok(known);
    }
    if all.len() >= MOST_TEXTS {
        return Err(format!(
            "more than {MOST_TEXTS} different texts of journal records: write `{{name}}` where a value goes, and no \
            f-string"
        ));
    }
    let text: &'static str = text.leak();
    all.insert(text);
    Ok(text)
}

/// The messages of a subscription.
fn inbox(call: &Call<'_>) -> Result<Object, String> {
    call.host()?;
    let place = call.index(0)? as usize;
    let Some(host) = call.host.filter(|host| place < host.inbox_count) else {
        return Ok(call.python.list([]));
    };
    // SAFETY: so many inboxes are lent with the context, each with so many messages.
    let messages: &[MessageView] = unsafe {
        let Inbox { messages, count } = *host.inboxes.add(place);
        if count == 0 { &[] } else { std::slice::from_raw_parts(messages, count) }
    };
    let mut all = Vec::with_capacity(messages.len());
    for message in messages {
        // SAFETY: the bytes are lent with the context.
        let bytes = unsafe { message.bytes.get() }.map_err(|error| error.to_string())?;
        let python = &call.python;
        let (sent, sender) = (python.number(message.sent), python.number(u64::from(message.sender)));
        all.push(python.tuple([python.bytes(bytes), sent, sender, python.number(message.cause)]));
    }
    Ok(call.python.list(all))
}

fn topic(
    call: &Call<'_>,
    ask: impl FnOnce(&HostFunctions, *mut c_void, *const TopicView, *mut u32, Sink) -> Status,
) -> Result<Object, String> {
    let (functions, state) = call.host()?;
    let (name, message, schema) = (call.text(0)?, call.text(1)?, call.text(2)?);
    let (name, message, schema) = (Bytes::text(&name), Bytes::text(&message), Bytes::text(&schema));
    let view = TopicView { name, message, schema, kind: call.index(3)? };
    let mut index = 0;
    call.checked(|error| ask(functions, state, &raw const view, &raw mut index, error))?;
    Ok(call.python.number(u64::from(index)))
}

/// Calls an operation of a reference, without the lock: the provider may be in Python, too, or take its time.
fn called(call: &Call<'_>) -> Result<Object, String> {
    let (functions, state) = call.host()?;
    let (reference, operation, arguments) = (call.index(0)?, call.index(1)?, call.bytes(2)?);
    let (mut reply, mut text) = (Vec::new(), Vec::new());
    let symbols = call.python.symbols;
    // SAFETY: this thread has the lock, gives it away, and takes it again; the rest is lent to the call.
    let status = unsafe {
        let thread = (symbols.PyEval_SaveThread)();
        let status =
            (functions.call)(state, reference, operation, Bytes::lend(&arguments), sink(&mut reply), sink(&mut text));
        (symbols.PyEval_RestoreThread)(thread);
        status
    };
    let python = &call.python;
    let text = String::from_utf8_lossy(&text);
    Ok(python.tuple([python.number(u64::from(status.0)), python.bytes(&reply), python.text(&text)]))
}

fn journal(call: &Call<'_>) -> Result<Object, String> {
    let (functions, state) = call.host()?;
    let (phase, id, text, names) = (call.index(0)?, kept(call.text(1)?)?, kept(call.text(2)?)?, kept(call.text(3)?)?);
    let mut words = Vec::new();
    let given = call.items(call.argument(4)?);
    if given.len() > 6 {
        return Err(format!("a record has {} values, expected at most 6", given.len()));
    }
    for object in given {
        words.push(value(call, object)?);
    }
    let values: Vec<ValueView> = words
        .iter()
        .map(|(kind, bits, word)| ValueView { kind: *kind, bits: *bits, word: Bytes::text(word) })
        .collect();
    let record = RecordView {
        id: Bytes::text(id),
        text: Bytes::text(text),
        names: Bytes::text(names),
        values: values.as_ptr(),
        count: values.len(),
    };
    // SAFETY: the record is lent to the call; its texts stay.
    unsafe { (functions.journal)(state, phase, &raw const record) };
    Ok(call.python.nothing())
}

/// A value of a record: its kind, bits and text.
fn value(call: &Call<'_>, object: Raw) -> Result<(u32, u64, String), String> {
    let kind = call.kind(object)?;
    Ok(match kind.as_str() {
        "NoneType" => (5, 0, String::new()),
        "bool" => (0, u64::from(call.is_true(object)), String::new()),
        "int" => (1, call.integer(object)? as u64, String::new()),
        "float" => (2, call.float(object)?.to_bits(), String::new()),
        "str" => (6, 0, call.python.read_text(object)?),
        "tuple" => match call.items(object)[..] {
            [first, second] => {
                let half = |object| {
                    let number = i32::try_from(call.integer(object)?).map_err(|error| error.to_string())?;
                    Ok::<u64, String>(u64::from(number as u32))
                };
                (3, half(first)? | half(second)? << 32, String::new())
            }
            _ => return Err("a tuple in a record has two whole numbers".to_owned()),
        },
        _ => return Err(format!("a value of a record is a `{kind}`, expected a bool, int, float, str, pair or None")),
    })
}

fn report(call: &Call<'_>) -> Result<Object, String> {
    let (functions, state) = call.host()?;
    let (path, object) = (call.text(0)?, call.argument(1)?);
    let (kind, bits, text) = match value(call, object)? {
        (5, ..) => (0, 0, String::new()),
        (0, bits, _) => (1, bits, String::new()),
        (1, bits, _) => (2, bits, String::new()),
        (2, bits, _) => (3, bits, String::new()),
        (6, _, text) => (4, 0, text),
        _ => return Err("a value of the report is a bool, int, float, str or None".to_owned()),
    };
    let view =
        ReportView { name: Bytes::NONE, kind, bits, text: Bytes::text(&text), children: ptr::null(), child_count: 0 };
    // SAFETY: path and value are lent to the call.
    unsafe { (functions.report)(state, Bytes::text(&path), &raw const view) };
    Ok(call.python.nothing())
}

fn alert(call: &Call<'_>) -> Result<Object, String> {
    let (functions, state) = call.host()?;
    let (kind, subject, line) = (call.text(0)?, call.text(1)?, call.argument(2)?);
    let line = if line == call.python.none { None } else { Some(call.python.read_text(line)?) };
    let shown = line.as_deref().map_or(Bytes::NONE, Bytes::text);
    // SAFETY: the texts are lent to the call.
    unsafe { (functions.alert)(state, Bytes::text(&kind), Bytes::text(&subject), shown) };
    Ok(call.python.nothing())
}

/// Gives each function its table entry: the closure that Python calls through a function of C.
macro_rules! functions {
    ($($name:ident: $body:expr;)*) => {
        /// The functions as C calls them.
        mod exported {
            use super::*;

            $(
                pub(super) unsafe extern "C" fn $name(_module: Raw, arguments: Raw) -> Raw {
                    let body: fn(&Call<'_>) -> Result<Object, String> = $body;
                    // SAFETY: Python calls it, with the lock and a tuple.
                    unsafe { answer(arguments, body) }
                }
            )*
        }

        const ALL: &[(&str, Function)] = &[$((stringify!($name), exported::$name)),*];
    };
}

/// Answers a call: an error of Python where it fails.
///
/// # Safety
/// The lock is held, and the arguments are a tuple.
unsafe fn answer(arguments: Raw, body: fn(&Call<'_>) -> Result<Object, String>) -> Raw {
    let Some(python) = inside() else { return ptr::null_mut() };
    // SAFETY: what is lent stays until the call that it was lent for ends.
    let host = unsafe { HOST.get().as_ref() };
    let result = std::panic::catch_unwind(|| body(&Call { python, arguments, host }));
    let error = match result {
        Ok(Ok(object)) => return object.0,
        Ok(Err(error)) => error,
        Err(_) => "a function of the program panicked".to_owned(),
    };
    let text = CString::new(error.replace('\0', ": ")).unwrap_or_default();
    // SAFETY: the lock is held; the data symbol is a pointer to the class.
    unsafe { (python.symbols.PyErr_SetString)(*python.symbols.PyExc_RuntimeError.cast::<Raw>(), text.as_ptr()) };
    ptr::null_mut()
}

/// A function of the context that gives a number.
macro_rules! number {
    ($name:ident) => {
        |call| {
            let (functions, state) = call.host()?;
            // SAFETY: the state is that of the context.
            Ok(call.python.number(u64::from(unsafe { (functions.$name)(state) })))
        }
    };
}

// SAFETY of all calls below: the state is that of the context, and texts and bytes are lent to the call.
functions! {
    now: number!(now);
    due: number!(due);
    execution: number!(execution);
    period: number!(period);
    sender: number!(sender);
    cancelled: number!(cancelled);
    random: number!(next_random);
    cause: number!(cause);
    name: |call| {
        let (functions, state) = call.host()?;
        // SAFETY: see above.
        Ok(call.python.text(unsafe { (functions.name)(state).get_text() }.map_err(|error| error.to_string())?))
    };
    publish: |call| topic(call, |functions, state, view, index, error| {
        // SAFETY: see above.
        unsafe { (functions.publish)(state, view, index, error) }
    });
    subscribe: |call| topic(call, |functions, state, view, index, error| {
        // SAFETY: see above.
        unsafe { (functions.subscribe)(state, view, index, error) }
    });
    send: |call| {
        let (functions, state) = call.host()?;
        let (publisher, bytes) = (call.index(0)?, call.bytes(1)?);
        // SAFETY: see above.
        call.checked(|error| unsafe { (functions.send)(state, publisher, ptr::null(), Bytes::lend(&bytes), error) })?;
        Ok(call.python.nothing())
    };
    inbox: super::inbox;
    reference: |call| {
        let (functions, state) = call.host()?;
        let (name, interface, mut index) = (call.text(0)?, call.text(1)?, 0);
        // SAFETY: see above.
        call.checked(|error| unsafe {
            (functions.reference)(state, Bytes::text(&name), Bytes::text(&interface), &raw mut index, error)
        })?;
        Ok(call.python.number(u64::from(index)))
    };
    is_wired: |call| {
        let (functions, state) = call.host()?;
        let reference = call.index(0)?;
        // SAFETY: see above.
        Ok(call.python.number(u64::from(unsafe { (functions.is_wired)(state, reference) })))
    };
    targets: |call| {
        let (functions, state) = call.host()?;
        let reference = call.index(0)?;
        // SAFETY: see above.
        Ok(call.python.number(u64::from(unsafe { (functions.targets)(state, reference) })))
    };
    call: called;
    listens: |call| {
        let (functions, state) = call.host()?;
        let level = call.index(0)?;
        // SAFETY: see above.
        Ok(call.python.number(u64::from(unsafe { (functions.listens)(state, level) })))
    };
    log: |call| {
        let (functions, state) = call.host()?;
        let (level, line) = (call.index(0)?, call.text(1)?);
        // SAFETY: see above.
        unsafe { (functions.log)(state, level, Bytes::text(&line)) };
        Ok(call.python.nothing())
    };
    report: super::report;
    count: |call| {
        let (functions, state) = call.host()?;
        let (path, more) = (call.text(0)?, call.integer(call.argument(1)?)?);
        // SAFETY: see above.
        unsafe { (functions.count)(state, Bytes::text(&path), more) };
        Ok(call.python.nothing())
    };
    vote: |call| {
        let (functions, state) = call.host()?;
        let work = call.index(0)?;
        // SAFETY: see above.
        unsafe { (functions.vote)(state, work) };
        Ok(call.python.nothing())
    };
    because: |call| {
        let (functions, state) = call.host()?;
        let cause = call.number(0)?;
        // SAFETY: see above.
        unsafe { (functions.because)(state, cause) };
        Ok(call.python.nothing())
    };
    journal: super::journal;
    raise_event: |call| {
        let (functions, state) = call.host()?;
        let event = call.text(0)?;
        // SAFETY: see above.
        call.checked(|error| unsafe { (functions.raise)(state, Bytes::text(&event), error) })?;
        Ok(call.python.nothing())
    };
    alert: super::alert;
    status: |call| {
        let status = call.text(0)?;
        STATUS.set(Some(status));
        Ok(call.python.nothing())
    };
}

/// `METH_VARARGS`
const AS_TUPLE: i32 = 1;

/// Adds the functions to the module.
///
/// # Safety
/// The lock is held; `module` and `names` are a module and its dictionary.
pub(crate) unsafe fn add(python: &Python<'_>, module: Raw, names: Raw) -> Result<(), String> {
    for (name, function) in ALL {
        let name = CString::new(*name).map_err(|error| error.to_string())?.into_raw();
        let method = Method { name, function: Some(*function), flags: AS_TUPLE, doc: ptr::null() };
        // SAFETY: as the caller promises; the method and its name stay.
        unsafe {
            let method: *mut Method = Box::leak(Box::new(method));
            let object = python.own((python.symbols.PyCFunction_NewEx)(method, module, ptr::null_mut()))?;
            (python.symbols.PyDict_SetItemString)(names, name, object.0);
            python.free(object);
        }
    }
    Ok(())
}
