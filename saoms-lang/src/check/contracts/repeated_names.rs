//! Names that have to be unique in one element.

use std::collections::HashMap;

use crate::check::report::Report;
use crate::diagnostic::{Code, Diagnostic, Severity, quoted};
use crate::source::{Location, Text};

/// Something whose parts have names of their own.
pub(crate) struct Owner<'o> {
    /// As messages call it.
    pub(crate) name: &'o dyn Fn() -> String,
    pub(crate) code: &'static Code,
    pub(crate) severity: Severity,
    pub(crate) help: &'static str,
}

impl Owner<'_> {
    /// Reports each name of its parts of this kind that occurs before.
    pub(crate) fn check<'a>(
        &self,
        what: &str,
        rule: &'static str,
        names: impl Iterator<Item = &'a Text>,
        report: &mut Report<'_>,
    ) {
        let mut first: HashMap<&str, Location> = HashMap::new();
        for name in names.filter(|name| !name.is_empty()) {
            let Some(earlier) = first.get(name.as_str()) else {
                first.insert(name, name.location);
                continue;
            };
            let message = format!("{} has two {what} {}", (self.name)(), quoted(name));
            let one = Diagnostic::new(self.code, name.location, message).severity(self.severity).rule(rule);
            report.push(one.label(*earlier, "the first").help(self.help));
        }
    }
}
