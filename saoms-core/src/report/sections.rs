use std::collections::{BTreeMap, BTreeSet, HashMap};

use saoms_api::ReportValue;
use saoms_api::extension::RunSummary;
use serde_json::{Map, Value};

/// The parts of a report that components contribute: values and counts under dotted paths such as `map.blocks`.
#[derive(Clone, Debug)]
pub struct Sections {
    entries: BTreeMap<String, Entry>,
    /// The paths that changed since they were asked for, where somebody asks.
    changed: Option<BTreeSet<String>>,
    /// Where somebody asks, what components have counted in the code that they ran last, by their numbers.
    in_code: HashMap<u32, CountsInCode>,
}

/// What code of a component has counted.
#[derive(Clone, Debug, Default)]
struct CountsInCode {
    /// The number of that code, for this component.
    code: u64,
    counts: Vec<(String, i64)>,
}

/// What stands at a path, for the next program.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct PartOfReport {
    /// True if it was counted.
    pub(crate) is_count: bool,
    pub(crate) value: Value,
}

#[derive(Clone, Debug)]
enum Entry {
    Count(i64),
    Value(ReportValue),
}

/// The fields of a report that are not for components to write.
const RESERVED: [&str; 12] = [
    "seed", "time_s", "periods", "components", "journal", "adaptation", "votes", "standstill", "outcome", "trace_hash",
    "part", "nodes",
];

/// Greatest number of parts of a path: nested objects are written and read one within the other.
const DEEPEST: usize = 64;

/// Greatest length of a path in bytes, and greatest number of paths: a hundred for each of 10,000 robots.
const LONGEST: usize = 1000;
const MOST: usize = 1_000_000;

impl Sections {
    /// True if a path has too many parts.
    pub fn is_too_deep(path: &str) -> bool {
        path.split('.').nth(DEEPEST).is_some()
    }

    /// True if a path would write over what the program itself reports.
    pub fn is_reserved(path: &str) -> bool {
        RESERVED.contains(&path.split_once('.').map_or(path, |(first, _)| first))
    }

    /// The counts that every report has, all at zero.
    pub fn with_registered_counts() -> Sections {
        let counts = RunSummary::linked().into_iter().flat_map(|summary| summary.counts);
        let entries = counts.map(|path| ((*path).to_owned(), Entry::Count(0))).collect();
        Sections { entries, changed: None, in_code: HashMap::new() }
    }

    /// Notes from now on what changes.
    pub(crate) fn note_changes(&mut self) {
        self.changed = Some(BTreeSet::new());
    }

    /// What changed since this was asked last, without what code has counted that still runs, by the number of its
    /// component and its own: it counts as not begun.
    pub(crate) fn take_changed(&mut self, runs: impl Fn(u32, u64) -> bool) -> Vec<(String, PartOfReport)> {
        let Some(changed) = &mut self.changed else { return Vec::new() };
        self.in_code.retain(|component, in_code| runs(*component, in_code.code));
        let mut too_early: BTreeMap<&str, i64> = BTreeMap::new();
        for (path, more) in self.in_code.values().flat_map(|in_code| &in_code.counts) {
            *too_early.entry(path).or_default() += more;
        }
        // These are asked for again: they change once the code has returned.
        let again = too_early.keys().map(|path| (*path).to_owned()).collect();
        let changed = std::mem::replace(changed, again);
        let part = |path: String| {
            let more = too_early.get(path.as_str()).copied().unwrap_or_default();
            let part = match self.entries.get(&path)? {
                Entry::Count(count) => PartOfReport { is_count: true, value: count.saturating_sub(more).into() },
                Entry::Value(value) => PartOfReport { is_count: false, value: json(value) },
            };
            Some((path, part))
        };
        changed.into_iter().filter_map(part).collect()
    }

    /// Adds to a count for code of a component that still runs; see [`add`](Sections::add).
    pub(crate) fn add_in_code(&mut self, path: &str, more: i64, (component, code): (u32, u64)) -> bool {
        let has_room = self.add(path, more);
        if has_room && self.changed.is_some() {
            let in_code = self.in_code.entry(component).or_default();
            if in_code.code != code {
                *in_code = CountsInCode { code, counts: Vec::new() };
            }
            match in_code.counts.iter_mut().find(|(known, _)| known == path) {
                Some((_, count)) => *count = count.saturating_add(more),
                None => in_code.counts.push((path.to_owned(), more)),
            }
        }
        has_room
    }

    /// Forgets what code of a component has counted that still runs: it is taken back.
    pub(crate) fn forget_in_code(&mut self, component: u32) {
        self.in_code.remove(&component);
    }

