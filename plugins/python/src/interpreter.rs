//! The interpreter: opened, started and called.
//!
//! Its library is opened before anything needs it, with its symbols for all (`RTLD_GLOBAL`), so that extension modules
//! such as those of numpy find them. It starts without handlers of signals, and with a fixed seed of hashes unless
//! `PYTHONHASHSEED` gives one, so that sets of texts have the same order in each run. It is never ended: threads that
//! Python code has started end with the process.

use std::env;
use std::ffi::{CString, c_char};
use std::ptr;
use std::sync::atomic::{AtomicPtr, Ordering};
use std::sync::{Mutex, OnceLock, PoisonError};

use libloading::os::unix::{Library, RTLD_GLOBAL, RTLD_NOW};

use crate::find::{Installation, installation};
use crate::functions;
use crate::object::{Object, Python};
use crate::symbols::{Raw, Symbols};

/// The package, by the names of its modules, in the order in which they use each other.
const MODULES: [(&str, &str); 4] = [
    ("saoms", include_str!("../saoms/__init__.py")),
    ("saoms._codec", include_str!("../saoms/_codec.py")),
    ("saoms._declare", include_str!("../saoms/_declare.py")),
    ("saoms._bridge", include_str!("../saoms/_bridge.py")),
];

const START: &str = include_str!("start.py");

/// `Py_file_input`
const FILE_INPUT: i32 = 257;

struct Interpreter {
    symbols: Symbols,
    bridge: Raw,
    none: Raw,
}

// SAFETY: the objects live as long as the interpreter, and are used with its lock alone.
unsafe impl Send for Interpreter {}

// SAFETY: the same.
unsafe impl Sync for Interpreter {}

static INTERPRETER: OnceLock<Result<Interpreter, String>> = OnceLock::new();

/// Objects to be freed by the next who holds the lock: who gives one up does not wait for that.
static GIVEN_UP: Mutex<Vec<Object>> = Mutex::new(Vec::new());

/// Gives up an object, on whatever thread.
pub(crate) fn give_up(object: Object) {
    GIVEN_UP.lock().unwrap_or_else(PoisonError::into_inner).push(object);
}

/// Calls a function with the lock of the interpreter, which starts with the first call.
///
/// # Errors
/// There is no interpreter that could be used; or those of the function.
pub(crate) fn with<R>(call: impl FnOnce(Python<'_>) -> Result<R, String>) -> Result<R, String> {
    let Interpreter { symbols, bridge, none } = INTERPRETER.get_or_init(start).as_ref().map_err(Clone::clone)?;
    let _lock = Lock::take(symbols);
    let python = Python { symbols, bridge: *bridge, none: *none };
    let given_up = std::mem::take(&mut *GIVEN_UP.lock().unwrap_or_else(PoisonError::into_inner));
    given_up.into_iter().for_each(|object| python.free(object));
    call(python)
}

/// The lock of the interpreter.
struct Lock<'a>(&'a Symbols, i32);

impl<'a> Lock<'a> {
    fn take(symbols: &'a Symbols) -> Lock<'a> {
        // SAFETY: the interpreter has started; the thread may have the lock already.
        Lock(symbols, unsafe { (symbols.PyGILState_Ensure)() })
    }
}

impl Drop for Lock<'_> {
    fn drop(&mut self) {
        // SAFETY: it undoes what `take` did, on the same thread.
        unsafe { (self.0.PyGILState_Release)(self.1) }
    }
}

/// The interpreter for a function that Python calls: this thread holds the lock.
pub(crate) fn inside() -> Option<Python<'static>> {
    let Interpreter { symbols, bridge, none } = INTERPRETER.get()?.as_ref().ok()?;
    Some(Python { symbols, bridge: *bridge, none: *none })
}

