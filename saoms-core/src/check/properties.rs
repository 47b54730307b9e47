//! The properties of each component: known, given once, right, and all that have to be there.

use std::cell::LazyCell;
use std::collections::HashMap;

use saoms_api::PropertyValue;

use super::described;
use super::fleet::{Member, Unit};
use super::lacking;
use super::parameters::{Found, Parameters, Place};
use super::raw::{Piece, Raw, raw};
use super::report::Report;
use super::slots::{Slot, Slots};
use super::value_type::{self, Match, Typed};
use super::values::{Path, Use, Values};
use crate::diagnostic::{Diagnostic, Severity, codes, nearest, quoted};
use crate::expression::has_expression;
use crate::hash::Map;
use crate::model::{Component, ComponentType, Loop, Origin, Part, Property, PropertyValue as Value, Version};
use crate::registry::PropertyDeclaration;
use crate::source::{Location, Text};
use crate::xml::{Document, escaped};

/// What a component gives for one property of its class.
pub(super) struct Given<'r> {
    /// The place of the property in its class.
    slot: usize,
    /// The declaration of the class; `None` for a property of tasks alone.
    own: Option<&'r PropertyDeclaration>,
    pub(super) value: PropertyValue,
    /// Where the value is, to point at.
    pub(super) place: Location,
    /// `None` for one text that stands in the property itself, as most do.
    elsewhere: Option<Box<Elsewhere>>,
}

/// What is to be said of a value that is not one text in the property itself.
struct Elsewhere {
    /// Where further values are.
    more: Vec<Location>,
    /// The `source` that leads to it.
    source: Option<Location>,
}

impl Given<'_> {
    /// The name of the property, where it is one of the class.
    pub(super) fn name(&self) -> Option<&str> {
        self.own.map(|own| own.name.as_str())
    }

    /// Where its values are.
    pub(super) fn places(&self) -> impl Iterator<Item = Location> {
        let more = self.elsewhere.iter().flat_map(|elsewhere| &elsewhere.more);
        std::iter::once(self.place).chain(more.copied())
    }

    /// The `source` that leads to the value.
    pub(super) fn source(&self) -> Option<Location> {
        self.elsewhere.as_ref()?.source
    }

    /// The value as a text with its place; `None` when it is not one text.
    pub(super) fn text(&self) -> Option<Text> {
        match &self.value {
            PropertyValue::Text(text) => Some(Text::new(text.as_str().into(), self.place)),
            _ => None,
        }
    }
}

/// What all properties of a component come to.
pub(super) struct Checked<'r> {
    /// In the order of the class's properties, of which most components give few.
    given: Vec<Given<'r>>,
    /// Whether there was no fault, so that the component can be constructed.
    pub(super) is_sound: bool,
    /// The places of the properties whose values cannot be known for such faults.
    pub(super) unsure: Vec<usize>,
}

impl<'r> Checked<'r> {
    /// What is given for the property of this name.
    pub(super) fn get(&self, slots: &Slots<'_>, name: &str) -> Option<&Given<'r>> {
        self.at(slots.place(name)?)
    }

    /// What is given for the property of this place.
    pub(super) fn at(&self, slot: usize) -> Option<&Given<'r>> {
        self.given.iter().find(|given| given.slot == slot)
    }

    /// What is given for properties of tasks, with their places.
    pub(super) fn of_task(&self, slots: &Slots<'_>) -> impl Iterator<Item = (usize, &PropertyValue)> {
        let given = self.given.iter().filter(|given| slots.all[given.slot].task.is_some());
        given.map(|given| (given.slot, &given.value))
    }

    /// The values of the class's own properties, and again those of them that are not one text in the property itself: for their places.
    pub(super) fn into_values(self) -> (Vec<(String, PropertyValue)>, Vec<Given<'r>>) {
        let mut values = Vec::with_capacity(self.given.len());
        let mut elsewhere = Vec::new();
        for mut given in self.given {
            let Some(own) = given.own else { continue };
            let value = std::mem::replace(&mut given.value, PropertyValue::Text(String::new()));
            values.push((own.name.clone(), value));
            if given.elsewhere.is_some() {
                elsewhere.push(given);
            }
        }
        (values, elsewhere)
    }

    /// The values of the properties of tasks.
    pub(super) fn task_values(&self, slots: &Slots<'_>) -> Vec<(String, PropertyValue)> {
        let given = self.given.iter();
        let values =
            given.filter_map(|given| Some((slots.all[given.slot].task?.name.clone(), given.value.clone())));
        values.collect()
    }
}