    /// Puts back what an earlier program had.
    pub(crate) fn recall(&mut self, path: String, part: PartOfReport) {
        let entry = match part.value.as_i64().filter(|_| part.is_count) {
            Some(count) => Entry::Count(count),
            None => Entry::Value(value_of(part.value)),
        };
        self.entries.insert(path, entry);
    }

    fn note(&mut self, path: &str) {
        if let Some(changed) = &mut self.changed
            && !changed.contains(path)
        {
            changed.insert(path.to_owned());
        }
    }

    /// Sets a value; the last one counts. False if the report has no room for it.
    #[must_use = "what is left out is told"]
    pub fn set(&mut self, path: &str, value: ReportValue) -> bool {
        self.note(path);
        match self.entries.get_mut(path) {
            Some(entry) => {
                *entry = Entry::Value(value);
                true
            }
            None => self.insert(path, Entry::Value(value)),
        }
    }

    fn insert(&mut self, path: &str, entry: Entry) -> bool {
        let has_room = path.len() <= LONGEST && self.entries.len() < MOST;
        if has_room {
            self.entries.insert(path.to_owned(), entry);
        }
        has_room
    }

    /// Adds to a count. A whole number that was [`set`](Sections::set) is counted on from; any other value gives way to
    /// the count. False if the report has no room for it.
    pub fn add(&mut self, path: &str, more: i64) -> bool {
        self.note(path);
        let Some(entry) = self.entries.get_mut(path) else { return self.insert(path, Entry::Count(more)) };
        let before = match entry {
            Entry::Count(count) | Entry::Value(ReportValue::Integer(count)) => *count,
            Entry::Value(_) => 0,
        };
        *entry = Entry::Count(before.saturating_add(more));
        true
    }

    /// The whole number at a path, if there is one.
    pub fn integer(&self, path: &str) -> Option<i64> {
        match self.entries.get(path)? {
            Entry::Count(count) | Entry::Value(ReportValue::Integer(count)) => Some(*count),
            Entry::Value(_) => None,
        }
    }

    /// The paths with a number, with that.
    pub(crate) fn numbers(&self) -> impl Iterator<Item = (&str, f64)> {
        self.entries.iter().filter_map(|(path, entry)| match entry {
            Entry::Count(count) | Entry::Value(ReportValue::Integer(count)) => Some((path.as_str(), *count as f64)),
            Entry::Value(ReportValue::Float(value)) => Some((path.as_str(), *value)),
            Entry::Value(_) => None,
        })
    }

    /// All sections as nested objects. If a path has both a value and paths below it, the value stands beside those as
    /// `value`.
    pub fn to_json(&self) -> Map<String, Value> {
        let mut root = Map::new();
        for (path, entry) in &self.entries {
            let value = match entry {
                Entry::Count(count) => Value::from(*count),
                Entry::Value(value) => json(value),
            };
            insert(&mut root, path, value);
        }
        root
    }
}

fn insert(object: &mut Map<String, Value>, path: &str, value: Value) {
    let Some((first, rest)) = path.split_once('.') else {
        match object.get_mut(path) {
            Some(Value::Object(inner)) => inner.insert("value".to_owned(), value),
            _ => object.insert(path.to_owned(), value),
        };
        return;
    };
    let inner = object.entry(first).or_insert_with(|| Value::Object(Map::new()));
    if !inner.is_object() {
        let plain = inner.take();
        *inner = Value::Object(Map::from_iter([("value".to_owned(), plain)]));
    }
    if let Value::Object(inner) = inner {
        insert(inner, rest, value);
    }
}

/// The value of a JSON, as [`json`] makes it.
fn value_of(value: Value) -> ReportValue {
    match value {
        Value::Null => ReportValue::Null,
        Value::Bool(value) => ReportValue::Bool(value),
        Value::Number(number) => match number.as_i64() {
            Some(value) => ReportValue::Integer(value),
            None => ReportValue::Float(number.as_f64().unwrap_or(f64::NAN)),
        },
        Value::String(text) => ReportValue::Text(text),
        Value::Array(values) => ReportValue::List(values.into_iter().map(value_of).collect()),
        Value::Object(fields) => {
            ReportValue::Map(fields.into_iter().map(|(name, value)| (name, value_of(value))).collect())
        }
    }
}

/// The value as JSON.
pub(crate) fn json(value: &ReportValue) -> Value {
    match value {
        ReportValue::Null => Value::Null,
        ReportValue::Bool(value) => Value::from(*value),
        ReportValue::Integer(value) => Value::from(*value),
        ReportValue::Float(value) => Value::from(*value),
        ReportValue::Text(value) => Value::from(value.as_str()),
        ReportValue::List(values) => values.iter().map(json).collect(),
        ReportValue::Map(values) => {
            Value::Object(values.iter().map(|(name, value)| (name.clone(), json(value))).collect())
        }
    }
}
