use std::ops::Range;

use saoms_abi::{Bytes, FindingSink, FindingView, LabelView, PlaceView, list};

use crate::boundary::null::given;
use crate::host::contain::contained;
use crate::rule::Severity;
use crate::{Failure, Finding, Place};

/// Greatest number of findings of one call.
const MOST_FINDINGS: usize = 10_000;

/// Findings of the other side of the boundary; for one that cannot be read, the error.
pub type Findings = Vec<Result<Finding, Failure>>;

/// Gives findings to the other side.
///
/// # Safety
/// The sink's owner waits for this call.
pub(in crate::boundary) unsafe fn put_findings(sink: FindingSink, findings: &[Finding]) {
    for finding in findings {
        let helps: Vec<Bytes> = finding.helps().iter().map(|help| Bytes::text(help)).collect();
        let labels: Vec<LabelView> = finding
            .labels()
            .iter()
            .map(|(place, text)| LabelView { place: place_view(place), text: Bytes::text(text) })
            .collect();
        let view = FindingView {
            place: place_view(finding.place()),
            message: Bytes::text(finding.message()),
            helps: helps.as_ptr(),
            help_count: helps.len(),
            instead: finding.replacement().map_or(Bytes::NONE, Bytes::text),
            labels: labels.as_ptr(),
            label_count: labels.len(),
            severity: finding.own_severity().map_or(0, |severity| severity as u32 + 1),
        };
        // SAFETY: as the caller promises; the view is lent to the call.
        unsafe { (sink.put)(sink.state, &raw const view) }
    }
}

/// Adds what the other side puts to findings.
///
/// # Safety
/// The view and what it leads to are readable.
pub(in crate::boundary) unsafe fn take_finding(findings: &mut Findings, view: *const FindingView) {
    if findings.len() >= MOST_FINDINGS {
        findings.truncate(MOST_FINDINGS);
        let text = format!("found more than {MOST_FINDINGS} faults: the others are not shown");
        return findings.push(Ok(Finding::new(Place::default(), text)));
    }
    // SAFETY: as the caller promises.
    findings.push(contained(|| unsafe { read_finding(given(view, "a finding")?) }).and_then(|read| read));
}

fn place_view(place: &Place) -> PlaceView {
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
unsafe fn read_place(view: &PlaceView) -> Result<Place, Failure> {
    let mut place = Place::default();
    if !view.property.data.is_null() {
        // SAFETY: as the caller promises.
        place = Place::property(unsafe { view.property.get_text() }?);
    }
    if view.has_part != 0 {
        place = place.part(view.value, view.start..view.end);
    }
    if view.component != usize::MAX {
        place = place.in_component(view.component);
    }
    Ok(place)
}

/// # Safety
/// The view and what it leads to are readable.
unsafe fn read_finding(view: &FindingView) -> Result<Finding, Failure> {
    // SAFETY: as the caller promises.
    unsafe {
        let mut finding = Finding::new(read_place(&view.place)?, view.message.get_text()?);
        for help in list(view.helps, view.help_count)? {
            finding = finding.help(help.get_text()?);
        }
        if !view.instead.data.is_null() {
            finding = finding.instead(view.instead.get_text()?);
        }
        for label in list(view.labels, view.label_count)? {
            finding = finding.label(read_place(&label.place)?, label.text.get_text()?);
        }
        Ok(match view.severity {
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
