//! Severities that are set in composites, in the namespace of SAOMS.

use super::Loader;
use super::vocabulary::SEVERITY;
use crate::diagnostic::{SeverityLevel, nearest, quoted};
use crate::model::{Origin, SeverityRule};
use crate::source::{Located, Location};
use crate::syntax::Element;

impl Loader<'_> {
    /// Reads a `severity` that stands in `parent`.
    pub(super) fn severity(&mut self, element: Element<'_>, parent: Element<'_>) {
        self.parts_of(element, &SEVERITY);
        let code = self.required(element, "code");
        let level = self.level(element);
        let reason = self.required(element, "reason");
        let Some(code) = code else { return };
        let is_wrong = level.is_none() || reason.is_none();
        let level = level.unwrap_or_else(|| Located::new(SeverityLevel::Allow, code.location));
        let reason = reason.unwrap_or_else(|| Located::new("".into(), code.location));
        let (origin, within) = (Origin::of(element), within(parent));
        self.severities.push(SeverityRule { origin, code, level, reason, is_wrong, within });
    }

    /// Remembers what a `severity` that lacks its prefix, or stands where it cannot, would be about: that is not told
    /// beside it.
    pub(super) fn meant_severity(&mut self, element: Element<'_>) {
        let (Some(parent), Some(code)) = (element.parent(), element.attribute("code")) else { return };
        let code = code.trimmed();
        let (level, reason) =
            (Located::new(SeverityLevel::Allow, code.location), Located::new("".into(), code.location));
        let (origin, within) = (Origin::of(element), within(parent));
        self.severities.push(SeverityRule { origin, code, level, reason, is_wrong: true, within });
    }

    fn level(&mut self, element: Element<'_>) -> Option<Located<SeverityLevel>> {
        let text = self.required(element, "level")?;
        if let Some(level) = SeverityLevel::from_name(&text) {
            return Some(Located::new(level, text.location));
        }
        let names = SeverityLevel::ALL.map(SeverityLevel::name);
        let meant = match text.to_ascii_lowercase().as_str() {
            "deny" | "forbid" | "fail" => Some("error"),
            "warn" => Some("warning"),
            "info" | "hint" => Some("note"),
            "ignore" | "off" | "none" | "suppress" => Some("allow"),
            other => nearest(other, names),
        };
        let message = format!("`level` is {} and has to be `allow`, `note`, `warning` or `error`", quoted(&text));
        if let Some(attribute) = element.attribute("level") {
            self.value_fault(attribute, message, meant);
        }
        None
    }
}

/// The subject of a severity in an element; `None` for the whole composite.
fn within(parent: Element<'_>) -> Option<Location> {
    parent.parent().is_some().then(|| parent.span().in_file(parent.document().file()))
}
