//! The collection of diagnostics.

use std::collections::{BTreeMap, HashMap, HashSet};

use super::codes::{Nature, natures};
use super::{Code, Diagnostic, Severity, codes};
use crate::limits::{CODE_DIAGNOSTICS, FILE_DIAGNOSTICS};
use crate::source::{FileId, Location};

/// Collector of diagnostics.
///
/// At most 1,000 diagnostics of one code, and 2,000 in all, are kept for one file; all are counted, and
/// [`Diagnostics::into_sorted`] says how many more there were.
#[derive(Debug, Default)]
pub struct Diagnostics {
    items: Vec<Diagnostic>,
    counts: HashMap<(FileId, &'static str), Count>,
    /// The number of kept diagnostics of each file.
    kept: HashMap<FileId, u32>,
    errors: usize,
    warnings: usize,
    /// Stretches of files, each with its end, in which something may be missing because of a fault of the text; none
    /// overlaps another.
    damaged: BTreeMap<(FileId, u32), u32>,
    /// What faults of their texts hide in files.
    hidden: HashMap<FileId, HiddenNames>,
    /// The properties that elements of other namespaces would take in files, if they were of SCA, as is reported.
    meant: HashSet<(FileId, String)>,
}

/// The kinds of names that faults of texts may hide: one of them that is found nowhere may be there.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct HiddenNames {
    pub(crate) composites: bool,
    pub(crate) components: bool,
    pub(crate) others: bool,
}

impl HiddenNames {
    /// Any name.
    pub(crate) const ALL: Self = Self { composites: true, components: true, others: true };
}

#[derive(Debug)]
struct Count {
    code: &'static Code,
    number: u32,
    kept: u32,
    /// The place of the first one that was not kept.
    beyond: Option<Location>,
}

impl Diagnostics {
    /// None yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// Marks a stretch of a file with a fault of the text, which is reported. Nothing is concluded from what is missing
    /// in it, nor from unresolved names of the hidden kinds.
    pub(crate) fn add_damage(&mut self, stretch: Location, hidden: HiddenNames) {
        self.damaged.insert((stretch.file, stretch.span.start), stretch.span.end);
        let all = self.hidden.entry(stretch.file).or_default();
        all.composites |= hidden.composites;
        all.components |= hidden.components;
        all.others |= hidden.others;
    }

    /// Notes that an element that is ignored, which is reported, would take a property.
    pub(crate) fn add_meant(&mut self, file: FileId, property: &str) {
        self.meant.insert((file, property.to_owned()));
    }

    /// True if such an element would take this property.
    pub(crate) fn is_meant(&self, file: FileId, property: &str) -> bool {
        self.meant.contains(&(file, property.to_owned()))
    }

    /// The kinds of names that faults of its text may hide in a file.
    pub(crate) fn hidden_in(&self, file: FileId) -> HiddenNames {
        self.hidden.get(&file).copied().unwrap_or_default()
    }

    /// True if a diagnostic says only what comes of a fault of the text.
    fn is_follow_up(&self, code: &Code, at: Location) -> bool {
        let is_inside = || {
            let before = self.damaged.range(..=(at.file, at.span.start)).next_back();
            before.is_some_and(|((file, _), end)| *file == at.file && at.span.end <= *end)
        };
        let is_hidden = natures(code.id).into_iter().flatten().find_map(|nature| match nature {
            Nature::AbsentPart => Some(false),
            Nature::AbsentComposite => Some(self.hidden.values().any(|hidden| hidden.composites)),
            Nature::AbsentComponent => Some(self.hidden.values().any(|hidden| hidden.components)),
            Nature::AbsentName => Some(self.hidden.values().any(|hidden| hidden.others)),
            _ => None,
        });
        is_hidden.is_some_and(|is_hidden| is_hidden || is_inside())
    }

    /// Adds one, unless it says only that something is missing where a fault of the text is the reason.
    pub fn push(&mut self, diagnostic: Diagnostic) {
        let Diagnostic { code, severity, location, .. } = diagnostic;
        // A name that is nearly a known one is misspelt, whatever is missing around it.
        let is_misspelt = std::ptr::eq(code, &codes::UNKNOWN_PROPERTY) && !diagnostic.suggestions.is_empty();
        if !self.damaged.is_empty() && !is_misspelt && self.is_follow_up(code, location) {
            return;
        }
        if !self.skip(code, severity, location) {
            self.count(code, severity, location.file).kept += 1;
            *self.kept.entry(location.file).or_insert(0) += 1;
            self.items.push(diagnostic.shortened());
        }
    }

    /// True if a diagnostic of this code is one too many for its file; it is counted then, as if it had been pushed.
    /// Asked before a diagnostic is put together, where a file can have a million of them.
    pub fn skip(&mut self, code: &'static Code, severity: Severity, location: Location) -> bool {
        let is_full = self.is_full(code, location.file);
        if is_full {
            self.count(code, severity, location.file).beyond.get_or_insert(location);
        }
        is_full
    }

