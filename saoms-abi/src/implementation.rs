use core::ffi::c_void;

use crate::{Bytes, ComponentTable, FindingSink, PropertyView, Sink, Status};

/// The functions of a library that runs classes in the code of another language, which composites name by module and
/// class: `implementation.python`. Its metadata list these languages as `"implementations": ["python"]`.
///
/// A request is JSON: `{"kind": "python", "module": "counter", "class": "Counter", "folders": ["/site"]}`. The module
/// is looked for in these folders first.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct ImplementationTable {
    /// The size of this table in bytes.
    pub size: usize,
    /// Reads what the code of a class declares, and runs nothing of it. The answer is JSON:
    ///
    /// ```json
    /// {"declaration": {}, "file": "/site/counter.py", "installed": false,
    ///  "findings": [{"part": "class", "message": "...", "help": ["..."], "instead": ["..."]}]}
    /// ```
    ///
    /// The `declaration` is null where there are findings; the `part` of a finding is the attribute of the composite,
    /// `module` or `class`, for which the texts in `instead` are probably meant. `installed`, where the module was
    /// found in none of the folders, but where its language finds modules.
    pub declare: unsafe extern "C" fn(request: Bytes, answer: Sink, error: Sink) -> Status,
    /// As `construct` of a class. It runs none of the code that the request names: that begins when the component is
    /// initialized.
    pub construct: unsafe extern "C" fn(
        request: Bytes,
        values: *const PropertyView,
        value_count: usize,
        made: *mut *mut c_void,
        findings: FindingSink,
        error: Sink,
    ) -> Status,
    /// The functions of all its components.
    pub component: *const ComponentTable,
}

// SAFETY: what the pointer leads to is constant.
unsafe impl Sync for ImplementationTable {}
