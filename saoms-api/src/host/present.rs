//! For hosts: the library code that each thread runs now, so that reports of crashes and hangs name it.
//!
//! Whoever calls into a library [enters](enter) first. What is written down can be read by a signal handler on the same
//! thread ([`here`]) and by another thread ([`everywhere`]): names are interned, and nothing of it is ever freed.

use std::cell::Cell;
use std::collections::HashMap;
use std::ops::Range;
use std::ptr;
use std::sync::atomic::{AtomicPtr, AtomicU8, AtomicU64, Ordering};
use std::sync::{Mutex, OnceLock, PoisonError};

use super::one_line;

/// A component, or what else is called, and the library of its code, once for the life of the process.
#[derive(Debug)]
pub struct Owner {
    /// The description, as ``component `Arm` of library `./libarm.so` ``.
    pub text: String,
}

impl Owner {
    /// The subject of a library as a whole.
    const WHOLE: &str = "library";

    /// The library itself, while it is loaded.
    pub fn of_library(library: &'static str) -> &'static Owner {
        Owner::of(Owner::WHOLE, library)
    }

    /// The owner of these names.
    pub fn of(subject: &str, library: &'static str) -> &'static Owner {
        static KNOWN: Mutex<Option<HashMap<(String, &'static str), &'static Owner>>> = Mutex::new(None);
        let mut known = KNOWN.lock().unwrap_or_else(PoisonError::into_inner);
        let known = known.get_or_insert_default();
        if let Some(owner) = known.get(&(subject.to_owned(), library)) {
            return owner;
        }
        let text = match subject {
            Owner::WHOLE => format!("library `{library}`"),
            "" => format!("a component of library `{library}`"),
            subject => format!("{subject} of library `{library}`"),
        };
        let owner: &'static Owner = Box::leak(Box::new(Owner { text: one_line(&text).into_owned() }));
        known.insert((subject.to_owned(), library), owner);
        owner
    }
}

macro_rules! functions {
    ($($(#[$doc:meta])* $function:ident $text:literal,)*) => {
        /// A function of a library.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        #[repr(u8)]
        pub enum Function {
            $($(#[$doc])* $function,)*
        }

        impl Function {
            const ALL: &[Function] = &[$(Function::$function),*];

            /// Its name in messages.
            pub const fn name(self) -> &'static str {
                match self {
                    $(Function::$function => $text,)*
                }
            }

            /// When its code did something, as ``in `execute` ``.
            #[expect(unreachable_patterns, reason = "one of them is told in another way")]
            pub const fn place(self) -> &'static str {
                match self {
                    Function::Load => "while it was loaded",
                    $(Function::$function => concat!("in ", $text),)*
                }
            }
        }
    };
}

functions! {
    /// The function that gives the tables, and what runs while the library is loaded.
    Load "the static constructors or the entry function",
    /// The constructor of a component or a loop.
    Construct "the constructor",
    /// `initialize`.
    Initialize "`initialize`",
    /// `execute`.
    Execute "`execute`",
    /// `react`.
    React "`react`",
    /// `update`.
    Update "`update`",
    /// `serve`.
    Serve "a service",
    /// `monitor` of a loop.
    Monitor "`monitor` of a loop",
    /// `adapt` of a loop.
    Adapt "`analyze`, `plan` or `execute` of a loop",
    /// `shutdown`.
    Shutdown "`shutdown`",
    /// `save`.
    Save "`save`",
    /// `restore`.
    Restore "`restore`",
    /// `waits_for`.
    WaitsFor "`waits_for`",
    /// `status`.
    Status "`status`",
    /// The function that stops hardware.
    Stop "the function that stops its hardware",
    /// The heartbeat of hardware.
    Heartbeat "the heartbeat of its hardware",
    /// The destructor of a component or a loop.
    Destroy "the destructor",
    /// A rule over whole fleets.
    Check "a rule over fleets",
    /// What a thread of the program calls when it ends.
    ThreadEnd "the destructor of a thread-local variable",
}

impl Function {
    /// True if the host [looks](look_after) at what it did once it has returned.
    pub const fn is_looked_after(self) -> bool {
        matches!(self, Function::Load | Function::Construct | Function::Initialize)
    }

    /// True if the program itself waits for it, so that nothing goes on while it hangs.
    pub const fn holds_up(self) -> bool {
        use Function::{Check, Construct, Destroy, Initialize, Load, Restore, Save, Update};
        matches!(self, Load | Construct | Initialize | Update | Save | Restore | Destroy | Check)
    }
}

/// The call of a thread.
struct ThreadCall {
    owner: AtomicPtr<Owner>,
    function: AtomicU8,
    /// Counts beginnings and ends, so that another thread can distinguish two calls.
    changes: AtomicU64,
    /// The value of `changes` when the present call began; 0 if there is none.
    number: AtomicU64,
}

/// The number of bits that count the changes of one thread; those above are the number of its entry.
const COUNTED: u32 = 44;

/// The entries of all threads that ever called a library, and those whose thread has ended.
static ALL: Mutex<Vec<&'static ThreadCall>> = Mutex::new(Vec::new());
static FREE: Mutex<Vec<&'static ThreadCall>> = Mutex::new(Vec::new());

/// Gives the entry of a thread back when the thread ends.
struct Registered(&'static ThreadCall);

impl Drop for Registered {
    fn drop(&mut self) {
        // `exit` in a call ends the thread in the middle of it.
        if !self.0.owner.load(Ordering::Relaxed).is_null() {
            return;
        }
        HERE.set(None);
        FREE.lock().unwrap_or_else(PoisonError::into_inner).push(self.0);
    }
}

thread_local! {
    /// Without a destructor, so that a signal handler can read it at any time.
    static HERE: Cell<Option<&'static ThreadCall>> = const { Cell::new(None) };
    /// Stays true while the thread ends, when `HERE` is empty again.
    static IS_OF_PROGRAM: Cell<bool> = const { Cell::new(false) };
    /// In a child of `fork`: what its thread did then, and what is done when that returns.
    static FORKED: Cell<Option<(&'static ThreadCall, Returned)>> = const { Cell::new(None) };
    static SUBJECT: Cell<Option<*const str>> = const { Cell::new(None) };
    static REGISTERED: Cell<Option<Registered>> = const { Cell::new(None) };
}

/// What a child of `fork` does in place of going on with the program.
type Returned = fn(&'static Owner, Function) -> !;

/// For a handler that runs after `fork`, in the child: should the call that forked return there, or call back, this
/// ends the child.
pub fn forked(returned: Returned) {
    // Nobody finds the call any more, so that what costs nothing in other processes asks here.
    if let Some(call) = HERE.take() {
        FORKED.set(Some((call, returned)));
    }
}

#[cold]
fn end_forked() {
    if let Some((call, returned)) = FORKED.get()
        && let Some((owner, function)) = call.read()
    {
        returned(owner, function);
    }
}

#[cold]
fn register() -> &'static ThreadCall {
    end_forked();
    let free = FREE.lock().unwrap_or_else(PoisonError::into_inner).pop();
    let call = free.unwrap_or_else(|| {
        let mut all = ALL.lock().unwrap_or_else(PoisonError::into_inner);
        let new: &'static ThreadCall = Box::leak(Box::new(ThreadCall {
            owner: AtomicPtr::default(),
            function: AtomicU8::new(0),
            changes: AtomicU64::new((all.len() as u64) << COUNTED),
            number: AtomicU64::new(0),
        }));
        all.push(new);
        new
    });
    HERE.set(Some(call));
    IS_OF_PROGRAM.set(true);
    // In the last moments of a thread nothing gives it back, and it is leaked.
    let _ = REGISTERED.try_with(|registered| registered.set(Some(Registered(call))));
    call
}

/// A call into a library, until it is dropped.
#[derive(Debug)]
pub struct Entered {
    owner: *mut Owner,
    function: u8,
    number: u64,
}

/// Writes down that code of a library runs on this thread from now on.
#[inline]
pub fn enter(owner: &'static Owner, function: Function) -> Entered {
    let call = HERE.get().unwrap_or_else(register);
    let outer = Entered {
        owner: call.owner.load(Ordering::Relaxed),
        function: call.function.load(Ordering::Relaxed),
        number: call.number.load(Ordering::Relaxed),
    };
    let number = call.set(ptr::from_ref(owner).cast_mut(), function as u8);
    call.number.store(number, Ordering::Relaxed);
    outer
}

impl Drop for Entered {
    #[inline]
    fn drop(&mut self) {
        match HERE.get() {
            Some(call) => {
                call.set(self.owner, self.function);
                call.number.store(self.number, Ordering::Relaxed);
            }
            None => end_forked(),
        }
    }
}

impl ThreadCall {
    /// Writes a beginning or an end down, and gives its number.
    #[inline]
    fn set(&self, owner: *mut Owner, function: u8) -> u64 {
        // This thread alone writes.
        let number = self.changes.load(Ordering::Relaxed).wrapping_add(1);
        self.changes.store(number, Ordering::Relaxed);
        self.function.store(function, Ordering::Relaxed);
        self.owner.store(owner, Ordering::Release);
        number
    }

    fn read(&self) -> Option<(&'static Owner, Function)> {
        // SAFETY: owners are never freed.
        let owner = unsafe { self.owner.load(Ordering::Acquire).as_ref() }?;
        Function::ALL.get(usize::from(self.function.load(Ordering::Relaxed))).map(|function| (owner, *function))
    }
}

/// The code of a library that runs on this thread. A signal handler may ask.
pub fn here() -> Option<(&'static Owner, Function)> {
    HERE.get().and_then(ThreadCall::read)
}

/// A number that only the present call into a library has, of all calls of all threads; 0 outside of calls.
pub fn call_number() -> u64 {
    HERE.get().map_or(0, |call| call.number.load(Ordering::Relaxed))
}

/// The code of libraries that runs on all threads, each with a number that is another one at each call of the thread.
pub fn everywhere() -> Vec<(u64, Option<(&'static Owner, Function)>)> {
    let all = ALL.lock().unwrap_or_else(PoisonError::into_inner);
    all.iter().map(|call| (call.changes.load(Ordering::Relaxed), call.read())).collect()
}

/// The code of a component that a thread runs now, if a library has it, as ``function of library `./libarm.so` ``.
pub fn present_code(component: &str) -> Option<String> {
    code_of(component).map(|(function, library)| format!("{} of library `{library}`", function.name()))
}

/// The library of the code of a component that a thread runs now.
pub fn present_library(component: &str) -> Option<&'static str> {
    code_of(component).map(|(_, library)| library)
}

fn code_of(component: &str) -> Option<(Function, &'static str)> {
    let own = format!("component `{component}` of library `");
    let library = |owner: &'static Owner| owner.text.strip_prefix(&own)?.strip_suffix('`');
    let mut calls = everywhere().into_iter().filter_map(|(_, call)| call);
    calls.find_map(|(owner, function)| Some((function, library(owner)?)))
}

/// What a host looks at when code of a library that begins has returned.
type Look = fn(&'static Owner, Function);

static LOOK: OnceLock<Look> = OnceLock::new();

/// For hosts: calls this function whenever a library was loaded, or something of it was constructed or initialized.
pub fn look_after(look: Look) {
    // The first one stays.
    let _ = LOOK.set(look);
}

/// A call after which the host looks.
#[derive(Debug)]
pub struct LookedAfter(&'static Owner, Function);

/// Lets the host look, once what is given back is dropped.
pub fn looked_after(owner: &'static Owner, function: Function) -> LookedAfter {
    LookedAfter(owner, function)
}

impl Drop for LookedAfter {
    fn drop(&mut self) {
        if let Some(look) = LOOK.get() {
            look(self.0, self.1);
        }
    }
}

/// The libraries whose code is known, the newest first. A signal handler may ask.
pub fn libraries() -> impl Iterator<Item = &'static str> {
    let mut code: *const Code = CODE.load(Ordering::Acquire);
    std::iter::from_fn(move || {
        // SAFETY: nodes are never freed, nor changed once they are in the list.
        let node = unsafe { code.as_ref() }?;
        code = node.next;
        Some(node.library)
    })
}

/// True if this thread ever ran code of a library that it called: then it is a thread of the program.
pub fn is_of_program() -> bool {
    IS_OF_PROGRAM.get()
}

/// A range of addresses with code of a library, in a list that only grows: a signal handler reads it.
struct Code {
    addresses: Range<usize>,
    library: &'static str,
    next: *const Code,
}

static CODE: AtomicPtr<Code> = AtomicPtr::new(ptr::null_mut());

/// Notes where the code of a library lies, which stays there.
pub fn note_code(library: &'static str, addresses: Range<usize>) {
    let node = Box::leak(Box::new(Code { addresses, library, next: ptr::null() }));
    let mut first = CODE.load(Ordering::Acquire);
    loop {
        node.next = first;
        match CODE.compare_exchange_weak(first, node, Ordering::AcqRel, Ordering::Acquire) {
            Ok(_) => return,
            Err(other) => first = other,
        }
    }
}

/// The library whose code is at an address. A signal handler may ask.
pub fn library_at(address: usize) -> Option<&'static str> {
    let mut code: *const Code = CODE.load(Ordering::Acquire);
    // SAFETY: nodes are never freed, nor changed once they are in the list.
    while let Some(node) = unsafe { code.as_ref() } {
        if node.addresses.contains(&address) {
            return Some(node.library);
        }
        code = node.next;
    }
    None
}

/// Runs code that constructs something for a subject, as ``component `Arm` ``, of whatever library it is.
pub fn about<T>(subject: &str, code: impl FnOnce() -> T) -> T {
    struct Reset(Option<*const str>);

    impl Drop for Reset {
        fn drop(&mut self) {
            SUBJECT.set(self.0);
        }
    }

    let _reset = Reset(SUBJECT.replace(Some(subject)));
    code()
}

/// The owner of what is constructed now, of this library.
pub fn subject(library: &'static str) -> &'static Owner {
    // SAFETY: `about` lends the subject until its code has returned, of which this is a part.
    Owner::of(SUBJECT.get().map_or("", |subject| unsafe { &*subject }), library)
}