/// Who gives values to properties: a component, or what it says about one of its loops.
pub(super) struct Giver<'m, 'a> {
    pub(super) what: &'static str,
    pub(super) name: &'a Text,
    pub(super) origin: Origin,
    pub(super) properties: &'a [Property],
    /// The component.
    pub(super) member: &'m Member<'a>,
    /// What a file beside the class says, whose values hold where the component gives none.
    described: Option<&'a ComponentType>,
}

impl<'m, 'a> Giver<'m, 'a> {
    pub(super) fn component(member: &'m Member<'a>, described: Option<&'a ComponentType>) -> Self {
        let component = member.component;
        let (name, properties) = (&component.name, &component.properties);
        Self { what: "component", name, origin: component.origin, properties, member, described }
    }

    pub(super) fn looping(one: &'a Loop, member: &'m Member<'a>) -> Self {
        let properties = &one.properties;
        Self { what: "loop", name: &one.name, origin: one.origin, properties, member, described: None }
    }
}

impl<'a> Giver<'_, 'a> {
    /// The properties that a file beside the class gives values to, with its document.
    pub(super) fn defaults(&self) -> impl Iterator<Item = (&'a Property, &'a Document)> + use<'a> {
        let described = self.described.into_iter();
        described.flat_map(|one| {
            let with_values = one.properties.iter().filter(|property| property.has_value());
            with_values.map(|property| (property, &*one.document))
        })
    }
}

/// Checks the properties that somebody gives to a component of a class, or to a loop.
pub(super) fn check<'a>(
    giver: &Giver<'_, 'a>,
    slots: &Slots<'a>,
    parameters: &mut Parameters<'a>,
    values: &mut Values<'a>,
    report: &mut Report<'_>,
) -> Checked<'a> {
    let member = giver.member;
    let mut given: Vec<Given<'a>> = Vec::with_capacity(giver.properties.len());
    let mut first = values.first(slots.all.len());
    // Those whose `source` is right, and has no value.
    let mut unset: Vec<&Text> = Vec::new();
    let mut unsure: Vec<usize> = Vec::new();
    let mut unknown: Vec<&str> = Vec::new();
    let mut is_sound = true;
    for (at, property) in giver.properties.iter().enumerate() {
        let is_hidden =
            member.instance.is_some_and(|one| one.partial.is_some() && has_expression(&property.name));
        if property.name.is_empty() || is_hidden {
            is_sound = false;
            unknown.push("");
            continue;
        }
        let Some(place) = values.expected(at, slots, &property.name).or_else(|| slots.place(&property.name))
        else {
            lacking::unknown(property, giver, slots, report);
            if let Some(source) = property.source() {
                let _ = parameters.resolve(member.unit, source, report);
            }
            is_sound = false;
            unknown.push(&property.name);
            continue;
        };
        if let Some(first) = first[place] {
            report.push(given_twice(property, first));
            is_sound = false;
            unsure.push(place);
            continue;
        }
        first[place] = Some(property);
        let slot = &slots.all[place];
        if let Some(many) =
            property.many().filter(|many| many.value && slot.main().is_some_and(|one| !one.many))
        {
            let message = format!(
                "the property {} takes one value, and is said here to take several",
                quoted(&property.name)
            );
            let one = Diagnostic::new(&codes::MANY_VALUES, many.location, message);
            report.push(one.help("remove `many`"));
        }
        match add(&mut given, member, (at, property), (place, slot), parameters, values, report) {
            Ok(false) => unset.push(&property.name),
            Ok(true) => {
                if let (Some(described), Some(value)) = (giver.described, given.last()) {
                    described::value(described, &property.name, value, report);
                }
                // What lacks the index as the name does, which is reported, can be anything.
                if member.is_partial
                    && property.simple_value().is_some_and(|text| text.value == member.component.name.value)
                {
                    unsure.push(place);
                }
            }
            Err(()) => {
                if property.only_text().is_some_and(|text| has_expression(text)) {
                    parameters.leave_open(member.unit);
                }
                is_sound = false;
                unsure.push(place);
            }
        }
    }
    for (default, document) in giver.defaults() {
        let Some(place) = slots.place(&default.name).filter(|place| first[*place].is_none()) else {
            continue;
        };
        first[place] = Some(default);
        let found = raw(default, document, None, report);
        let used = Use { property: default.tag(), source: Some(giver.name.location) };
        let found = found.map(|found| found.inside_elements_of(default));
        match found
            .and_then(|found| converted(default, found, used, (place, &slots.all[place]), values, report))
        {
            Ok(value) => given.push(value),
            Err(()) => {
                is_sound = false;
                unsure.push(place);
            }
        }
    }
    given.sort_unstable_by_key(|given| given.slot);
    for &place in &slots.required {
        let slot = &slots.all[place];
        let Some(declaration) = slot.main() else { continue };
        if given.iter().any(|given| given.slot == place) {
            continue;
        }
        let name = declaration.name.as_str();
        if slots.preset(name).is_some() {
            continue;
        }
        is_sound = false;
        unsure.push(place);
        // What is given wrongly is reported already.
        match first[place] {
            None => lacking::missing(giver, declaration, slots, report),
            Some(property) if unset.contains(&&property.name) => {
                let message = format!("the property {} has no value: its source has none", quoted(name));
                let at = property.source().map_or(property.tag(), |source| source.location);
                let one = Diagnostic::new(&codes::PROPERTY_MISSING, at, message);
                match property.source() {
                    Some(source) if parameters.is_told(member.unit, source) => {}
                    Some(source) => report.push(parameters.supply(member.unit, source, one)),
                    None => report.push(one),
                }
            }
            Some(_) => {}
        }
    }
    values.keep(first);
    unsure.extend(unknown.iter().flat_map(|name| meant(name, slots, &given)));
    unsure.sort_unstable();
    unsure.dedup();
    Checked { given, is_sound: is_sound && !member.is_partial, unsure }
}

