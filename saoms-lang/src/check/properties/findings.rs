//! Findings of constructors and plugin rules, as diagnostics at the exact places.

use saoms_api::host::PropertyValue;
use saoms_api::{Finding, Place};
use smol_str::SmolStr;

use crate::check::properties::given_values::ValuePlace;
use crate::check::report::{Report, replacing};
use crate::diagnostic::{Code, Diagnostic, Severity, quoted};
use crate::model::ComponentElement;
use crate::source::{Location, Text};
use crate::syntax::escaped;

/// A topic to which a component gives a new name.
pub(crate) struct Renamed {
    pub(crate) old: Text,
    pub(crate) new: Text,
}

/// A component, or a loop of one, for findings about it.
#[derive(Clone, Copy)]
pub(crate) struct Subject<'a> {
    /// `component` or `loop`.
    pub(crate) what: &'static str,
    pub(crate) name: &'a str,
    /// The place of its name.
    pub(crate) at: Location,
    /// The component, but none of a loop.
    pub(crate) element: Option<&'a ComponentElement>,
    pub(crate) renamed: &'a [Renamed],
    pub(crate) values: &'a [(SmolStr, PropertyValue)],
    /// The place of each value.
    pub(crate) places: &'a [ValuePlace],
    /// The site of a component; empty for none, and for a loop.
    pub(crate) site: &'a str,
}

impl<'a> Subject<'a> {
    /// True if the composite gives a property of this name.
    pub(crate) fn gives(&self, name: &str) -> bool {
        self.value(name).is_some_and(|(_, place)| !place.places.is_empty())
    }

    /// The text at a place, where a property has one text there.
    pub(crate) fn text(&self, place: &Place) -> Option<&'a str> {
        let (index, part) = place.value_part().map_or((0, None), |(index, part)| (index, Some(part)));
        let whole = match self.value(place.property_name()?)?.0 {
            PropertyValue::Many(values) => values.get(index).and_then(PropertyValue::as_text)?,
            one => one.as_text()?,
        };
        part.map_or(Some(whole), |part| whole.get(part))
    }

    /// Where the text is written that a place is in.
    pub(crate) fn written(&self, place: &Place) -> Option<Location> {
        let index = place.value_part().map_or(0, |(index, _)| index);
        self.value(place.property_name()?)?.1.places.get(index).copied()
    }

    /// The value of the property of this name, with its place.
    fn value(&self, name: &str) -> Option<(&'a PropertyValue, &'a ValuePlace)> {
        let mut all = self.values.iter().zip(self.places);
        all.find(|((given, _), _)| given == name).map(|((_, value), place)| (value, place))
    }
}

/// The diagnostic for a finding about these components; `own` is the one that a place without a component is in. `None`
/// where there were so many that it is only counted.
pub(crate) fn diagnostic<'s>(
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
        // Replicas in one use of a composite are no two uses of it.
        let around = |subject: Subject<'s>| subject.name.rsplit_once('/').map(|(around, _)| around);
        if at != place.at || around(about) != around(subject(other)) {
            // Those in two sites need no advice to be sites.
            let is_apart = at == place.at && about.site != subject(other).site;
            one = if is_apart { one } else { one.other(at, text) };
        }
    }
    if let Some(source) = place.source {
        let property = finding.place().property_name().unwrap_or_default();
        one = one.label(source, format!("used here as {}", quoted(property)));
    }
    if let (Some(meant), Some(text)) = (finding.replacement(), place.text) {
        let written = if place.is_xml { escaped(meant) } else { meant.to_owned() };
        one = one.suggest(replacing(&text, meant), place.at, written);
    }
    one.help.extend(finding.helps().iter().cloned());
    Some(one)
}

/// The location of a place in the files.
struct Located {
    at: Location,
    source: Option<Location>,
    /// The text there, if it is a part of a value.
    text: Option<SmolStr>,
    /// True if a text has to be escaped to stand there.
    is_xml: bool,
}

/// The place in the files. For a property that the composite does not give it is that of the reference of this name
/// (its first target, or else its name), of the new name of the topic or else the site, or the component's name.
fn located<'a>(place: &Place, subject: Subject<'a>, report: &Report<'_>) -> Located {
    let beside = place.property_name().zip(subject.element).and_then(|(name, element)| match name.split_once(',') {
        Some((_, topic)) => {
            let renamed = subject.renamed.iter().find(|one| *one.old == *topic).map(|one| &one.new);
            renamed.or(element.site.as_deref())
        }
        None => {
            let reference = element.reference(name)?;
            reference.targets.first().or(Some(&reference.name))
        }
    });
    let at = beside.map_or(subject.at, |text| text.location);
    let nowhere =
        Located { at, source: None, text: beside.map(|text| text.value.clone()), is_xml: report.is_xml(at.file) };
    let given = place.property_name().and_then(|name| subject.value(name));
    let is_cell = |given: &(&PropertyValue, &ValuePlace)| given.1.places.iter().all(|at| !report.is_xml(at.file));
    let own = place.own_property_name().and_then(|name| subject.value(name));
    let own = own.filter(|own| !own.1.places.is_empty() && is_cell(own) && !given.as_ref().is_some_and(is_cell));
    let Some((values, given)) = own.or(given) else { return nowhere };
    let Some(&first) = given.places.first() else { return nowhere };
    let whole = Located { at: first, source: given.source, ..nowhere };
    let Some((index, part)) = place.value_part() else { return whole };
    let one_of = |values: &'a PropertyValue| match values {
        PropertyValue::Many(values) => values.get(index),
        one => (index == 0).then_some(one),
    };
    let (Some(PropertyValue::Scalar(value)), Some(&at)) = (one_of(values), given.places.get(index)) else {
        return whole;
    };
    // The part is one of the usual text, which is not there.
    if given.written.as_deref().is_some_and(|written| one_of(written) != one_of(values)) {
        return Located { at, ..whole };
    }
    let value = value.text();
    Located {
        text: value.get(part.clone()).map(SmolStr::from),
        at: report.parts_of(&value, at).part(part),
        source: given.source,
        is_xml: report.is_xml(at.file),
    }
}
