//! Tables written by hand, as somebody who writes C could: they do what no safe code can.

use std::ffi::c_void;
use std::mem::offset_of;
use std::sync::atomic::{AtomicPtr, Ordering};
use std::{ptr, thread};

use saoms_abi::{
    Bytes, ClassTable, ComponentTable, FindingSink, HostHandle, PluginTable, PropertyView, RecordView,
    ReportView, Sink, Status, TopicView, ValueView,
};
use saoms_api::host::declaration::ConstText;
use saoms_api::{Class, Component, Context, Failure, Message, Properties, Topic, interface};

/// A message.
#[derive(Clone, Debug, Message)]
pub struct Word {
    text: String,
}

const WORDS: Topic<Word> = Topic::event("WORDS");

/// Can be called.
#[interface(name = "raw.Callee")]
pub trait Callee {
    /// Answers.
    fn call(&mut self, context: &mut Context<'_>) -> Result<u32, Failure>;
}

#[derive(Debug, Properties)]
pub struct ActorProperties {
    /// The way it misbehaves.
    #[property(default = "")]
    does: String,
}

/// Declares what the tables below do.
#[derive(Debug, Class)]
#[class(name = "raw.Actor", periodic, publishes(WORDS), service("callee": Callee), reference("callee": Callee, optional))]
pub struct Actor;

impl Component for Actor {
    type Properties = ActorProperties;

