//! What components and rules say about values, as diagnostics at the very places.

use saoms_api::host::PropertyValue;
use saoms_api::{Finding, Place};
use smol_str::SmolStr;

use super::checked::Elsewhere;
use super::fleet::Member;
use super::report::{Report, replacing};
use crate::diagnostic::{Code, Diagnostic, Severity, quoted};
use crate::model::{Component, Property};
use crate::source::Location;
use crate::syntax::escaped;

/// A component, or a loop of one, for findings about it.
#[derive(Clone, Copy)]
pub(super) struct Subject<'a> {
    /// `component` or `loop`.
    pub(super) what: &'static str,
    pub(super) name: &'a str,
    /// Where its name is.
    pub(super) at: Location,
    pub(super) values: &'a [(SmolStr, PropertyValue)],
    /// What the composite says of its properties.
    pub(super) properties: &'a [Property],
    /// The values that are not one text there, with their places.
    pub(super) elsewhere: &'a [Elsewhere],
}

/// Where the composite gives a property.
struct Given {
    places: Vec<Location>,
    /// The `source` that leads there.
    source: Option<Location>,
}

impl<'a> Subject<'a> {
    /// A component with its values.
    pub(super) fn of(
        member: &Member<'a>,
        values: &'a [(SmolStr, PropertyValue)],
        elsewhere: &'a [Elsewhere],
    ) -> Self {
        let Component { name, properties, .. } = member.component;
        Self { what: "component", name: name.as_str(), at: name.location, values, properties, elsewhere }
    }

    /// Whether the composite gives a property of this name.
    pub(super) fn gives(&self, name: &str) -> bool {
        self.written(name).is_some()
    }

    fn written(&self, name: &str) -> Option<Given> {
        if let Some(Elsewhere { places, source, .. }) = self.elsewhere.iter().find(|one| one.name == name) {
            return Some(Given { places: places.clone(), source: *source });
        }
        let text = self.properties.iter().find(|one| one.name == *name)?.only_text()?;
        Some(Given { places: vec![text.location], source: None })
    }
}

/// The diagnostic for a finding about these components; `own` is the one that a place without a component is in. `None` where there were
/// so many that it is only counted.
pub(super) fn diagnostic<'s>(
    code: &'static Code,
    severity: Severity,
    finding: &Finding,
    own: Subject<'s>,
    all: &dyn Fn(usize) -> Option<Subject<'s>>,
    report: &mut Report<'_>,
) -> Option<Diagnostic> {
    let subject = |place: &Place| place.component_index().and_then(all).unwrap_or(own);
    let about = subject(finding.place());
    if report.skip(code, severity, about.at) {
        return None;
    }
    let place = located(finding.place(), about, report);
    // What a rule says is about the fleet; what a constructor says, about one component.
    let message = match finding.place().component_index() {
        Some(_) => finding.message().to_owned(),
        None => format!("{} {}: {finding}", about.what, quoted(about.name)),
    };
    let mut one = Diagnostic::new(code, place.at, message).severity(severity);
    for (other, text) in finding.labels() {
        let at = located(other, subject(other), report).at;
        one = one.label(at, text);
    }
    if let Some(source) = place.source {
        let property = finding.place().property_name().unwrap_or_default();
        one = one.label(source, format!("used here as {}", quoted(property)));
    }
    if let (Some(meant), Some(text)) = (finding.replacement(), place.text) {
        let written = if place.is_xml { escaped(meant) } else { meant.to_owned() };
        one = one.suggest(replacing(text, meant), place.at, written);
    }
    one.help.extend(finding.helps().iter().cloned());
    Some(one)
}

/// Where a place is in the files.
struct Located<'a> {
    at: Location,
    source: Option<Location>,
    /// What stands there, where it is a part of a value.
    text: Option<&'a str>,
    /// Whether a text has to be escaped to stand there.
    is_xml: bool,
}

/// The place in the files: the component's name for a property that the composite does not give.
fn located<'a>(place: &Place, subject: Subject<'a>, report: &Report<'_>) -> Located<'a> {
    let nowhere = Located { at: subject.at, source: None, text: None, is_xml: false };
    let given = place.property_name().and_then(|name| {
        let values = &subject.values.iter().find(|(given, _)| given == name)?.1;
        Some((values, subject.written(name)?))
    });
    let Some((values, written)) = given else { return nowhere };
    let Some(&first) = written.places.first() else { return nowhere };
    let whole = Located { at: first, source: written.source, ..nowhere };
    let Some((index, part)) = place.value_part() else { return whole };
    let value = match values {
        PropertyValue::Many(values) => values.get(index),
        one => (index == 0).then_some(one),
    };
    let (Some(PropertyValue::Text(value)), Some(&at)) = (value, written.places.get(index)) else {
        return whole;
    };
    Located {
        text: value.get(part.clone()),
        at: report.parts_of(value, at).part(part),
        source: written.source,
        is_xml: report.is_xml(at.file),
    }
}
