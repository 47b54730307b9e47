//! Destructors of thread-local variables, which the system keeps under the loader's lock. While a library hangs in its
//! static constructors, nobody gets that lock: no thread of the program would begin, not even one that stops hardware.
//!
//! `__cxa_thread_atexit_impl` is defined here, as `exit` is in [`end`](super::end). The lock is for libraries that are
//! unloaded. The program and the libraries of plugins never are, so their destructors are kept without it.

use std::cell::Cell;
use std::ffi::{c_int, c_void};
use std::mem::transmute;
use std::ptr;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicPtr, AtomicUsize, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use saoms_api::host::present::{Owner, library_at};

use super::blame::next;

type Destructor = unsafe extern "C" fn(*mut c_void);
type Register = unsafe extern "C" fn(Destructor, *mut c_void, *mut c_void) -> c_int;

/// A destructor of the present thread, and those that were registered before it.
struct Node {
    destructor: Destructor,
    of: *mut c_void,
    before: *mut Node,
}

thread_local! {
    /// Without a destructor, which would be registered here.
    static NEWEST: Cell<*mut Node> = const { Cell::new(ptr::null_mut()) };
    /// The library whose destructor runs.
    static RUNS: Cell<Option<&'static Owner>> = const { Cell::new(None) };
    /// True while destructors of libraries wait for the end of this thread.
    static HAS_OF_LIBRARY: Cell<bool> = const { Cell::new(false) };
}

/// The number of threads for whose end destructors of libraries wait.
static WITH_LIBRARY: AtomicUsize = AtomicUsize::new(0);

/// The number of destructors of libraries that run, and the library of the last one that began.
static RUNNING: AtomicUsize = AtomicUsize::new(0);
static LAST: AtomicPtr<Owner> = AtomicPtr::new(ptr::null_mut());

/// Waits for the ends of other threads that call destructors of libraries, as those of a run that has ended: what these
/// do is told. Not for long: some threads end with the process. Longer for a destructor that runs: a panic in it needs
/// time to be told. The library of one that still runs.
pub(super) fn wait((patience, running): (Duration, Duration)) -> Option<&'static Owner> {
    let own = usize::from(HAS_OF_LIBRARY.get());
    let start = Instant::now();
    let is_patient = || start.elapsed() < if RUNNING.load(Ordering::SeqCst) > 0 { running } else { patience };
    while WITH_LIBRARY.load(Ordering::SeqCst) > own && is_patient() {
        thread::sleep(LOOK);
    }
    // SAFETY: what is noted there lasts as long as the program.
    let last = unsafe { LAST.load(Ordering::SeqCst).as_ref() };
    last.filter(|_| RUNNING.load(Ordering::SeqCst) > 0)
}

/// The time between two looks.
const LOOK: Duration = Duration::from_millis(1);

/// The library whose destructor runs on the present thread. A signal handler may ask.
pub(super) fn present() -> Option<&'static Owner> {
    RUNS.get()
}

unsafe extern "C" {
    /// The first and the last address of the program, which the linker defines.
    static __executable_start: u8;
    static _end: u8;
}

/// The system's function for all other libraries. Looked up once: that, too, takes the lock.
fn of_system() -> Option<Register> {
    static REGISTER: OnceLock<Option<Register>> = OnceLock::new();
    *REGISTER.get_or_init(|| {
        let next = next(c"__cxa_thread_atexit_impl");
        // SAFETY: the system's function of this name has this type.
        (!next.is_null()).then(|| unsafe { transmute::<*mut c_void, Register>(next) })
    })
}

/// Looks up what is of the system, before a library can hang.
pub(super) fn prepare() {
    of_system();
}

