//! The language of the task property `topicRename`.
//!
//! `OLD,new::OLD2,new2`: pairs separated by `::`, each pair the old name, a comma, the new name; blanks around names do
//! not count. A text without any comma is one pair, `OLD::new`. An empty text renames nothing.

use std::collections::HashMap;
use std::ops::Range;

use crate::limits::TEXT_FAULTS;
use saoms_api::PropertyField;
use saoms_api::host::PropertyValue;
use saoms_api::host::declaration::{PropertyKind, PropertyShape, Rule};

/// The new names of topics, as (declared name, name on the bus).
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct TopicRenames(pub Vec<(String, String)>);

impl TopicRenames {
    /// Those of a text: the pairs without fault.
    pub(crate) fn of(text: &str) -> Self {
        let pair = |pair: Pair<'_>| (pair.old.text.to_owned(), pair.new.text.to_owned());
        Self(read(text).0.into_iter().map(pair).collect())
    }

    /// The name on the bus of the topic that a class declares under this name.
    pub fn name<'a>(&'a self, declared: &'a str) -> &'a str {
        self.0.iter().find(|(old, _)| old == declared).map_or(declared, |(_, new)| new)
    }
}

impl PropertyField for TopicRenames {
    const TYPE: PropertyShape =
        PropertyShape { optional: true, ..PropertyShape::scalar(Rule::of(PropertyKind::String)) };

    /// The pairs without fault: the checker reports the others.
    fn from_value(value: &PropertyValue, _: &Rule<'_>) -> Result<Self, String> {
        value.as_text().map(|text| Self::of(text)).ok_or_else(|| "expected pairs of names".to_owned())
    }

    fn absent() -> Option<Self> {
        Some(Self::default())
    }

    fn to_value(&self) -> Option<PropertyValue> {
        let pairs: Vec<String> = self.0.iter().map(|(old, new)| format!("{old},{new}")).collect();
        (!pairs.is_empty()).then(|| PropertyValue::from(&*pairs.join("::")))
    }
}

/// A name in the text, and the bytes it is at.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Name<'a> {
    pub(crate) text: &'a str,
    pub(crate) at: Range<usize>,
}

/// A topic and the name that takes the place of its own.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Pair<'a> {
    pub(crate) old: Name<'a>,
    pub(crate) new: Name<'a>,
}

/// The fault of a text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct RenameFault {
    /// The bytes at fault.
    pub(crate) at: Range<usize>,
    /// The message.
    pub(crate) message: String,
    /// Another place that explains it, and what is there.
    pub(crate) other: Option<(Range<usize>, &'static str)>,
}

/// The pairs of `text`, and all that is wrong with it.
pub(crate) fn parse(text: &str) -> (Vec<Pair<'_>>, Vec<RenameFault>) {
    let (pairs, mut faults) = read(text);
    contradictions(&pairs, &mut faults);
    (pairs, faults)
}

/// The pairs of `text`, and what are none.
fn read(text: &str) -> (Vec<Pair<'_>>, Vec<RenameFault>) {
    let mut pairs = Vec::new();
    let mut faults = Vec::new();
    if text.trim().is_empty() {
        return (pairs, faults);
    }
    if text.contains(',') {
        for piece in split(text, 0..text.len(), "::") {
            pair(&split(text, piece.clone(), ","), &piece, text, &mut pairs, &mut faults);
        }
    } else {
        pair(&split(text, 0..text.len(), "::"), &(0..text.len()), text, &mut pairs, &mut faults);
    }
    (pairs, faults)
}

/// Pairs with other separators, as they are meant.
pub(crate) fn pairs_of(text: &str) -> Option<String> {
    let is_name = |name: &str| !name.is_empty() && !name.contains([':', ',', '=', '-', ';', '>', '<', '&', '|']);
    let pair = |pair: &str| {
        let (old, new) = [",", "->", "=", ":", ";"].iter().find_map(|separator| pair.split_once(separator))?;
        let (old, new) = (old.trim(), new.trim());
        (is_name(old) && is_name(new)).then(|| format!("{old},{new}"))
    };
    if let Some(meant) = pair(text).filter(|meant| meant != text) {
        return Some(meant);
    }
    let separator = [";", "|", ":"].into_iter().find(|separator| text.contains(separator))?;
    let all: Option<Vec<String>> = text.split(separator).map(|one| pair(one.trim())).collect();
    Some(all?.join("::"))
}

/// The pieces of `text[range]` between separators.
fn split(text: &str, range: Range<usize>, separator: &str) -> Vec<Range<usize>> {
    let base = range.start;
    let mut start = 0;
    let mut pieces = Vec::new();
    for (at, found) in text[range.clone()].match_indices(separator) {
        pieces.push(base + start..base + at);
        start = at + found.len();
    }
    pieces.push(base + start..range.end);
    pieces
}

fn pair<'a>(
    names: &[Range<usize>],
    whole: &Range<usize>,
    text: &'a str,
    pairs: &mut Vec<Pair<'a>>,
    faults: &mut Vec<RenameFault>,
) {
    let found: Vec<Name<'a>> = names.iter().map(|range| trimmed(text, range)).collect();
    let count = found.iter().filter(|name| !name.text.is_empty()).count();
    match &found[..] {
        [_, new] if count == 2 && new.text.strip_prefix('/').unwrap_or(new.text).split('/').any(str::is_empty) => {
            let message = format!("`{}` is not a topic name", new.text);
            faults.push(RenameFault { at: new.at.clone(), message, other: None });
        }
        [old, new] if count == 2 => pairs.push(Pair { old: old.clone(), new: new.clone() }),
        _ => {
            let piece = trimmed(text, whole);
            let message = match count {
                0 => "found no names, expected a pair `OLD,new`".to_owned(),
                1 => format!("found one name in `{}`, expected a pair `OLD,new`", piece.text),
                _ => format!("found {count} names, expected a pair `OLD,new`"),
            };
            faults.push(RenameFault { at: piece.at, message, other: None });
        }
    }
}

fn trimmed<'a>(text: &'a str, range: &Range<usize>) -> Name<'a> {
    let piece = &text[range.clone()];
    let start = range.start + piece.len() - piece.trim_start().len();
    let piece = piece.trim();
    if piece.is_empty() {
        return Name { text: "", at: range.clone() };
    }
    Name { text: piece, at: start..start + piece.len() }
}

/// Names renamed twice, chains, and names that are renamed to themselves.
fn contradictions(pairs: &[Pair<'_>], faults: &mut Vec<RenameFault>) {
    let mut first: HashMap<&str, &Pair<'_>> = HashMap::with_capacity(pairs.len());
    for pair in pairs {
        if faults.len() >= TEXT_FAULTS {
            return;
        }
        if let Some(earlier) = first.get(pair.old.text) {
            let message = format!("topic `{}` is renamed twice", pair.old.text);
            let other = Some((earlier.old.at.clone(), "first renamed here"));
            faults.push(RenameFault { at: pair.old.at.clone(), message, other });
        } else {
            first.insert(pair.old.text, pair);
        }
    }
    for pair in pairs {
        if faults.len() >= TEXT_FAULTS {
            return;
        }
        let Some(next) = first.get(pair.new.text) else { continue };
        let (old, new, last) = (pair.old.text, pair.new.text, next.new.text);
        let (message, other) = match old == new {
            true => (format!("topic `{old}` is renamed to its own name"), None),
            false => (
                format!("a chain: `{old}` is renamed to `{new}`, and `{new}` to `{last}`"),
                Some((next.old.at.clone(), "renamed again here")),
            ),
        };
        faults.push(RenameFault { at: pair.new.at.clone(), message, other });
    }
}
