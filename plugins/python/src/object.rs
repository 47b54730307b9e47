//! Objects of Python that are owned.

use std::ffi::CString;
use std::ptr;

use crate::symbols::{Raw, Symbols};

/// An object of Python that is owned, and freed by whoever holds the lock.
#[derive(Debug)]
pub(crate) struct Object(pub(crate) Raw);

// SAFETY: an object is used with the lock of the interpreter alone, from whatever thread.
unsafe impl Send for Object {}

/// The interpreter, while its lock is held by this thread.
#[derive(Clone, Copy)]
pub(crate) struct Python<'a> {
    pub(crate) symbols: &'a Symbols,
    pub(crate) bridge: Raw,
    pub(crate) none: Raw,
}

impl Python<'_> {
    /// An owned object of the result of a function; an error of Python where that is null.
    pub(crate) fn own(&self, raw: Raw) -> Result<Object, String> {
        if raw.is_null() { Err(self.error()) } else { Ok(Object(raw)) }
    }

    pub(crate) fn free(&self, object: Object) {
        // SAFETY: the lock is held, and the object is owned.
        unsafe { (self.symbols.Py_DecRef)(object.0) }
    }

    pub(crate) fn text(&self, text: &str) -> Object {
        // SAFETY: the lock is held; so many bytes are there, which are UTF-8.
        Object(unsafe { (self.symbols.PyUnicode_FromStringAndSize)(text.as_ptr().cast(), text.len() as isize) })
    }

    pub(crate) fn bytes(&self, bytes: &[u8]) -> Object {
        // SAFETY: the lock is held; so many bytes are there.
        Object(unsafe { (self.symbols.PyBytes_FromStringAndSize)(bytes.as_ptr().cast(), bytes.len() as isize) })
    }

    pub(crate) fn number(&self, number: u64) -> Object {
        // SAFETY: the lock is held.
        Object(unsafe { (self.symbols.PyLong_FromUnsignedLongLong)(number) })
    }

    pub(crate) fn nothing(&self) -> Object {
        // SAFETY: the lock is held, and the object lives as long as the interpreter.
        unsafe { (self.symbols.Py_IncRef)(self.none) };
        Object(self.none)
    }

    pub(crate) fn tuple(&self, all: impl IntoIterator<Item = Object, IntoIter: ExactSizeIterator>) -> Object {
        let all = all.into_iter();
        // SAFETY: the lock is held; each place is set once, by an object that is given away.
        unsafe {
            let tuple = (self.symbols.PyTuple_New)(all.len() as isize);
            for (place, one) in all.enumerate() {
                (self.symbols.PyTuple_SetItem)(tuple, place as isize, one.0);
            }
            Object(tuple)
        }
    }

    pub(crate) fn list(&self, all: impl IntoIterator<Item = Object, IntoIter: ExactSizeIterator>) -> Object {
        let all = all.into_iter();
        // SAFETY: as in `tuple`.
        unsafe {
            let list = (self.symbols.PyList_New)(all.len() as isize);
            for (place, one) in all.enumerate() {
                (self.symbols.PyList_SetItem)(list, place as isize, one.0);
            }
            Object(list)
        }
    }

    /// The attribute of this name.
    pub(crate) fn attribute(&self, of: Raw, name: &str) -> Result<Object, String> {
        let name = CString::new(name).map_err(|error| error.to_string())?;
        // SAFETY: the lock is held; the name ends with zero.
        self.own(unsafe { (self.symbols.PyObject_GetAttrString)(of, name.as_ptr()) })
    }

    /// Calls an object with these arguments, which are given away.
    pub(crate) fn call(&self, function: Raw, arguments: Vec<Object>) -> Result<Object, String> {
        if arguments.is_empty() {
            // SAFETY: the lock is held; null are no arguments.
            return self.own(unsafe { (self.symbols.PyObject_CallObject)(function, ptr::null_mut()) });
        }
        let tuple = self.tuple(arguments);
        // SAFETY: the lock is held.
        let result = unsafe { (self.symbols.PyObject_CallObject)(function, tuple.0) };
        self.free(tuple);
        self.own(result)
    }

    /// Calls a function of the bridge.
    pub(crate) fn call_bridge(&self, name: &str, arguments: Vec<Object>) -> Result<Object, String> {
        let function = self.attribute(self.bridge, name)?;
        let result = self.call(function.0, arguments);
        self.free(function);
        result
    }

    /// The bytes of an object that is `bytes`, copied.
    pub(crate) fn read_bytes(&self, object: Raw) -> Result<Vec<u8>, String> {
        let (mut data, mut length) = (ptr::null_mut(), 0);
        // SAFETY: the lock is held; the bytes are copied while the object is there.
        unsafe {
            if (self.symbols.PyBytes_AsStringAndSize)(object, &raw mut data, &raw mut length) != 0 {
                return Err(self.error());
            }
            Ok(std::slice::from_raw_parts(data.cast::<u8>(), length as usize).to_vec())
        }
    }

    /// The text of an object that is `str`.
    pub(crate) fn read_text(&self, object: Raw) -> Result<String, String> {
        // SAFETY: the lock is held.
        let bytes = self.own(unsafe { (self.symbols.PyUnicode_AsUTF8String)(object) })?;
        let read = self.read_bytes(bytes.0);
        self.free(bytes);
        String::from_utf8(read?).map_err(|error| error.to_string())
    }

    /// The error that Python has, taken from it.
    pub(crate) fn error(&self) -> String {
        let (mut kind, mut value, mut trace) = (ptr::null_mut(), ptr::null_mut(), ptr::null_mut());
        // SAFETY: the lock is held; what is fetched is owned.
        unsafe {
            (self.symbols.PyErr_Fetch)(&raw mut kind, &raw mut value, &raw mut trace);
            let about = if value.is_null() { kind } else { value };
            let text = match about.is_null() {
                true => None,
                false => Some((self.symbols.PyObject_Str)(about)).filter(|text| !text.is_null()),
            };
            let said = text.and_then(|text| {
                let said = self.read_text(text).ok();
                self.free(Object(text));
                said
            });
            (self.symbols.PyErr_Clear)();
            for one in [kind, value, trace] {
                if !one.is_null() {
                    self.free(Object(one));
                }
            }
            said.unwrap_or_else(|| "Python failed without a text".to_owned())
        }
    }
}