/// Has a destructor called at the end of the present thread, in the reverse order of these calls.
///
/// # Safety
/// The destructor may be called with this pointer then, and its code is still loaded if `library` is.
#[unsafe(no_mangle)]
unsafe extern "C" fn __cxa_thread_atexit_impl(destructor: Destructor, of: *mut c_void, library: *mut c_void) -> c_int {
    let code = destructor as usize;
    let program = (&raw const __executable_start) as usize..(&raw const _end) as usize;
    let is_of_library = library_at(code).is_some();
    if (program.contains(&code) || is_of_library) && is_run_at_end() {
        if is_of_library && !HAS_OF_LIBRARY.replace(true) {
            WITH_LIBRARY.fetch_add(1, Ordering::SeqCst);
        }
        let node = Box::new(Node { destructor, of, before: NEWEST.get() });
        NEWEST.set(Box::into_raw(node));
        return 0;
    }
    match of_system() {
        // SAFETY: as the caller promises.
        Some(register) => unsafe { register(destructor, of, library) },
        None => -1,
    }
}

/// Makes sure that the present thread calls its destructors when it ends.
fn is_run_at_end() -> bool {
    static KEY: OnceLock<Option<libc::pthread_key_t>> = OnceLock::new();
    let key = KEY.get_or_init(|| {
        let mut key = 0;
        // SAFETY: the key is written to where there is room for it; the function takes the value of the key.
        (unsafe { libc::pthread_key_create(&raw mut key, Some(run)) } == 0).then_some(key)
    });
    let is_set = |key: libc::pthread_key_t| {
        // Any value but null has `run` called.
        // SAFETY: the key was created and is never deleted; nobody follows the pointer.
        unsafe { libc::pthread_setspecific(key, (&raw const __executable_start).cast()) == 0 }
    };
    !NEWEST.get().is_null() || key.is_some_and(is_set)
}

/// Calls the destructors of the present thread, also those that these register.
unsafe extern "C" fn run(_: *mut c_void) {
    while !NEWEST.get().is_null() {
        // SAFETY: it was made by `Box::into_raw`, and is taken out of the list once.
        let node = unsafe { Box::from_raw(NEWEST.get()) };
        NEWEST.set(node.before);
        let library = library_at(node.destructor as usize).map(Owner::of_library);
        if let Some(library) = library {
            LAST.store(ptr::from_ref(library).cast_mut(), Ordering::SeqCst);
            RUNNING.fetch_add(1, Ordering::SeqCst);
        }
        RUNS.set(library);
        // SAFETY: its code is of the program or of a library that is never unloaded; the pointer is its own.
        unsafe { (node.destructor)(node.of) };
        RUNS.set(None);
        RUNNING.fetch_sub(usize::from(library.is_some()), Ordering::SeqCst);
    }
    if HAS_OF_LIBRARY.take() {
        WITH_LIBRARY.fetch_sub(1, Ordering::SeqCst);
    }
}

#[cfg(test)]
mod tests {
    use std::cell::RefCell;
    use std::sync::mpsc::{Sender, channel};
    use std::thread;

    struct Last(&'static str, Sender<&'static str>);

    impl Drop for Last {
        fn drop(&mut self) {
            let _ = self.1.send(self.0);
            if self.0 == "second" {
                let sent = self.1.clone();
                THIRD.with(|third| third.replace(Some(Last("third", sent))));
            }
        }
    }

    thread_local! {
        static FIRST: RefCell<Option<Last>> = const { RefCell::new(None) };
        static SECOND: RefCell<Option<Last>> = const { RefCell::new(None) };
        static THIRD: RefCell<Option<Last>> = const { RefCell::new(None) };
    }

    #[test]
    fn destructors_of_a_thread_run_once_also_those_that_come_meanwhile() {
        let (sent, ended) = channel();
        let thread = thread::spawn(move || {
            FIRST.with(|first| first.replace(Some(Last("first", sent.clone()))));
            SECOND.with(|second| second.replace(Some(Last("second", sent))));
            super::NEWEST.get().is_null()
        });
        assert!(!thread.join().unwrap(), "they are kept here");
        assert_eq!(ended.iter().collect::<Vec<_>>(), ["second", "third", "first"]);
    }
}