fn start() -> Result<Interpreter, String> {
    let (found, file) = installation()?;
    // SAFETY: it is the library of the interpreter that the user has or names.
    let library = unsafe { Library::open(Some(&file), RTLD_NOW | RTLD_GLOBAL) };
    let library: &'static Library =
        Box::leak(Box::new(library.map_err(|error| format!("`{}` cannot be loaded: {error}", file.display()))?));
    let symbols = Symbols::of(library).map_err(|error| format!("`{}` lacks a function: {error}", file.display()))?;
    // SAFETY: it may be asked at any time.
    let started = if unsafe { (symbols.Py_IsInitialized)() } == 1 {
        // By an earlier build of this library, which is still loaded.
        let _lock = Lock::take(&symbols);
        prepare(&symbols, &found)
    } else {
        initialize(library, &symbols, &found);
        let started = prepare(&symbols, &found);
        // SAFETY: this thread holds the lock since the start, and leaves it to others.
        unsafe { (symbols.PyEval_SaveThread)() };
        started
    };
    let (bridge, none) = started.map_err(|error| format!("the package `saoms` cannot be loaded in Python: {error}"))?;
    Ok(Interpreter { symbols, bridge, none })
}

unsafe extern "C" {
    static mut environ: *mut *mut c_char;
}

/// Starts the interpreter on this thread, which holds its lock then.
fn initialize(library: &Library, symbols: &Symbols, found: &Installation) {
    // SAFETY: where the function is there, it has this type; the text, four bytes a character, is leaked.
    if let Ok(set_home) = unsafe { library.get::<unsafe extern "C" fn(*const u32)>(b"Py_SetPythonHome") } {
        let home: Vec<u32> = found.home.chars().map(u32::from).chain([0]).collect();
        // SAFETY: before the start, with a text that stays.
        unsafe { set_home(home.leak().as_ptr()) };
    }
    let seeded = env::var_os("PYTHONHASHSEED").is_none().then(|| {
        // A copy of the list of variables with one more is put in the place of the list for the time of the start: it
        // is never freed, so a thread that reads the list meanwhile reads one that is whole.
        // SAFETY: the list ends with null.
        let before = unsafe { environ };
        let mut list = Vec::new();
        let mut at = before;
        // SAFETY: as above.
        unsafe {
            while !at.is_null() && !(*at).is_null() {
                list.push(*at);
                at = at.add(1);
            }
        }
        list.push(c"PYTHONHASHSEED=0".as_ptr().cast_mut());
        list.push(ptr::null_mut());
        // SAFETY: the variable is a pointer, which others read whole.
        let place = unsafe { AtomicPtr::from_ptr(&raw mut environ) };
        place.store(list.leak().as_mut_ptr(), Ordering::Release);
        (place, before)
    });
    // SAFETY: it starts once; 0: it handles no signals.
    unsafe { (symbols.Py_InitializeEx)(0) };
    if let Some((place, before)) = seeded {
        place.store(before, Ordering::Release);
    }
}

/// Loads the package, and gives its bridge and None.
fn prepare(symbols: &Symbols, found: &Installation) -> Result<(Raw, Raw), String> {
    let python = Python { symbols, bridge: ptr::null_mut(), none: ptr::null_mut() };
    // SAFETY: the lock is held; each text ends with zero; modules live as long as the interpreter.
    unsafe {
        let module = (symbols.PyImport_AddModule)(c"_saoms".as_ptr());
        if module.is_null() {
            return Err(python.error());
        }
        let names = (symbols.PyModule_GetDict)(module);
        functions::add(&python, module, names)?;
        let builtins = python.own((symbols.PyImport_ImportModule)(c"builtins".as_ptr()))?;
        (symbols.PyDict_SetItemString)(names, c"__builtins__".as_ptr(), builtins.0);
        for (name, value) in [
            ("sources", serde_json::to_string(&MODULES)),
            ("installation", serde_json::to_string(&(&found.path, &found.prefix, &found.executable))),
        ] {
            let value = python.text(&value.map_err(|error| error.to_string())?);
            let name = CString::new(name).map_err(|error| error.to_string())?;
            (symbols.PyDict_SetItemString)(names, name.as_ptr(), value.0);
            python.free(value);
        }
        let source = CString::new(START).map_err(|error| error.to_string())?;
        let code = python.own((symbols.Py_CompileString)(source.as_ptr(), c"<saoms start>".as_ptr(), FILE_INPUT))?;
        python.own((symbols.PyEval_EvalCode)(code.0, names, names))?;
        let bridge = python.own((symbols.PyImport_ImportModule)(c"saoms._bridge".as_ptr()))?;
        let none = python.attribute(bridge.0, "NONE")?;
        Ok((bridge.0, none.0))
    }
}
