use saoms_abi::{Bytes, ReportView, list};

use crate::{Failure, ReportValue};

/// The greatest depth of values in one another.
const DEEPEST: usize = 64;

/// The value behind a view.
///
/// # Errors
/// A text cannot be read, a kind is unknown, or values lie too deep in one another.
///
/// # Safety
/// The view and what it leads to are readable.
pub(in crate::boundary) unsafe fn read_report(view: &ReportView) -> Result<ReportValue, Failure> {
    // SAFETY: as the caller promises.
    unsafe { read_at(view, 0) }
}

/// # Safety
/// As [`read_report`].
unsafe fn read_at(view: &ReportView, depth: usize) -> Result<ReportValue, Failure> {
    if depth > DEEPEST {
        return Err(Failure::new(format!("found values in values, more than {DEEPEST} deep")));
    }
    let children = || -> Result<Vec<(String, ReportValue)>, Failure> {
        // SAFETY: as the caller promises.
        let children = unsafe { list(view.children, view.child_count) }?;
        let read = |child: &ReportView| {
            // SAFETY: as the caller promises.
            unsafe { Ok((child.name.get_text()?.to_owned(), read_at(child, depth + 1)?)) }
        };
        children.iter().map(read).collect()
    };
    Ok(match view.kind {
        0 => ReportValue::Null,
        1 => ReportValue::Bool(view.bits != 0),
        2 => ReportValue::Integer(view.bits as i64),
        3 => ReportValue::Float(f64::from_bits(view.bits)),
        // SAFETY: as the caller promises.
        4 => ReportValue::Text(unsafe { view.text.get_text() }?.to_owned()),
        5 => ReportValue::List(children()?.into_iter().map(|(_, value)| value).collect()),
        6 => ReportValue::Map(children()?),
        other => {
            return Err(Failure::new(format!("found {other} for the kind of a value, expected 0 to 6")));
        }
    })
}

/// Shows a value for the report to code.
pub(in crate::boundary) fn with_report_view(name: &str, value: &ReportValue, code: &mut dyn FnMut(&ReportView)) {
    let scalar = |kind, bits, text: &str| ReportView {
        name: Bytes::text(name),
        kind,
        bits,
        text: Bytes::text(text),
        children: std::ptr::null(),
        child_count: 0,
    };
    let mut nested = |kind, children: &[(&str, &ReportValue)]| {
        collect(children, &mut Vec::new(), &mut |views| {
            code(&ReportView { children: views.as_ptr(), child_count: views.len(), ..scalar(kind, 0, "") });
        });
    };
    match value {
        ReportValue::Null => code(&scalar(0, 0, "")),
        ReportValue::Bool(value) => code(&scalar(1, u64::from(*value), "")),
        ReportValue::Integer(value) => code(&scalar(2, *value as u64, "")),
        ReportValue::Float(value) => code(&scalar(3, value.to_bits(), "")),
        ReportValue::Text(text) => code(&scalar(4, 0, text)),
        ReportValue::List(values) => nested(5, &values.iter().map(|value| ("", value)).collect::<Vec<_>>()),
        ReportValue::Map(values) => {
            nested(6, &values.iter().map(|(name, value)| (name.as_str(), value)).collect::<Vec<_>>());
        }
    }
}

/// Shows the views of several values to code. The views of one lie on the stack while the next is made, so that all
/// stay readable.
fn collect(values: &[(&str, &ReportValue)], views: &mut Vec<ReportView>, code: &mut dyn FnMut(&[ReportView])) {
    match values {
        [] => code(views),
        [(name, value), rest @ ..] => with_report_view(name, value, &mut |view| {
            views.push(*view);
            collect(rest, views, code);
            views.pop();
        }),
    }
}
