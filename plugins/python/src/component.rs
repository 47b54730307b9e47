//! Components of classes in Python, behind the table of the boundary.

use std::ffi::c_void;
use std::mem;

use saoms_abi::{Bytes, ComponentTable, HostHandle, PropertyView, Sink, Status};

use crate::functions::{lent, take_status};
use crate::interpreter::{give_up, with};
use crate::object::{Object, Python};
use crate::{guarded, text, values_as_json};

/// A component. Its object in Python is made when it is initialized: a constructor runs no code of the user.
#[derive(Debug)]
pub(crate) struct Component {
    request: String,
    values: String,
    made: Option<Made>,
    /// What it said of itself at last, as JSON.
    status: String,
}

#[derive(Debug)]
struct Made {
    runner: Object,
    execute: Object,
    react: Object,
}

impl Component {
    pub(crate) fn new(request: String, values: String) -> Component {
        Component { request, values, made: None, status: String::new() }
    }

    /// The object, made anew.
    fn make(&mut self, python: Python<'_>) -> Result<(), String> {
        self.give_up();
        let runner = python.call_bridge("create", vec![python.text(&self.request), python.text(&self.values)])?;
        let (execute, react) = (python.attribute(runner.0, "execute")?, python.attribute(runner.0, "react")?);
        self.made = Some(Made { runner, execute, react });
        Ok(())
    }

    fn give_up(&mut self) {
        if let Some(Made { runner, execute, react }) = self.made.take() {
            [runner, execute, react].into_iter().for_each(give_up);
        }
    }

    fn runner(&self) -> Result<&Made, String> {
        self.made.as_ref().ok_or_else(|| "the component was not initialized".to_owned())
    }
}

impl Drop for Component {
    fn drop(&mut self) {
        self.give_up();
    }
}

/// The outcome of a method of the runner: nothing, or status and text.
fn outcome(python: Python<'_>, result: Object, error: Sink) -> Result<Status, String> {
    let failed = if result.0 == python.none { None } else { Some(read_failure(python, &result)) };
    python.free(result);
    let Some(failed) = failed else { return Ok(Status::OK) };
    let (status, said) = failed?;
    // SAFETY: the caller waits for this call, which it lent the sink.
    unsafe { error.put(said.as_bytes()) };
    Ok(status)
}

fn read_failure(python: Python<'_>, result: &Object) -> Result<(Status, String), String> {
    // SAFETY: the lock is held; items are borrowed from the tuple.
    unsafe {
        let status = (python.symbols.PyTuple_GetItem)(result.0, 0);
        let said = (python.symbols.PyTuple_GetItem)(result.0, 1);
        if status.is_null() || said.is_null() {
            return Err(python.error());
        }
        let status = (python.symbols.PyLong_AsLongLong)(status);
        Ok((Status(u32::try_from(status).unwrap_or(1)), python.read_text(said)?))
    }
}

/// The component behind the pointer of the boundary.
///
/// # Safety
/// It is one that `construct` gave, and is used by this call alone.
unsafe fn component<'a>(component: *mut c_void) -> &'a mut Component {
    // SAFETY: as the caller promises.
    unsafe { &mut *component.cast::<Component>() }
}