    fn new(properties: ActorProperties) -> Result<Self, Failure> {
        Err(properties.does.into())
    }
}

impl Callee for Actor {
    fn call(&mut self, _: &mut Context<'_>) -> Result<u32, Failure> {
        Err("".into())
    }
}

struct State {
    does: String,
    words: u32,
    callee: u32,
    executions: u32,
}

/// A handle that a component kept.
static KEPT: AtomicPtr<HostHandle> = AtomicPtr::new(ptr::null_mut());
/// The state of a sink that a component kept.
static SINK: AtomicPtr<c_void> = AtomicPtr::new(ptr::null_mut());

const NOT_TEXT: Bytes = Bytes::lend(&[0xff, 0xfe, b'x']);
const LONG: usize = (64 << 20) + 1;

unsafe extern "C" fn construct(
    values: *const PropertyView,
    count: usize,
    instance: *mut *mut c_void,
    _: FindingSink,
    error: Sink,
) -> Status {
    // SAFETY: the host lends the values.
    unsafe {
        let mut does = String::new();
        for place in 0..count {
            let view = *values.add(place);
            if view.name.get_text() == Ok("does") {
                does = view.text.get_text().unwrap_or_default().to_owned();
            }
        }
        match &*does {
            "refuses in bytes" => {
                (error.put)(error.state, NOT_TEXT);
                return Status::FAILED;
            }
            "refuses without a word" => return Status::FAILED,
            _ => {}
        }
        *instance = Box::into_raw(Box::new(State { does, words: 0, callee: 0, executions: 0 })).cast();
    }
    Status::OK
}

unsafe fn publish(host: &HostHandle, name: Bytes, error: Sink) -> (Status, u32) {
    let declared = WORDS.declaration();
    let view = TopicView {
        name,
        message: Bytes::text(declared.message),
        schema: Bytes::text(declared.schema),
        kind: 1,
    };
    let mut index = 0;
    // SAFETY: the handle is that of the call.
    let status = unsafe { ((*host.functions).publish)(host.state, &raw const view, &raw mut index, error) };
    (status, index)
}

unsafe extern "C" fn initialize(this: *mut c_void, host: *const HostHandle, error: Sink) -> Status {
    // SAFETY: the host calls with what the table's contract says.
    unsafe {
        let (state, host) = (&mut *this.cast::<State>(), &*host);
        let (status, words) = match &*state.does {
            "publishes bytes" => publish(host, NOT_TEXT, error),
            "publishes a secret" => publish(host, Bytes::text("SECRETS"), error),
            _ => publish(host, Bytes::text("WORDS"), error),
        };
        state.words = words;
        if status != Status::OK {
            return status;
        }
        let (name, interface) = (Bytes::text("callee"), Bytes::text("raw.Callee"));
        ((*host.functions).reference)(host.state, name, interface, &raw mut state.callee, error)
    }
}

/// A sink that forgets.
fn nowhere() -> Sink {
    unsafe extern "C" fn put(_: *mut c_void, _: Bytes) {}
    Sink { state: ptr::null_mut(), put }
}

/// Calls many functions of a context.
unsafe fn use_all(host: &HostHandle, words: u32) {
    // SAFETY: what the host gave; whether it is still valid is what the test is about.
    unsafe {
        let functions = &*host.functions;
        let state = host.state;
        (functions.name)(state);
        (functions.now)(state);
        (functions.chance)(state);
        (functions.next_random)(state);
        (functions.send)(state, words, ptr::null(), Bytes::lend(&[0; 8]), nowhere());
        (functions.log)(state, 2, Bytes::text("from where it must not come"));
        (functions.count)(state, Bytes::text("raw.stray"), 1);
        (functions.vote)(state, 1);
        let mut index = 0;
        (functions.reference)(state, Bytes::NONE, Bytes::NONE, &raw mut index, nowhere());
        (functions.call)(state, 0, 0, Bytes::NONE, nowhere(), nowhere());
    }
}

unsafe extern "C" fn execute(this: *mut c_void, handle: *const HostHandle, error: Sink) -> Status {
    // SAFETY: as in `initialize`; all else is what the tests are about.
    unsafe {
        let (state, host) = (&mut *this.cast::<State>(), &*handle);
        let functions = &*host.functions;
        state.executions += 1;
        let send = |bytes: Bytes| (functions.send)(host.state, state.words, ptr::null(), bytes, error);
        match &*state.does {
            // In CDR: the header, the length with its zero byte, the text.
            "" => send(Bytes::lend(b"\0\x01\0\0\x05\0\0\0word\0")),
            "sends noise" => send(Bytes::lend(b"\0\x01\0\0\xff\xff\xff\x7fno text")),
            "sends nothing" => send(Bytes::NONE),
            "sends too much" => send(Bytes { data: ptr::dangling(), length: LONG }),
            "sends nowhere" => (functions.send)(host.state, 999, ptr::null(), Bytes::lend(&[0; 8]), error),
            "says bytes" => {
                (functions.log)(host.state, 2, NOT_TEXT);
                (functions.log)(host.state, 99, Bytes { data: ptr::dangling(), length: LONG });
                (functions.count)(host.state, NOT_TEXT, 1);
                (functions.name_loop)(host.state, 77, NOT_TEXT);
                let record =
                    RecordView { id: NOT_TEXT, text: NOT_TEXT, names: NOT_TEXT, values: ptr::null(), count: 7 };
                (functions.journal)(host.state, 9, &raw const record);
                (functions.journal)(host.state, 1, &raw const record);
                let value = ValueView { kind: 99, bits: 0, word: NOT_TEXT };
                (functions.changed)(host.state, NOT_TEXT, &raw const value, &raw const value);
                let mut inner = ReportView {
                    name: Bytes::text("x"),
                    kind: 6,
                    bits: 0,
                    text: Bytes::NONE,
                    children: ptr::null(),
                    child_count: 1,
                };
                // A value that contains itself.
                inner.children = &raw const inner;
                (functions.report)(host.state, Bytes::text("raw.deep"), &raw const inner);
                inner.child_count = usize::MAX;
                (functions.report)(host.state, Bytes::text("raw.long"), &raw const inner);
                Status::OK
            }
            "fails in bytes" => {
                (error.put)(error.state, NOT_TEXT);
                Status::FAILED
            }
            "fails at length" => {
                (error.put)(error.state, Bytes { data: ptr::dangling(), length: LONG });
                Status::FAILED
            }
            "answers nonsense" => Status(77),
            "uses a thread" if state.executions == 3 => {
                let (handle, words) = (handle as usize, state.words);
                let _ = thread::spawn(move || use_all(&*(handle as *const HostHandle), words)).join();
                Status::OK
            }
            "keeps" => {
                KEPT.store(handle.cast_mut(), Ordering::SeqCst);
                SINK.store(error.state, Ordering::SeqCst);
                Status::OK
            }
            "uses what another kept" if state.executions == 3 => {
                let kept = KEPT.load(Ordering::SeqCst);
                if !kept.is_null() {
                    use_all(&*kept, state.words);
                    (error.put)(SINK.load(Ordering::SeqCst), Bytes::text("too late"));
                }
                Status::OK
            }
            "calls" => {
                KEPT.store(handle.cast_mut(), Ordering::SeqCst);
                (functions.call)(host.state, state.callee, 0, Bytes::NONE, nowhere(), error)
            }
            _ => Status::OK,
        }
    }
}

unsafe extern "C" fn shutdown(_: *mut c_void, _: *const HostHandle, _: Sink) -> Status {
    Status::OK
}

unsafe extern "C" fn serve(
    this: *mut c_void,
    _: *const HostHandle,
    _: Bytes,
    _: u32,
    _: Bytes,
    reply: Sink,
    error: Sink,
) -> Status {
    // SAFETY: as in `execute`.
    unsafe {
        match &*(*this.cast::<State>()).does {
            "uses the caller's" => use_all(&*KEPT.load(Ordering::SeqCst), 0),
            "replies too much" => (reply.put)(reply.state, Bytes { data: ptr::dangling(), length: LONG }),
            "replies nonsense" => {
                (error.put)(error.state, NOT_TEXT);
                return Status(78);
            }
            _ => {}
        }
        (reply.put)(reply.state, Bytes::lend(&[1, 0, 0, 0]));
    }
    Status::OK
}

unsafe extern "C" fn destroy(this: *mut c_void) {
    // SAFETY: the instance is that of `construct`, given back once.
    drop(unsafe { Box::from_raw(this.cast::<State>()) });
}

static COMPONENT: ComponentTable = ComponentTable {
    // As of a library that was built before components could say what they wait for.
    size: offset_of!(ComponentTable, waits_for),
    initialize,
    execute,
    shutdown,
    serve,
    destroy,
    save: None,
    restore: None,
    waits_for: None,
    status: None,
    react: None,
    update: None,
};
static CLASS: ClassTable =
    ClassTable { size: size_of::<ClassTable>(), construct, component: &raw const COMPONENT };
static CLASSES: &[&ClassTable] = &[&CLASS];

const TEXT: ConstText = ConstText::Joined(&[
    ConstText::Plain(r#"{"saoms":"plugin","abi":3,"package":"test-raw","entry":"raw_entry","classes":["#),
    ConstText::Plain(<Actor as Class>::DECLARATION),
    ConstText::Plain("]}"),
]);

#[used]
#[unsafe(link_section = ".saoms.plugin")]
static METADATA: [u8; TEXT.length()] = TEXT.bytes();

static TABLE: PluginTable = PluginTable::new(&METADATA, CLASSES, &[], &[]);

#[unsafe(no_mangle)]
extern "C" fn raw_entry(_: u32) -> *const PluginTable {
    &raw const TABLE
}
