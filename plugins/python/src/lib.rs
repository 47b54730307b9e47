//! Components in Python: the plugin that runs the classes of `implementation.python`.
//!
//! It is one file that depends on no Python when it is built or loaded. The interpreter is found when a composite names
//! a class, and its library is opened so that extension modules find its symbols, which a library linked against Python
//! (with PyO3) would need before it is loaded itself: see `interpreter`. What a class declares is read from its syntax
//! tree by `saoms/_declare.py`; its code is imported when a component of it is initialized.

mod component;
mod find;
mod functions;
mod interpreter;
mod object;
mod symbols;

use std::ffi::c_void;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::slice;

use saoms_abi::{Bytes, FindingSink, ImplementationTable, PluginTable, PropertyView, Sink, Status};

use component::Component;

/// The metadata, in the section of the library that is read before anything in it runs.
const METADATA: &[u8] = concat!(
    r#"{"saoms": "plugin", "abi": 3, "package": "saoms-python", "version": ""#,
    env!("CARGO_PKG_VERSION"),
    r#"", "panic": "unwind", "entry": "saoms_python_plugin", "implementations": ["python"]}"#
)
.as_bytes();

/// The same as a value of its own, which the section has in full.
#[used]
#[unsafe(link_section = ".saoms.plugin")]
static SECTION: [u8; METADATA.len()] = {
    let mut bytes = [0; METADATA.len()];
    let mut at = 0;
    while at < bytes.len() {
        bytes[at] = METADATA[at];
        at += 1;
    }
    bytes
};

static IMPLEMENTATION: ImplementationTable =
    ImplementationTable { size: size_of::<ImplementationTable>(), declare, construct, component: &component::TABLE };

static TABLE: PluginTable = PluginTable::new(METADATA, &[], &[], &[]).with_implementations(&IMPLEMENTATION);

/// The entry of the library.
#[unsafe(no_mangle)]
pub extern "C" fn saoms_python_plugin(_version: u32) -> *const PluginTable {
    &raw const TABLE
}

/// Runs a function for the program: neither a panic nor an error leaves it.
fn guarded(error: Sink, call: impl FnOnce() -> Result<Status, String>) -> Status {
    let (status, text) = match catch_unwind(AssertUnwindSafe(call)) {
        Ok(Ok(status)) => return status,
        Ok(Err(text)) => (Status::FAILED, text),
        Err(panic) => {
            let text = panic.downcast_ref::<&str>().map(ToString::to_string);
            let text = text.or_else(|| panic.downcast_ref::<String>().cloned());
            (Status::PANICKED, text.unwrap_or_else(|| "a panic without a text".to_owned()))
        }
    };
    // SAFETY: the caller waits for this call, which it lent the sink.
    unsafe { error.put(text.as_bytes()) };
    status
}

/// The text of lent bytes.
///
/// # Safety
/// As [`Bytes::get_text`].
unsafe fn text<'a>(bytes: Bytes) -> Result<&'a str, String> {
    // SAFETY: as the caller promises.
    unsafe { bytes.get_text() }.map_err(|error| error.to_string())
}

unsafe extern "C" fn declare(request: Bytes, answer: Sink, error: Sink) -> Status {
    guarded(error, || {
        // SAFETY: the request is lent to this call.
        let request = unsafe { text(request) }?;
        let declared = interpreter::with(|python| {
            let answer = python.call_bridge("declare", vec![python.text(request)])?;
            let text = python.read_text(answer.0);
            python.free(answer);
            text
        })?;
        // SAFETY: the caller waits for this call, which it lent the sink.
        unsafe { answer.put(declared.as_bytes()) };
        Ok(Status::OK)
    })
}

unsafe extern "C" fn construct(
    request: Bytes,
    values: *const PropertyView,
    value_count: usize,
    made: *mut *mut c_void,
    _findings: FindingSink,
    error: Sink,
) -> Status {
    guarded(error, || {
        // SAFETY: request and values are lent to this call.
        let (request, values) = unsafe { (text(request)?, values_as_json(values, value_count)?) };
        let component = Box::new(Component::new(request.to_owned(), values));
        // SAFETY: the caller lends a place for the component.
        unsafe { made.write(Box::into_raw(component).cast()) };
        Ok(Status::OK)
    })
}

/// Values as JSON: texts by their names, lists of such, or nested values.
///
/// # Safety
/// They are lent for the time of the call.
unsafe fn values_as_json(values: *const PropertyView, count: usize) -> Result<String, String> {
    /// # Safety
    /// As that of the outer function.
    unsafe fn read(
        views: *const PropertyView,
        count: usize,
    ) -> Result<serde_json::Map<String, serde_json::Value>, String> {
        let views = if count == 0 {
            &[]
        } else {
            // SAFETY: as the caller promises.
            unsafe { slice::from_raw_parts(views, count) }
        };
        let mut all = serde_json::Map::new();
        for view in views {
            // SAFETY: as the caller promises.
            unsafe { all.insert(text(view.name)?.to_owned(), one(view)?) };
        }
        Ok(all)
    }

    /// # Safety
    /// As that of the outer function.
    unsafe fn one(view: &PropertyView) -> Result<serde_json::Value, String> {
        // SAFETY: as the caller promises.
        unsafe {
            Ok(match view.kind {
                0 => text(view.text)?.into(),
                1 if view.child_count == 0 => serde_json::Value::Array(Vec::new()),
                1 => {
                    let children = slice::from_raw_parts(view.children, view.child_count);
                    children.iter().map(|child| one(child)).collect::<Result<_, _>>()?
                }
                _ => read(view.children, view.child_count)?.into(),
            })
        }
    }

    // SAFETY: as the caller promises.
    let values = unsafe { read(values, count) }?;
    Ok(serde_json::Value::Object(values).to_string())
}