/// Calls one of the methods without arguments.
///
/// # Safety
/// The pointers are those of a call across the boundary.
unsafe fn step(
    of: *mut c_void,
    host: *const HostHandle,
    error: Sink,
    method: impl FnOnce(&Made, Python<'_>) -> Result<Object, String>,
) -> Status {
    guarded(error, || {
        // SAFETY: as the caller promises.
        let component = unsafe { component(of) };
        let made = component.runner()?;
        let status = with(|python| {
            // SAFETY: the handle is lent to this call.
            let _lent = unsafe { lent(host) };
            outcome(python, method(made, python)?, error)
        })?;
        if let Some(status) = take_status() {
            component.status = status;
        }
        Ok(status)
    })
}

unsafe extern "C" fn initialize(of: *mut c_void, host: *const HostHandle, error: Sink) -> Status {
    guarded(error, || {
        // SAFETY: the pointer is that of a call across the boundary.
        let component = unsafe { component(of) };
        with(|python| {
            component.make(python)?;
            // SAFETY: the handle is lent to this call.
            let _lent = unsafe { lent(host) };
            let method = python.attribute(component.runner()?.runner.0, "initialize")?;
            let result = python.call(method.0, Vec::new());
            python.free(method);
            outcome(python, result?, error)
        })
    })
}

unsafe extern "C" fn execute(of: *mut c_void, host: *const HostHandle, error: Sink) -> Status {
    // SAFETY: the pointers are those of a call across the boundary.
    unsafe { step(of, host, error, |made, python| python.call(made.execute.0, Vec::new())) }
}

unsafe extern "C" fn react(of: *mut c_void, host: *const HostHandle, error: Sink) -> Status {
    // SAFETY: the pointers are those of a call across the boundary.
    unsafe { step(of, host, error, |made, python| python.call(made.react.0, Vec::new())) }
}

unsafe extern "C" fn shutdown(of: *mut c_void, host: *const HostHandle, error: Sink) -> Status {
    // SAFETY: the pointers are those of a call across the boundary.
    unsafe {
        step(of, host, error, |made, python| {
            let method = python.attribute(made.runner.0, "shutdown")?;
            let result = python.call(method.0, Vec::new());
            python.free(method);
            result
        })
    }
}

unsafe extern "C" fn serve(
    of: *mut c_void,
    host: *const HostHandle,
    service: Bytes,
    operation: u32,
    arguments: Bytes,
    reply: Sink,
    error: Sink,
) -> Status {
    guarded(error, || {
        // SAFETY: the pointers are those of a call across the boundary.
        let (component, service, arguments) =
            unsafe { (component(of), text(service)?, arguments.get().map_err(|error| error.to_string())?) };
        let made = component.runner()?;
        with(|python| {
            // SAFETY: the handle is lent to this call.
            let _lent = unsafe { lent(host) };
            let method = python.attribute(made.runner.0, "serve")?;
            let given = vec![python.text(service), python.number(u64::from(operation)), python.bytes(arguments)];
            let result = python.call(method.0, given);
            python.free(method);
            let result = result?;
            let (mut data, mut length) = (std::ptr::null_mut(), 0);
            // SAFETY: the lock is held, and the object is owned.
            let is_bytes =
                unsafe { (python.symbols.PyBytes_AsStringAndSize)(result.0, &raw mut data, &raw mut length) == 0 };
            if !is_bytes {
                // SAFETY: the lock is held; that it is no bytes is no error.
                unsafe { (python.symbols.PyErr_Clear)() };
                return outcome(python, result, error);
            }
            // SAFETY: the bytes are there while the object is; the caller waits for this call, which it lent the sink.
            unsafe { reply.put(std::slice::from_raw_parts(data.cast::<u8>(), length as usize)) };
            python.free(result);
            Ok(Status::OK)
        })
    })
}

unsafe extern "C" fn update(of: *mut c_void, values: *const PropertyView, count: usize, error: Sink) -> Status {
    guarded(error, || {
        // SAFETY: the pointers are those of a call across the boundary.
        let (component, values) = unsafe { (component(of), values_as_json(values, count)?) };
        let Some(made) = &component.made else {
            component.values = values;
            return Ok(Status::OK);
        };
        let status = with(|python| {
            let method = python.attribute(made.runner.0, "update")?;
            let result = python.call(method.0, vec![python.text(&values)]);
            python.free(method);
            outcome(python, result?, error)
        })?;
        if status == Status::OK {
            component.values = values;
        }
        Ok(status)
    })
}

/// What it said after its last executions: who asks does not wait for the lock of the interpreter.
unsafe extern "C" fn status(of: *mut c_void, values: Sink, error: Sink) -> Status {
    guarded(error, || {
        // SAFETY: the pointers are those of a call across the boundary.
        unsafe { values.put(component(of).status.as_bytes()) };
        Ok(Status::OK)
    })
}

unsafe extern "C" fn destroy(of: *mut c_void) {
    // SAFETY: `construct` gave it, and it is given back once.
    mem::drop(unsafe { Box::from_raw(of.cast::<Component>()) });
}

/// The functions of all components.
pub(crate) static TABLE: ComponentTable = ComponentTable {
    size: size_of::<ComponentTable>(),
    initialize,
    execute,
    shutdown,
    serve,
    destroy,
    save: None,
    restore: None,
    waits_for: None,
    react: Some(react),
    update: Some(update),
    status: Some(status),
};
