use crate::{Failure, ReportValue};

use super::Bytes;
use super::data::list;

/// How many values may lie in one another.
const DEEPEST: usize = 64;

/// A value for the run's report.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct ReportView {
    /// Its name within `children` of kind 6.
    pub name: Bytes,
    /// 0: null, 1: false or true (`bits`), 2: a whole number (`bits`), 3: a number (`bits` of its IEEE 754 form), 4: the `text`, 5: the list
    /// of `children`, 6: the named `children`.
    pub kind: u32,
    /// A number.
    pub bits: u64,
    /// A text.
    pub text: Bytes,
    /// What it consists of.
    pub children: *const ReportView,
    /// How many those are.
    pub child_count: usize,
}

impl ReportView {
    /// # Safety
    /// The view and what it leads to are readable.
    pub(super) unsafe fn read(&self) -> Result<ReportValue, Failure> {
        // SAFETY: as the caller promises.
        unsafe { self.read_at(0) }
    }

    /// # Safety
    /// As [`read`](ReportView::read).
    unsafe fn read_at(&self, depth: usize) -> Result<ReportValue, Failure> {
        if depth > DEEPEST {
            return Err(Failure::new(format!("found values in values, more than {DEEPEST} deep")));
        }
        let children = || -> Result<Vec<(String, ReportValue)>, Failure> {
            // SAFETY: as the caller promises.
            let children = unsafe { list(self.children, self.child_count) }?;
            let read = |child: &ReportView| {
                // SAFETY: as the caller promises.
                unsafe { Ok((child.name.get_text()?.to_owned(), child.read_at(depth + 1)?)) }
            };
            children.iter().map(read).collect()
        };
        Ok(match self.kind {
            0 => ReportValue::Null,
            1 => ReportValue::Bool(self.bits != 0),
            2 => ReportValue::Integer(self.bits as i64),
            3 => ReportValue::Float(f64::from_bits(self.bits)),
            // SAFETY: as the caller promises.
            4 => ReportValue::Text(unsafe { self.text.get_text() }?.to_owned()),
            5 => ReportValue::List(children()?.into_iter().map(|(_, value)| value).collect()),
            6 => ReportValue::Map(children()?),
            other => {
                return Err(Failure::new(format!("found {other} for the kind of a value, expected 0 to 6")));
            }
        })
    }
}

/// Shows a value for the report to code.
pub(super) fn with_view(name: &str, value: &ReportValue, code: &mut dyn FnMut(&ReportView)) {
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

/// Shows the views of several values to code. The views of one lie on the stack while the next is made, so that all stay readable.
fn collect(
    values: &[(&str, &ReportValue)],
    views: &mut Vec<ReportView>,
    code: &mut dyn FnMut(&[ReportView]),
) {
    match values {
        [] => code(views),
        [(name, value), rest @ ..] => with_view(name, value, &mut |view| {
            views.push(*view);
            collect(rest, views, code);
            views.pop();
        }),
    }
}
