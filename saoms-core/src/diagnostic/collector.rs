//! The collection of diagnostics.

use std::collections::HashMap;

use super::{Code, Diagnostic, Severity, codes};
use crate::source::{FileId, Location};

/// How many diagnostics of one code are kept for one file. A generated file with one mistake in each of a million
/// components must not cost a million messages.
const LIMIT: u32 = 1000;

/// Collects diagnostics.
///
/// At most 1,000 diagnostics of one code are kept for one file; all are counted, and [`Diagnostics::into_sorted`] says
/// how many more there were.
#[derive(Debug, Default)]
pub struct Diagnostics {
    items: Vec<Diagnostic>,
    counts: HashMap<(FileId, &'static str), Count>,
    errors: usize,
    warnings: usize,
}

#[derive(Debug)]
struct Count {
    code: &'static Code,
    number: u32,
    /// The place of the first one that was not kept.
    beyond: Option<Location>,
}

impl Diagnostics {
    /// None yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds one.
    pub fn push(&mut self, diagnostic: Diagnostic) {
        self.push_with(diagnostic.code, diagnostic.severity, diagnostic.location, || diagnostic);
    }

    /// Adds one of this code, severity and place, made only when it is kept. For places where a file can have a
    /// million faults.
    pub fn push_with(
        &mut self,
        code: &'static Code,
        severity: Severity,
        location: Location,
        make: impl FnOnce() -> Diagnostic,
    ) {
        match severity {
            Severity::Error => self.errors += 1,
            Severity::Warning => self.warnings += 1,
            Severity::Note => {}
        }
        let new = Count { code, number: 0, beyond: None };
        let count = self.counts.entry((location.file, code.id)).or_insert(new);
        count.number += 1;
        if count.number <= LIMIT {
            self.items.push(make());
        } else {
            count.beyond.get_or_insert(location);
        }
    }

    /// Whether one of them is an error: nothing may start.
    pub fn has_errors(&self) -> bool {
        self.errors > 0
    }

    /// How many errors there are, those not kept included.
    pub fn errors(&self) -> usize {
        self.errors
    }

    /// How many warnings there are, those not kept included.
    pub fn warnings(&self) -> usize {
        self.warnings
    }

    /// Whether there is none at all.
    pub fn is_empty(&self) -> bool {
        self.items.is_empty()
    }

    /// Those that were kept, in the order in which they came.
    pub fn iter(&self) -> std::slice::Iter<'_, Diagnostic> {
        self.items.iter()
    }

    /// All by file and place, with one more for each kind of which there were too many to keep.
    pub fn into_sorted(mut self) -> Vec<Diagnostic> {
        for count in self.counts.values() {
            if let Some(place) = count.beyond {
                let Code { id, name, .. } = count.code;
                let message = format!("{} more of the kind {id} ({name})", count.number - LIMIT);
                self.items
                    .push(Diagnostic::new(&codes::TOO_MANY, place, message).severity(count.code.severity));
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
