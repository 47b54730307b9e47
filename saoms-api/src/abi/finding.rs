use std::ffi::c_void;
use std::ops::Range;

use crate::contain::contained;
use crate::{Failure, Finding, Place, Severity};

use super::Bytes;
use super::data::list;

/// A place in a composite: a component, a property of it, or a part of what the property's text says.
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
    /// Where.
    pub place: PlaceView,
    /// What is to be seen there.
    pub text: Bytes,
}

/// Something that is wrong with what a composite says.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct FindingView {
    /// Where.
    pub place: PlaceView,
    /// What was found, and what was expected.
    pub message: Bytes,
    /// Lines of help.
    pub helps: *const Bytes,
    /// How many there are.
    pub help_count: usize,
    /// What probably is meant in place of the part; null: nothing.
    pub instead: Bytes,
    /// Further places.
    pub labels: *const LabelView,
    /// How many there are.
    pub label_count: usize,
    /// 0: as the rule's code says, 1: a note, 2: a warning, 3: an error.
    pub severity: u32,
}

/// Where a callee puts findings for its caller. What is put is copied at once.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct FindingSink {
    /// What belongs to the caller.
    pub state: *mut c_void,
    /// Takes a finding.
    pub put: unsafe extern "C" fn(state: *mut c_void, finding: *const FindingView),
}

/// Findings of the other side; one that cannot be read is kept as what is wrong with it.
pub(super) type Findings = Vec<Result<Finding, Failure>>;

impl FindingSink {
    /// # Safety
    /// The sink's owner waits for this call.
    pub(super) unsafe fn put_all(self, findings: &[Finding]) {
        for finding in findings {
            let helps: Vec<Bytes> = finding.helps().iter().map(|help| Bytes::text(help)).collect();
            let labels: Vec<LabelView> = finding
                .labels()
                .iter()
                .map(|(place, text)| LabelView { place: PlaceView::of(place), text: Bytes::text(text) })
                .collect();
            let view = FindingView {
                place: PlaceView::of(finding.place()),
                message: Bytes::text(finding.message()),
                helps: helps.as_ptr(),
                help_count: helps.len(),
                instead: finding.replacement().map_or(Bytes::NONE, Bytes::text),
                labels: labels.as_ptr(),
                label_count: labels.len(),
                severity: finding.own_severity().map_or(0, |severity| severity as u32 + 1),
            };
            // SAFETY: as the caller promises; the view is lent to the call.
            unsafe { (self.put)(self.state, &raw const view) }
        }
    }
}

/// Adds what the other side puts to findings.
///
/// # Safety
/// The view and what it leads to are readable.
pub(super) unsafe fn take(findings: &mut Findings, view: *const FindingView) {
    // SAFETY: as the caller promises.
    findings.push(contained(|| unsafe { (*view).read() }).and_then(|read| read));
}

impl PlaceView {
    fn of(place: &Place) -> PlaceView {
        let (value, Range { start, end }) = place.value_part().unwrap_or_default();
        PlaceView {
            component: place.component_index().unwrap_or(usize::MAX),
            property: place.property_name().map_or(Bytes::NONE, Bytes::text),
            has_part: u32::from(place.value_part().is_some()),
            value,
            start,
            end,
        }
    }

    /// # Safety
    /// Its text is readable.
    unsafe fn read(&self) -> Result<Place, Failure> {
        let mut place = Place::default();
        if !self.property.data.is_null() {
            // SAFETY: as the caller promises.
            place = Place::property(unsafe { self.property.get_text() }?);
        }
        if self.has_part != 0 {
            place = place.part(self.value, self.start..self.end);
        }
        if self.component != usize::MAX {
            place = place.in_component(self.component);
        }
        Ok(place)
    }
}

impl FindingView {
    /// # Safety
    /// The view and what it leads to are readable.
    unsafe fn read(&self) -> Result<Finding, Failure> {
        // SAFETY: as the caller promises.
        unsafe {
            let mut finding = Finding::new(self.place.read()?, self.message.get_text()?);
            for help in list(self.helps, self.help_count)? {
                finding = finding.help(help.get_text()?);
            }
            if !self.instead.data.is_null() {
                finding = finding.instead(self.instead.get_text()?);
            }
            for label in list(self.labels, self.label_count)? {
                finding = finding.label(label.place.read()?, label.text.get_text()?);
            }
            Ok(match self.severity {
                0 => finding,
                1 => finding.severity(Severity::Note),
                2 => finding.severity(Severity::Warning),
                3 => finding.severity(Severity::Error),
                other => {
                    return Err(Failure::new(format!("found {other} for a severity, expected 0 to 3")));
                }
            })
        }
    }
}
