//! The report: collects diagnostics, removes duplicates, and joins those of replicas.

pub(crate) mod severities;
pub(crate) mod swapped;

use std::collections::{HashMap, HashSet};
use std::ops::Range;

use crate::diagnostic::{
    Candidates, Code, Diagnostic, Diagnostics, Severity, Suggestion, codes, nearest_equal, quoted,
};
pub(crate) use crate::diagnostic::{list, replacing};
use crate::expression::has_expression;
use crate::limits::{MERGED_DIAGNOSTICS, REMEMBERED_DIAGNOSTICS};
use crate::source::{FileId, Location, Sources, Span, Text};
use crate::syntax::SourceMap;

/// A collector of diagnostics that knows the texts they are about.
pub(crate) struct Report<'a> {
    sources: &'a Sources,
    diagnostics: &'a mut Diagnostics,
    /// The rest of the right names that may be compared with wrong ones.
    candidates: Candidates,
    /// The prefixes of types that are bound to nothing, by their files.
    unbound: HashSet<(FileId, String)>,
    /// Diagnostics by code, place and message: a composite that implements several components has its faults once.
    said: HashSet<(&'static str, Location, String)>,
    /// The replica that is looked at.
    copy: Option<Copied>,
    /// The highest severity of what is reported, and a line of help for all of it.
    most: Severity,
    help: Option<&'static str>,
    /// Diagnostics about replicas, and where each is by its place and code.
    copies: Vec<ReplicaDiagnostic>,
    known_copies: HashMap<(Location, &'static str), usize>,
    /// What is not to be said of replicas, since something else says it better.
    withdrawn_copies: HashSet<(Location, &'static str)>,
    /// The lines of tables that are about replicas that are there.
    lines: HashSet<Location>,
    /// Diagnostics about lines without a replica: the same composite may have the replica where it is there another
    /// time.
    lines_without_replica: Vec<Diagnostic>,
}

/// A component that is a replica, or inside one.
#[derive(Clone, PartialEq)]
struct Copied {
    path: Box<str>,
    index: Option<i64>,
}

/// A diagnostic about replicas at one place.
struct ReplicaDiagnostic {
    one: Diagnostic,
    first: Copied,
    last: Copied,
    /// Of how many more than the first.
    more: usize,
}

impl<'a> Report<'a> {
    /// The path of a file.
    pub(crate) fn path(&self, file: FileId) -> &str {
        self.sources.get(file).path()
    }

    pub(crate) fn new(sources: &'a Sources, diagnostics: &'a mut Diagnostics) -> Self {
        Self {
            sources,
            diagnostics,
            candidates: Candidates::default(),
            unbound: HashSet::new(),
            said: HashSet::new(),
            copy: None,
            most: Severity::Error,
            help: None,
            copies: Vec::new(),
            known_copies: HashMap::new(),
            withdrawn_copies: HashSet::new(),
            lines: HashSet::new(),
            lines_without_replica: Vec::new(),
        }
    }

    /// A report about the same texts that is dropped.
    pub(crate) fn dropped<'u>(&self, diagnostics: &'u mut Diagnostics) -> Report<'u>
    where
        'a: 'u,
    {
        Report::new(self.sources, diagnostics)
    }

    /// Withdraws what was reported of this code at this place, since something else says it better.
    pub(crate) fn withdraw(&mut self, code: &'static Code, at: Location) {
        self.diagnostics.withdraw(code, at);
        if self.known_copies.contains_key(&(at, code.id)) {
            self.withdrawn_copies.insert((at, code.id));
        }
    }

    /// Lets what follows be about the replica of this path, or a component inside one, which has no index of its own.
    /// What is found at one place of several is reported once, with how many.
    pub(crate) fn about_replica(&mut self, path: &str, index: Option<i64>) {
        self.copy = Some(Copied { path: path.into(), index });
    }

    /// True if what follows is about a replica that has an index of its own.
    pub(crate) fn has_index(&self) -> bool {
        self.copy.as_ref().is_some_and(|copy| copy.index.is_some())
    }

    /// Lets what follows be about the fleet.
    pub(crate) fn about_all(&mut self) {
        self.copy = None;
    }

    /// Lets what is said inside be about the fleet, and not about the replica at hand.
    pub(crate) fn about_fleet<T>(&mut self, check: impl FnOnce(&mut Self) -> T) -> T {
        let copy = self.copy.take();
        let found = check(self);
        self.copy = copy;
        found
    }

    /// Lets what is reported inside be of this severity at most, and have this line of help as well.
    pub(crate) fn within(&mut self, most: Severity, help: Option<&'static str>, check: impl FnOnce(&mut Self)) {
        let around = (self.most, self.help);
        (self.most, self.help) = (most, help);
        check(self);
        (self.most, self.help) = around;
    }

    /// Notes that there is a replica that the line of a table is about which has its name or index here.
    pub(crate) fn line(&mut self, key: Location) {
        self.lines.insert(key);
    }

    /// Adds a diagnostic about a line of a table that is about no replica of this composite, unless it is about one
    /// elsewhere.
    pub(crate) fn line_without_replica(&mut self, diagnostic: Diagnostic) {
        self.lines_without_replica.push(diagnostic);
    }

    /// Reports what was kept of replicas and lines of tables.
    pub(crate) fn finish(&mut self) {
        // How many replicas are meant may be what is wrong.
        let of_count = [&codes::UNKNOWN_PROPERTY, &codes::SETTING_REPEATED, &codes::UNKNOWN_SETTING];
        let known = self.diagnostics.iter().chain(self.copies.iter().map(|kept| &kept.one));
        let is_open = known.into_iter().any(|one| of_count.contains(&one.code));
        for one in std::mem::take(&mut self.lines_without_replica) {
            if is_open && one.severity == Severity::Warning {
                continue;
            }
            // Said once of each line.
            if self.lines.insert(one.location) {
                self.diagnostics.push(one);
            }
        }
        for kept in std::mem::take(&mut self.copies) {
            if self.withdrawn_copies.contains(&(kept.one.location, kept.one.code.id)) {
                continue;
            }
            let ReplicaDiagnostic { mut one, first: Copied { path, index }, more, .. } = kept;
            // What is reported of a component around them at this place is the same mistake.
            if self.said.contains(&said(&one)) {
                continue;
            }
            let path = quoted(&path);
            let mut about = if one.message.contains(&path) { Vec::new() } else { vec![format!("in {path}")] };
            about.extend(index.map(|index| format!("index {index}")));
            if more > 0 {
                about.push(format!("and in {more} more"));
            }
            if !about.is_empty() {
                one.message = format!("{} ({})", one.message, about.join(", "));
            }
            self.diagnostics.push(one);
        }
        self.known_copies.clear();
    }

    /// Keeps a diagnostic about a replica for [`Report::finish`].
    fn push_copy(&mut self, mut one: Diagnostic, copy: Copied) {
        let key = (one.location, one.code.id);
        if let Some(known) = self.known_copies.get(&key) {
            let ReplicaDiagnostic { first, last, more, .. } = &mut self.copies[*known];
            // What is found again from components inside of a replica is of that one.
            let depth = |copy: &Copied| copy.path.matches('/').count();
            if *last != copy && depth(first) == depth(&copy) {
                *last = copy;
                *more += 1;
            }
            return;
        }
        if self.copies.len() >= MERGED_DIAGNOSTICS {
            return self.diagnostics.push(one);
        }
        let own = one.location;
        one.labels.retain(|label| label.location != own);
        // An edit there would be one of all replicas.
        let is_of_all = |suggestion: &Suggestion| {
            suggestion.edits.iter().any(|edit| has_expression(self.sources.snippet(edit.location)))
        };
        let (of_each, suggestions): (Vec<_>, Vec<_>) = one.suggestions.into_iter().partition(is_of_all);
        one.suggestions = suggestions;
        one.help.extend(of_each.into_iter().map(|suggestion| suggestion.description));
        self.known_copies.insert(key, self.copies.len());
        self.copies.push(ReplicaDiagnostic { one, first: copy.clone(), last: copy, more: 0 });
    }

    /// Adds a diagnostic, unless the same was said of the same place.
    pub(crate) fn push(&mut self, mut diagnostic: Diagnostic) {
        diagnostic.severity = diagnostic.severity.min(self.most);
        diagnostic.help.extend(self.help.map(str::to_owned));
        if let Some(copy) = &self.copy {
            return self.push_copy(diagnostic, copy.clone());
        }
        if self.said.len() >= REMEMBERED_DIAGNOSTICS || self.said.insert(said(&diagnostic)) {
            self.diagnostics.push(diagnostic);
        }
    }

    /// True if a prefix is the first one of its name in its file that is reported to be bound to nothing.
    pub(crate) fn is_first_unbound(&mut self, file: FileId, prefix: &str) -> bool {
        self.unbound.insert((file, prefix.to_owned()))
    }

    /// All that was said.
    pub(crate) fn diagnostics(&mut self) -> &mut Diagnostics {
        self.diagnostics
    }

    /// True if there is an error among what is reported now or at the end.
    pub(crate) fn has_errors(&self) -> bool {
        let is_open = |one: &&Diagnostic| !self.lines.contains(&one.location);
        let mut later =
            self.copies.iter().map(|kept| &kept.one).chain(self.lines_without_replica.iter().filter(is_open));
        self.diagnostics.has_errors() || later.any(|one| one.severity == Severity::Error)
    }

    /// Notes that what is at a place is a secret.
    pub(crate) fn hide(&self, at: Location) {
        self.sources.hide(at);
    }

    /// The place of a part of `text`, in bytes of the text as it is meant.
    pub(crate) fn part(&self, text: &Text, part: Range<usize>) -> Location {
        self.parts(text).part(part)
    }

    /// The same for many parts of one text.
    pub(crate) fn parts(&self, text: &Text) -> Parts {
        self.parts_of(text, text.location)
    }

    /// The places of the parts of a text that is written at a place.
    pub(crate) fn parts_of(&self, text: &str, written: Location) -> Parts {
        Parts { writing: SourceMap::of(self.sources.snippet(written), text), length: text.len(), written }
    }

    /// True if what stands in the file is XML, and not the bare text of a value.
    pub(crate) fn is_xml(&self, file: FileId) -> bool {
        self.sources.get(file).text().trim_start_matches('\u{feff}').trim_start().starts_with('<')
    }

    /// What is written at a place.
    pub(crate) fn written(&self, at: Location) -> &'a str {
        self.sources.snippet(at)
    }

    /// True if there are so many diagnostics of this code at this place's file that one more is counted and not shown.
    /// Diagnostics of replicas are reported together, and always wanted.
    pub(crate) fn skip(&mut self, code: &'static Code, severity: Severity, at: Location) -> bool {
        self.copy.is_none() && self.diagnostics.skip(code, severity.min(self.most), at)
    }

    /// A diagnostic about a name that stands for nothing: with the likeliest right ones as suggestions, or else with
    /// all right ones, introduced by `known_as`.
    pub(crate) fn unknown<'n>(
        &mut self,
        code: &'static Code,
        at: Location,
        message: String,
        name: &str,
        (known_as, candidates): (&str, impl IntoIterator<Item = &'n str> + Clone),
    ) -> Diagnostic {
        let one = Diagnostic::new(code, at, message);
        // No name that is known is of the wrong form: the right one mends both.
        if name.contains(|letter: char| letter.is_whitespace() || letter == '/') {
            self.withdraw(&codes::ATTRIBUTE_VALUE, at);
        }
        // It is counted alone.
        if self.copy.is_none() && self.diagnostics.is_full(code, at.file) {
            return one;
        }
        let count = candidates.clone().into_iter().take(self.candidates.most_to_count()).count();
        if !self.candidates.admit(count) {
            return one;
        }
        let mut near = nearest_equal(name, candidates.clone());
        // All replicas are meant rather than one of them.
        if near.iter().any(|near| near.contains('*')) {
            near.retain(|near| near.contains('*'));
        }
        match near[..] {
            [] if candidates.clone().into_iter().next().is_none() => one,
            [] => one.help(format!("{known_as} {}", list(candidates))),
            _ => near.iter().fold(one, |one, meant| one.replace(name, at, meant)),
        }
    }
}

fn said(one: &Diagnostic) -> (&'static str, Location, String) {
    (one.code.id, one.location, one.message.clone())
}

/// The places of the parts of a text.
pub(crate) struct Parts {
    /// `None` where what is written is not the text.
    writing: Option<SourceMap>,
    length: usize,
    written: Location,
}

impl Parts {
    /// The place of a part, in bytes of the text as it is meant.
    pub(crate) fn part(&self, part: Range<usize>) -> Location {
        let Location { file, span } = self.written;
        let end = part.end.min(self.length);
        match self.writing.as_ref().and_then(|writing| writing.part(part.start.min(end)..end)) {
            Some(part) => Span::new(span.start + part.start as u32, span.start + part.end as u32).in_file(file),
            None => self.written,
        }
    }
}
