//! Diagnostics as data: a fault, its place, and what to do.
//!
//! A [`Diagnostic`] has a stable [`Code`], a severity, a place, a message, and whatever helps: labels on other places,
//! help, the rule of the SCA specification it stems from, and suggestions that a tool can apply as edits.
//! [`Diagnostics`] collects them.

mod candidates;
pub mod codes;
mod collector;
mod level;
mod meant_boolean;
mod quoted;
#[cfg(test)]
mod tests;

pub(crate) use candidates::Candidates;
pub use codes::Code;
pub use collector::Diagnostics;
pub(crate) use collector::HiddenNames;
pub use level::{SetBy, SeverityLevel};
pub(crate) use meant_boolean::meant_boolean;
pub use quoted::quoted;
pub(crate) use quoted::{list, replacing};
use saoms_api::host::shorten;
pub use saoms_api::host::{nearest_equal, nearest_few};
pub use saoms_api::rule::{Severity, nearest};

/// The code that is meant by a wrong one, among these: a zero too few is likelier than another digit.
pub fn nearest_code<'c>(code: &str, all: &[&'c str]) -> Option<&'c str> {
    let with_zero =
        code.split_at_checked(2).filter(|(_, rest)| rest.len() == 2).map(|(first, rest)| format!("{first}0{rest}"));
    let found = with_zero.and_then(|full| all.iter().copied().find(|one| *one == full));
    found.or_else(|| nearest(code, all.iter().copied()))
}

use crate::source::Location;

/// A further place that explains the diagnostic, with what is to be seen there.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Label {
    /// The place, possibly in another file.
    pub location: Location,
    /// The caption of the place.
    pub text: String,
}

/// One replacement of text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Edit {
    /// The text that is replaced; of length 0 for an insertion.
    pub location: Location,
    /// The new text.
    pub replacement: String,
}

/// A way to mend the fault; its edits belong together and do not overlap.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Suggestion {
    /// The title, in the imperative: what applying it does.
    pub description: String,
    /// The edits.
    pub edits: Vec<Edit>,
}

/// One fault, or one thing worth knowing, at one place.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Diagnostic {
    /// The code.
    pub code: &'static Code,
    /// The severity; the code's own one unless set.
    pub severity: Severity,
    /// The very place.
    pub location: Location,
    /// The message: what was found and what was expected.
    pub message: String,
    /// The caption of the place in the excerpt; `None` when the message says it all.
    pub at: Option<String>,
    /// Further places.
    pub labels: Vec<Label>,
    /// Help: what to do, each a sentence or two.
    pub help: Vec<String>,
    /// The rule of the SCA specification, as `ASM50037`.
    pub rule: Option<&'static str>,
    /// Ways to mend it, the likeliest first.
    pub suggestions: Vec<Suggestion>,
    /// The setting that changed its severity, if one did.
    pub set: Option<SetBy>,
}

impl Diagnostic {
    /// A diagnostic of the code's own severity.
    pub fn new(code: &'static Code, location: Location, message: impl Into<String>) -> Self {
        Self {
            code,
            severity: code.severity,
            location,
            message: message.into(),
            at: None,
            labels: Vec::new(),
            help: Vec::new(),
            rule: code.rule,
            suggestions: Vec::new(),
            set: None,
        }
    }

    /// True if it is kept for the record alone: it is not shown, and not counted.
    pub fn is_allowed(&self) -> bool {
        self.set.as_ref().is_some_and(|set| set.level == SeverityLevel::Allow)
    }

    /// The same without values longer than a line in its texts.
    fn shortened(mut self) -> Self {
        let labels = self.labels.iter_mut().map(|label| &mut label.text).chain(&mut self.at);
        let suggested = self.suggestions.iter_mut().map(|one| &mut one.description);
        labels.chain(suggested).chain(&mut self.help).chain([&mut self.message]).for_each(shorten);
        self
    }

    /// Sets what the picture says at the place.
    #[must_use]
    pub fn at(mut self, text: impl Into<String>) -> Self {
        self.at = Some(text.into());
        self
    }

    /// Sets the severity.
    #[must_use]
    pub fn severity(mut self, severity: Severity) -> Self {
        self.severity = severity;
        self
    }

    /// Adds a further place.
    #[must_use]
    pub fn label(mut self, location: Location, text: impl Into<String>) -> Self {
        self.labels.push(Label { location, text: text.into() });
        self
    }

    /// Adds the place of another component; in words where it is the same, as in a composite that is used twice.
    #[must_use]
    pub fn other(self, location: Location, text: impl Into<String>) -> Self {
        match location == self.location {
            true => self.help("both take this value from here: give each use of the composite a value of its own, or make it a site with `saoms:site`"),
            false => self.label(location, text),
        }
    }

    /// Adds a line of help.
    #[must_use]
    pub fn help(mut self, text: impl Into<String>) -> Self {
        self.help.push(text.into());
        self
    }

    /// Sets the rule of the SCA specification.
    #[must_use]
    pub fn rule(mut self, rule: &'static str) -> Self {
        self.rule = Some(rule);
        self
    }

    /// Adds a suggestion of one edit.
    #[must_use]
    pub fn suggest(self, description: impl Into<String>, location: Location, replacement: impl Into<String>) -> Self {
        self.suggest_edits(description, vec![Edit { location, replacement: replacement.into() }])
    }

    /// Adds the suggestion to write something else at its own place.
    #[must_use]
    pub fn mend(self, description: impl Into<String>, replacement: impl Into<String>) -> Self {
        let location = self.location;
        self.suggest(description, location, replacement)
    }

    /// Adds a suggestion of several edits that belong together.
    #[must_use]
    pub fn suggest_edits(mut self, description: impl Into<String>, edits: Vec<Edit>) -> Self {
        self.suggestions.push(Suggestion { description: description.into(), edits });
        self
    }
}
