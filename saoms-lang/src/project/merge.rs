//! Diagnostics of several fleets that share composites.

use std::collections::HashMap;

use super::folder::is_left_to_users;
use crate::diagnostic::{Diagnostic, Severity, codes};
use crate::source::{Sources, Span};

/// The diagnostics of several fleets, in which composites can be that several of them name.
#[derive(Default)]
pub(super) struct Merged {
    all: Vec<Diagnostic>,
    /// The reports by file, place and code.
    known: HashMap<(String, Span, &'static str), Reports>,
    fleets: usize,
    /// Settings that fleets do not know: an error where none of them does.
    unknown: Vec<Diagnostic>,
}

/// The reports of one code at one place.
struct Reports {
    /// The last fleet that had one.
    fleet: usize,
    worst: Severity,
    messages: Vec<String>,
}

impl Merged {
    /// Adds the diagnostics of a fleet. One that is not whole may lack what its users give it.
    pub(super) fn add(&mut self, found: Vec<Diagnostic>, is_whole: bool, sources: &Sources) {
        self.fleets += 1;
        for one in found {
            if is_left_to_users(&one) && !is_whole {
                continue;
            }
            if one.code == &codes::UNKNOWN_SETTING {
                self.unknown.push(one);
                continue;
            }
            let path = sources.get(one.location.file).path().to_owned();
            // A place that one fleet reports is not reported again for another one in other words, unless it is worse
            // there.
            let new = Reports { fleet: self.fleets, worst: one.severity, messages: Vec::new() };
            let reports = self.known.entry((path, one.location.span, one.code.id)).or_insert(new);
            let is_wanted = reports.fleet == self.fleets || one.severity > reports.worst;
            if is_wanted && !reports.messages.contains(&one.message) {
                reports.fleet = self.fleets;
                reports.worst = reports.worst.max(one.severity);
                reports.messages.push(one.message.clone());
                self.all.push(one);
            }
        }
    }

    pub(super) fn finish(mut self, fleets: usize) -> Vec<Diagnostic> {
        while let Some(first) = self.unknown.first().cloned() {
            let (same, others): (Vec<_>, Vec<_>) =
                self.unknown.into_iter().partition(|one| one.location == first.location);
            self.unknown = others;
            if same.len() >= fleets {
                self.all.push(first.severity(Severity::Error));
            }
        }
        self.all
    }
}
