use core::ffi::c_void;

use crate::Bytes;

/// A place in a composite: a component, a property of it, or a part of the property's text.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct PlaceView {
    /// The place of the component in its fleet; `SIZE_MAX`: the one that says so.
    pub component: usize,
    /// The property; null: the component itself.
    pub property: Bytes,
    /// 1: these bytes of this value of the property, which counts from 0; 0: all of it.
    pub has_part: u32,
    /// The number of the value.
    pub value: usize,
    /// The first byte.
    pub start: usize,
    /// The first byte behind it.
    pub end: usize,
}

/// A further place that explains a finding.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct LabelView {
    /// Its place.
    pub place: PlaceView,
    /// The explanation.
    pub text: Bytes,
}

/// A fault in a composite, found by a class or a rule.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct FindingView {
    /// Its place.
    pub place: PlaceView,
    /// The message: what was found, and what was expected.
    pub message: Bytes,
    /// Lines of help.
    pub helps: *const Bytes,
    /// Their number.
    pub help_count: usize,
    /// The text that is probably meant in place of the part; null: none.
    pub instead: Bytes,
    /// Further places.
    pub labels: *const LabelView,
    /// Their number.
    pub label_count: usize,
    /// 0: as the rule's code says, 1: a note, 2: a warning, 3: an error.
    pub severity: u32,
}

/// The receiver of findings that a callee gives back. They are copied at once.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct FindingSink {
    /// The caller's own; the first argument of `put`.
    pub state: *mut c_void,
    /// Takes a finding.
    pub put: unsafe extern "C" fn(state: *mut c_void, finding: *const FindingView),
}
