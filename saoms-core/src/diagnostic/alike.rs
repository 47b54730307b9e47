//! Diagnostics that say the same of many places: for people one of them is told, with how many more there are and where.

use std::collections::HashMap;

use super::Diagnostic;
use crate::source::Sources;

/// Fewer that are alike are shown one by one.
const MANY: usize = 5;
/// How many of their lines are named.
const NAMED: usize = 10;

/// The diagnostics to show, each with how many more are like it and where. Alike are those of one code and severity in one file whose messages differ
/// in numbers alone, as those of robots that are written out one by one do.
pub(super) fn told_together<'d>(
    diagnostics: &'d [Diagnostic],
    sources: &Sources,
) -> Vec<(&'d Diagnostic, Option<String>)> {
    let mut groups: HashMap<_, Vec<&Diagnostic>> = HashMap::new();
    let kind = |one: &Diagnostic| (one.code.id, one.severity, one.location.file, shape(&one.message));
    for one in diagnostics {
        groups.entry(kind(one)).or_default().push(one);
    }
    let mut shown = Vec::with_capacity(diagnostics.len());
    for one in diagnostics {
        match groups.get(&kind(one)).map_or(&[][..], Vec::as_slice) {
            alike @ [first, ..] if alike.len() >= MANY => {
                if std::ptr::eq(*first, one) {
                    shown.push((one, Some(others(&alike[1..], sources))));
                }
            }
            _ => shown.push((one, None)),
        }
    }
    shown
}

/// A message without the numbers in it.
fn shape(message: &str) -> String {
    let mut shape = String::with_capacity(message.len());
    for character in message.chars() {
        match character {
            '0'..='9' if shape.ends_with('0') => {}
            '0'..='9' => shape.push('0'),
            _ => shape.push(character),
        }
    }
    shape
}

/// How many others there are, and in which lines.
fn others(others: &[&Diagnostic], sources: &Sources) -> String {
    let line = |one: &&Diagnostic| sources.get(one.location.file).range(one.location.span).start.line;
    let mut lines: Vec<u32> = others.iter().map(line).collect();
    lines.sort_unstable();
    lines.dedup();
    let named: Vec<String> = lines.iter().take(NAMED).map(u32::to_string).collect();
    let count = others.len();
    match (&named[..], lines.len() - named.len()) {
        ([only], 0) => format!("and {count} more like it, in line {only}"),
        ([most @ .., last], 0) => {
            format!("and {count} more like it, in lines {} and {last}", most.join(", "))
        }
        (all, 1) => format!("and {count} more like it, in lines {} and another one", all.join(", ")),
        (all, more) => format!("and {count} more like it, in lines {} and {more} others", all.join(", ")),
    }
}