    /// True if no more diagnostics of this code are kept for a file.
    pub(crate) fn is_full(&self, code: &'static Code, file: FileId) -> bool {
        let kept = self.counts.get(&(file, code.id)).map_or(0, |count| count.kept);
        // The first of a kind is always kept.
        kept >= CODE_DIAGNOSTICS || kept > 0 && self.kept.get(&file).is_some_and(|kept| *kept >= FILE_DIAGNOSTICS)
    }

    fn count(&mut self, code: &'static Code, severity: Severity, file: FileId) -> &mut Count {
        self.recount(severity, 1, usize::saturating_add);
        let new = Count { code, number: 0, kept: 0, beyond: None };
        let count = self.counts.entry((file, code.id)).or_insert(new);
        count.number += 1;
        count
    }

    /// Lets severities be set: `set` changes the diagnostics from this place on. Those that are allowed count no more.
    pub(crate) fn adjust(&mut self, from: usize, mut set: impl FnMut(&mut Diagnostic)) {
        for at in from.min(self.items.len())..self.items.len() {
            let one = &mut self.items[at];
            let before = one.severity;
            set(one);
            let after = (!one.is_allowed()).then_some(one.severity);
            let (code, file) = (one.code.id, one.location.file);
            // Those that were not kept are as the last that was.
            let is_last = || !self.items[at + 1..].iter().any(|one| one.code.id == code && one.location.file == file);
            let beyond = self.counts.get(&(file, code)).map_or(0, |count| count.number - count.kept);
            let number = if beyond > 0 && is_last() { 1 + beyond as usize } else { 1 };
            self.recount(before, number, usize::saturating_sub);
            if let Some(after) = after {
                self.recount(after, number, usize::saturating_add);
            }
        }
    }

    fn recount(&mut self, severity: Severity, number: usize, by: fn(usize, usize) -> usize) {
        match severity {
            Severity::Error => self.errors = by(self.errors, number),
            Severity::Warning => self.warnings = by(self.warnings, number),
            Severity::Note => {}
        }
    }

    /// Takes back those of a code at a place, where another one says it better.
    pub(crate) fn withdraw(&mut self, code: &'static Code, location: Location) {
        // Most that are withdrawn were never reported.
        if self.counts.get(&(location.file, code.id)).is_none_or(|count| count.kept == 0) {
            return;
        }
        let all = self.items.iter().enumerate();
        let meant = all.filter(|(_, one)| one.location == location && one.code == code).map(|(place, _)| place);
        let meant: Vec<usize> = meant.collect();
        let number = meant.len() as u32;
        for place in meant.into_iter().rev() {
            let severity = self.items.remove(place).severity;
            self.recount(severity, 1, usize::saturating_sub);
        }
        if let Some(count) = self.counts.get_mut(&(location.file, code.id)) {
            count.number -= number;
            count.kept -= number;
        }
        if let Some(kept) = self.kept.get_mut(&location.file) {
            *kept -= number;
        }
    }

    /// The number of kept diagnostics.
    pub(crate) fn len(&self) -> usize {
        self.items.len()
    }

    /// True if one of them is an error: nothing may start.
    pub fn has_errors(&self) -> bool {
        self.errors > 0
    }

    /// The number of errors, those not kept included.
    pub fn errors(&self) -> usize {
        self.errors
    }

    /// The number of warnings, those not kept included.
    pub fn warnings(&self) -> usize {
        self.warnings
    }

    /// True if there is none at all.
    pub fn is_empty(&self) -> bool {
        self.items.is_empty()
    }

    /// Those that were kept, in the order in which they came.
    pub fn iter(&self) -> std::slice::Iter<'_, Diagnostic> {
        self.items.iter()
    }

    /// All to report, by file and place, with one more for each kind that had too many to keep.
    pub fn into_sorted(self) -> Vec<Diagnostic> {
        let mut all = self.into_all();
        all.retain(|one| !one.is_allowed());
        all
    }

    /// The same together with those that are kept for the record alone.
    pub fn into_all(mut self) -> Vec<Diagnostic> {
        for count in self.counts.values() {
            if let Some(place) = count.beyond {
                let Code { id, name, .. } = count.code;
                let message = format!("{} more of {id} ({name}), not shown", count.number - count.kept);
                let mut more = Diagnostic::new(&codes::TOO_MANY, place, message);
                // Those that were not kept are as the last that was.
                let is_kept = |one: &&Diagnostic| one.code.id == *id && one.location.file == place.file;
                if let Some(last) = self.items.iter().rev().find(is_kept) {
                    more.severity = last.severity;
                    more.set.clone_from(&last.set);
                }
                self.items.push(more);
            }
        }
        // Stable, but for the ones above, whose order a hash map gave: the code decides.
        self.items.sort_by_key(|one| (one.location.file, one.location.span.start, one.location.span.end));
        self.items
    }
}

impl<'a> IntoIterator for &'a Diagnostics {
    type Item = &'a Diagnostic;
    type IntoIter = std::slice::Iter<'a, Diagnostic>;

    fn into_iter(self) -> Self::IntoIter {
        self.iter()
    }
}
