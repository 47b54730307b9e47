//! The functions of Python's stable ABI that are used, found in the library of the interpreter when it is opened.

use std::ffi::{c_char, c_int, c_longlong, c_ulonglong, c_void};

use libloading::os::unix::Library;

/// An object of Python.
pub(crate) type Raw = *mut c_void;

/// A function of a module that gets its arguments as a tuple.
pub(crate) type Function = unsafe extern "C" fn(module: Raw, arguments: Raw) -> Raw;

/// `PyMethodDef`
#[repr(C)]
pub(crate) struct Method {
    pub(crate) name: *const c_char,
    pub(crate) function: Option<Function>,
    pub(crate) flags: c_int,
    pub(crate) doc: *const c_char,
}

macro_rules! symbols {
    ($($name:ident: fn($($argument:ty),*) $(-> $result:ty)?;)* -- $($data:ident;)*) => {
        /// The functions and objects by their names in C.
        #[expect(non_snake_case, reason = "names of C")]
        pub(crate) struct Symbols {
            $(pub(crate) $name: unsafe extern "C" fn($($argument),*) $(-> $result)?,)*
            $(pub(crate) $data: Raw,)*
        }

        impl Symbols {
            /// # Errors
            /// The first one that the library does not have.
            pub(crate) fn of(library: &Library) -> Result<Symbols, String> {
                // SAFETY: these are the types that the stable ABI of Python 3 gives them; the library is never closed.
                unsafe {
                    Ok(Symbols {
                        $($name: *library.get(stringify!($name).as_bytes()).map_err(|error| error.to_string())?,)*
                        $($data: *library.get::<Raw>(stringify!($data).as_bytes()).map_err(|error| error.to_string())?,)*
                    })
                }
            }
        }
    };
}

symbols! {
    Py_InitializeEx: fn(c_int);
    Py_IsInitialized: fn() -> c_int;
    PyEval_SaveThread: fn() -> *mut c_void;
    PyEval_RestoreThread: fn(*mut c_void);
    PyGILState_Ensure: fn() -> c_int;
    PyGILState_Release: fn(c_int);
    Py_CompileString: fn(*const c_char, *const c_char, c_int) -> Raw;
    PyEval_EvalCode: fn(Raw, Raw, Raw) -> Raw;
    PyImport_AddModule: fn(*const c_char) -> Raw;
    PyImport_ImportModule: fn(*const c_char) -> Raw;
    PyModule_GetDict: fn(Raw) -> Raw;
    PyDict_SetItemString: fn(Raw, *const c_char, Raw) -> c_int;
    PyObject_GetAttrString: fn(Raw, *const c_char) -> Raw;
    PyObject_CallObject: fn(Raw, Raw) -> Raw;
    PyObject_IsTrue: fn(Raw) -> c_int;
    PyObject_Str: fn(Raw) -> Raw;
    PyTuple_New: fn(isize) -> Raw;
    PyTuple_SetItem: fn(Raw, isize, Raw) -> c_int;
    PyTuple_GetItem: fn(Raw, isize) -> Raw;
    PyTuple_Size: fn(Raw) -> isize;
    PyList_New: fn(isize) -> Raw;
    PyList_SetItem: fn(Raw, isize, Raw) -> c_int;
    PyUnicode_FromStringAndSize: fn(*const c_char, isize) -> Raw;
    PyUnicode_AsUTF8String: fn(Raw) -> Raw;
    PyBytes_FromStringAndSize: fn(*const c_char, isize) -> Raw;
    PyBytes_AsStringAndSize: fn(Raw, *mut *mut c_char, *mut isize) -> c_int;
    PyLong_FromUnsignedLongLong: fn(c_ulonglong) -> Raw;
    PyLong_AsLongLong: fn(Raw) -> c_longlong;
    PyLong_AsUnsignedLongLong: fn(Raw) -> c_ulonglong;
    PyFloat_AsDouble: fn(Raw) -> f64;
    PyErr_Occurred: fn() -> Raw;
    PyErr_Clear: fn();
    PyErr_Fetch: fn(*mut Raw, *mut Raw, *mut Raw);
    PyErr_SetString: fn(Raw, *const c_char);
    PyCFunction_NewEx: fn(*mut Method, Raw, Raw) -> Raw;
    Py_IncRef: fn(Raw);
    Py_DecRef: fn(Raw);
    --
    PyExc_RuntimeError;
}