/// The places of the properties that an unknown name may stand for: the one that is spelt alike, or else any number that is not given.
fn meant(name: &str, slots: &Slots<'_>, given: &[Given<'_>]) -> Vec<usize> {
    if let Some(place) = nearest(name, slots.names()).and_then(|near| slots.place(near)) {
        return vec![place];
    }
    let open = slots.all.iter().enumerate().filter(|(place, _)| given.iter().all(|one| one.slot != *place));
    let numbers = open.filter(|(_, slot)| slot.own.is_some_and(PropertyDeclaration::is_number));
    numbers.map(|(place, _)| place).collect()
}

/// Adds the value of a property, which stands `at` this place of the component's own; `false` when its `source` has none.
fn add<'a>(
    given: &mut Vec<Given<'a>>,
    member: &Member<'a>,
    (at, property): (usize, &'a Property),
    slot: (usize, &Slot<'a>),
    parameters: &mut Parameters<'a>,
    values: &mut Values<'a>,
    report: &mut Report<'_>,
) -> Result<bool, ()> {
    if let Some(text) = property.only_text().filter(|_| slot.1.takes_text() && !member.is_partial) {
        let used = Use { property: property.tag(), source: None };
        let path = Path { outer: None, name: &property.name };
        if !values.is_as_before(at, slot.1, text) {
            values.text(text, path, slot.1.declarations(), used, report).ok_or(())?;
            values.accept(at, slot, text);
        }
        let value = PropertyValue::Text(text.as_str().to_owned());
        let place = text.location;
        given.push(Given { slot: slot.0, own: slot.1.own, value, place, elsewhere: None });
        return Ok(true);
    }
    let place = Place { unit: member.unit, composite: member.composite, instance: member.instance };
    let Found { raw: found, source } = parameters.taken(place, property, report)?;
    if source.is_none() && property.source().is_some() && found.0.is_empty() {
        return Ok(false);
    }
    let used = Use { property: source.unwrap_or(property.tag()), source };
    given.push(converted(property, found, used, slot, values, report)?);
    Ok(true)
}

/// What was found for a property, as the class takes it.
fn converted<'r>(
    property: &Property,
    found: Raw<'_>,
    used: Use,
    (slot, declared): (usize, &Slot<'r>),
    values: &mut Values<'_>,
    report: &mut Report<'_>,
) -> Result<Given<'r>, ()> {
    let path = Path { outer: None, name: &property.name };
    let place = found.0.first().map_or(used.property, Piece::location);
    let more = found.0.iter().skip(1).map(Piece::location).collect();
    let both: [Option<&PropertyDeclaration>; 2] = [declared.own, declared.task];
    let value = match both {
        [Some(own), Some(task)] => values.convert(found, path, &[own, task], used, report),
        [Some(one), None] | [None, Some(one)] => values.convert(found, path, &[one], used, report),
        [None, None] => None,
    };
    let elsewhere = Some(Box::new(Elsewhere { more, source: used.source }));
    Ok(Given { slot, own: declared.own, value: value.ok_or(())?, place, elsewhere })
}

