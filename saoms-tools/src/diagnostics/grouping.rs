//! Diagnostics that say the same of many places: for people one of them is shown, with the number and the places of the
//! others.

use std::collections::HashMap;
use std::hash::{BuildHasher, BuildHasherDefault, DefaultHasher};

use saoms_lang::diagnostic::{Diagnostic, Severity};
use saoms_lang::source::{FileId, Sources};

/// Fewer that are alike are shown one by one.
const MANY: usize = 5;
/// The number of their lines that are named.
const NAMED: usize = 10;

/// The diagnostics to show, each with how many more are like it and where. Alike are those of one code and severity in
/// one file whose messages differ in numbers alone, as those of robots that are written out one by one do.
pub(super) fn grouped<'d>(
    diagnostics: Vec<&'d Diagnostic>,
    sources: &Sources,
) -> Vec<(&'d Diagnostic, Option<String>)> {
    let kinds: Vec<Kind> = diagnostics.iter().map(|one| kind(one)).collect();
    let mut counts: HashMap<&Kind, usize> = HashMap::new();
    for kind in &kinds {
        *counts.entry(kind).or_default() += 1;
    }
    let is_many = |kind: &&Kind| counts.get(kind).is_some_and(|count| *count >= MANY);
    let mut many: HashMap<&Kind, Vec<&Diagnostic>> = HashMap::new();
    for (kind, one) in kinds.iter().zip(&diagnostics).filter(|(kind, _)| is_many(kind)) {
        many.entry(kind).or_default().push(one);
    }
    let shown = kinds.iter().zip(&diagnostics).filter_map(|(kind, one)| match many.get(kind).map(Vec::as_slice) {
        None => Some((*one, None)),
        Some([first, rest @ ..]) => std::ptr::eq(*first, *one).then(|| (*one, Some(others(rest, sources)))),
        Some([]) => None,
    });
    shown.collect()
}

/// For each diagnostic the place of the first that it is like, where it is not shown itself.
pub(super) fn like_earlier(diagnostics: &[Diagnostic]) -> Vec<Option<usize>> {
    let kinds: Vec<Kind> = diagnostics.iter().map(kind).collect();
    let mut known: HashMap<&Kind, (usize, usize)> = HashMap::new();
    for (place, (kind, _)) in kinds.iter().zip(diagnostics).enumerate().filter(|(_, (_, one))| !one.is_allowed()) {
        known.entry(kind).or_insert((place, 0)).1 += 1;
    }
    let like = |(place, kind): (usize, &Kind)| {
        let (first, count) = *known.get(kind)?;
        (count >= MANY && place > first && !diagnostics[place].is_allowed()).then_some(first)
    };
    kinds.iter().enumerate().map(like).collect()
}

/// The key of diagnostics that are alike: code, severity, file, and the message but for its numbers, as a hash, since
/// there may be very many.
type Kind = (&'static str, Severity, FileId, u64);

fn kind(one: &Diagnostic) -> Kind {
    let shape = BuildHasherDefault::<DefaultHasher>::default().hash_one(shape(&one.message));
    (one.code.id, one.severity, one.location.file, shape)
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

/// The number of the others, and their lines.
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