/// Checks that what a component gives the composite that implements it are properties of that, of types that fit.
pub(super) fn of_composite(member: &Member<'_>, inner: &Unit<'_>, report: &mut Report<'_>) {
    let declared = || {
        let composites = inner.composites.iter();
        composites.flat_map(|one| one.properties.iter().map(|property| (property, &*one.document)))
    };
    let given = &member.component.properties;
    // The first of each name.
    let mut by_name: Map<&str, (&Property, &Document)> = Map::default();
    if given.len() > FEW {
        declared().for_each(|(one, document)| _ = by_name.entry(&one.name).or_insert((one, document)));
    }
    let find = |name: &str| match given.len() > FEW {
        true => by_name.get(name).copied(),
        false => declared().find(|(one, _)| one.name == *name),
    };
    let known: LazyCell<Vec<&str>, _> =
        LazyCell::new(|| declared().map(|(one, _)| one.name.as_str()).collect());
    for property in given.iter().filter(|property| !property.name.is_empty()) {
        if let Some((declared, document)) = find(&property.name) {
            let own = Typed { property, document: &member.composite.document };
            let is_many = declared.many().is_some_and(|many| many.value);
            if let (false, [first, second, ..]) = (is_many, property.values()) {
                several((property, first, second), declared, report);
            }
            let declared = Typed { property: declared, document };
            value_type::matches(own, declared, Match::Declaration, report);
            continue;
        }
        let (name, at) = (&property.name, property.name.location);
        let of = quoted(&inner.main().name);
        let message = format!("composite {of} has no property {}", quoted(name));
        if known.contains(&"") {
            // It is the one without a name, which is reported.
            continue;
        }
        if report.skip(&codes::UNKNOWN_PROPERTY, Severity::Error, at) {
            continue;
        }
        if let Some(source) = lacking::taken_inside(name, inner) {
            let one = Diagnostic::new(&codes::UNKNOWN_PROPERTY, at, message).label(source, "taken here");
            let help = format!("declare it in the composite: `<property name=\"{}\"/>`", escaped(name));
            report.push(one.help(help));
            continue;
        }
        let known = ("its properties are", known.iter().copied());
        let one = report.unknown(&codes::UNKNOWN_PROPERTY, at, message, name, known);
        report.push(one);
    }
}

/// Up to here names are compared one by one.
const FEW: usize = 16;

/// Says that a property that its declaration says takes one value is given several.
fn several(
    (property, first, second): (&Property, &Value, &Value),
    declared: &Property,
    report: &mut Report<'_>,
) {
    let (name, count) = (quoted(&property.name), property.values().len());
    let message = format!("the property {name} takes one value, and here are {count}");
    let one = Diagnostic::new(&codes::MANY_VALUES, second.tag(), message).label(first.tag(), "the first");
    let one = if std::ptr::eq(property, declared) {
        one
    } else {
        one.label(declared.name.location, "declared here, without `many=\"true\"`")
    };
    report.push(one.help("keep one of them, or write `many=\"true\"` where the property is declared"));
}

/// Checks that a composite gives its property one value, where it takes one.
pub(super) fn one_value(property: &Property, version: Version, report: &mut Report<'_>) {
    // In SCA 1.0 elements of this name may be parts of a complex value.
    if let (true, [first, second, ..]) = (version.is_1_1(), property.values())
        && property.many().is_none_or(|many| !many.value)
    {
        several((property, first, second), property, report);
    }
}

/// Reports properties that one component gives twice.
pub(super) fn repeated(component: &Component, report: &mut Report<'_>) {
    let all = &component.properties;
    if all.len() <= FEW {
        for (place, property) in all.iter().enumerate().filter(|(_, property)| !property.name.is_empty()) {
            if let Some(first) = all[..place].iter().find(|first| first.name == *property.name.value) {
                report.push(given_twice(property, first));
            }
        }
        return;
    }
    let mut first: HashMap<&str, &Property> = HashMap::new();
    for property in all.iter().filter(|property| !property.name.is_empty()) {
        match first.get(property.name.as_str()) {
            None => _ = first.insert(&property.name, property),
            Some(first) => report.push(given_twice(property, first)),
        }
    }
}

fn given_twice(property: &Property, first: &Property) -> Diagnostic {
    let message = format!("the property {} is given twice", quoted(&property.name));
    Diagnostic::new(&codes::PROPERTY_REPEATED, property.name.location, message)
        .label(first.name.location, "first here")
        .help("keep one of them")
}
