//! The properties of each component: known, given once, right, and all that have to be there.

pub(crate) mod conversion;
pub(crate) mod foreign;
pub(crate) mod given_values;
pub(crate) mod missing;
pub(crate) mod property_table;

use std::cell::LazyCell;
use std::collections::HashMap;

use crate::check::component::ComponentCheck;
use crate::check::fleet::classes::ClassIndex;
use crate::check::fleet::{Fleet, Kind};
use crate::check::fleet::{Member, Unit};
use crate::check::properties::conversion::{Conversion, Path, Use};
use crate::check::properties::given_values::{PropertyValues, ValueOrigin};
use crate::check::properties::property_table::{PropertyTable, TableEntry};
use crate::check::report::Report;
use crate::check::values::parameters::{Found, Parameters, ValueSite};
use crate::check::values::raw::{Piece, Raw, raw};
use crate::check::values::value_type::{self, Match, Typed};
use crate::diagnostic::{Diagnostic, Severity, codes, nearest_equal, quoted};
use crate::expression::has_expression;
use crate::model::{
    ComponentElement, ComponentProperty, ComponentType, LoopElement, Origin, Part, Property, Version,
};
use crate::registry::PropertyDeclaration;
use crate::source::{Location, Text};
use crate::syntax::{Document, escaped};

/// Who gives values to properties: a component, or what it says about one of its loops.
pub(crate) struct Giver<'m, 'a> {
    pub(crate) what: &'static str,
    pub(crate) name: &'a Text,
    pub(crate) origin: Origin,
    pub(crate) properties: &'a [Property],
    /// The component.
    pub(crate) member: &'m Member<'a>,
    /// The component type beside the class, whose values hold where the component gives none.
    described: Option<&'a ComponentType>,
}

impl<'m, 'a> Giver<'m, 'a> {
    pub(crate) fn component(member: &'m Member<'a>, described: Option<&'a ComponentType>) -> Self {
        let component = member.component;
        let (name, properties) = (&component.name, &component.properties);
        Self { what: "component", name, origin: component.origin, properties, member, described }
    }

    pub(crate) fn looping(one: &'a LoopElement, member: &'m Member<'a>) -> Self {
        let properties = &one.properties;
        Self { what: "loop", name: &one.name, origin: one.origin, properties, member, described: None }
    }
}

impl<'a> Giver<'_, 'a> {
    /// The properties that a file beside the class gives values to, with its document.
    pub(crate) fn defaults(&self) -> impl Iterator<Item = (&'a Property, &'a Document)> + use<'a> {
        let described = self.described.into_iter();
        described.flat_map(|one| {
            let with_values = one.properties.iter().filter(|property| property.has_value());
            with_values.map(|property| (property, &*one.document))
        })
    }
}

/// Checks the properties that somebody gives to a component of a class, or to a loop, and adds what they come to.
pub(crate) fn check<'a>(
    giver: &Giver<'_, 'a>,
    table: &PropertyTable<'a>,
    parameters: &mut Parameters<'a>,
    values: &mut Conversion,
    report: &mut Report<'_>,
) -> PropertyValues {
    let member = giver.member;
    let mut given = PropertyValues::default();
    let mut first: Vec<Option<&Property>> = vec![None; table.all.len()];
    // Those whose `source` is right, and has no value.
    let mut unset: Vec<&Text> = Vec::new();
    let mut unsure: Vec<usize> = Vec::new();
    let mut unknown: Vec<&str> = Vec::new();
    let mut is_sound = true;
    let has_open_names = member.instance.is_some_and(|one| one.partial.is_some());
    for property in giver.properties {
        let name = property.name.as_str();
        if name.is_empty() || has_open_names && has_expression(name) {
            is_sound = false;
            unknown.push("");
            continue;
        }
        let Some(place) = table.place(name) else {
            missing::unknown(property, giver, table, report);
            if let Some(source) = property.source() {
                let _ = parameters.resolve(member.unit, source, report);
            }
            is_sound = false;
            unknown.push(name);
            continue;
        };
        if let Some(first) = first[place] {
            report.push(given_twice(property, first));
            is_sound = false;
            unsure.push(place);
            continue;
        }
        first[place] = Some(property);
        let slot = &table.all[place];
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
        match add(&mut given, member, property, (place, slot), parameters, values, report) {
            Ok(false) => unset.push(&property.name),
            Ok(true) => {
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
        let Some(place) = table.place(&default.name).filter(|place| first[*place].is_none()) else {
            continue;
        };
        first[place] = Some(default);
        let found = raw(default, document, None, report);
        let used = Use { property: default.tag(), source: Some(giver.name.location) };
        let found = found.map(|found| found.inside_elements_of(default));
        let slot = (place, &table.all[place]);
        let taken = found.and_then(|found| convert(&mut given, default, found, used, slot, values, report));
        if taken.is_err() {
            is_sound = false;
            unsure.push(place);
        }
    }
    for &place in &table.required {
        let slot = &table.all[place];
        let Some(declaration) = slot.main() else { continue };
        let is_given = is_sound && unset.is_empty() && first[place].is_some();
        if is_given || given.at(place).is_some() {
            continue;
        }
        let name = declaration.name.as_str();
        if table.preset(name).is_some() {
            continue;
        }
        is_sound = false;
        unsure.push(place);
        // What is given wrongly is reported already.
        match first[place] {
            None => missing::missing(giver, declaration, table, report),
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
    for name in unknown {
        unsure.extend(meant(name, table, &given));
    }
    unsure.sort_unstable();
    unsure.dedup();
    given.is_sound = is_sound && !member.is_partial;
    given.unknown = unsure;
    given
}

/// The places of the properties that an unknown name may stand for: those that are spelt most alike, or else any number that is not given.
fn meant(name: &str, table: &PropertyTable<'_>, given: &PropertyValues) -> Vec<usize> {
    let near = nearest_equal(name, table.names());
    if !near.is_empty() {
        return near.into_iter().filter_map(|near| table.place(near)).collect();
    }
    let open = table.all.iter().enumerate().filter(|(place, _)| given.at(*place).is_none());
    let numbers = open.filter(|(_, slot)| slot.own.is_some_and(PropertyDeclaration::is_number));
    numbers.map(|(place, _)| place).collect()
}

/// Adds the value of a property; `false` if its `source` has none.
fn add<'a>(
    given: &mut PropertyValues,
    member: &Member<'a>,
    property: &'a Property,
    slot: (usize, &TableEntry<'a>),
    parameters: &mut Parameters<'a>,
    values: &mut Conversion,
    report: &mut Report<'_>,
) -> Result<bool, ()> {
    let place = ValueSite { unit: member.unit, composite: member.composite, instance: member.instance };
    let Found { raw: found, source } = parameters.taken(place, property, report)?;
    if source.is_none() && property.source().is_some() && found.0.is_empty() {
        return Ok(false);
    }
    let used = Use { property: source.unwrap_or(property.tag()), source };
    convert(given, property, found, used, slot, values, report)?;
    Ok(true)
}

/// Adds what was found for a property, as the class takes it.
fn convert(
    given: &mut PropertyValues,
    property: &Property,
    found: Raw<'_>,
    used: Use,
    slot: (usize, &TableEntry<'_>),
    values: &mut Conversion,
    report: &mut Report<'_>,
) -> Result<(), ()> {
    let path = Path { outer: None, name: &property.name };
    let mut places: Vec<Location> = found.0.iter().map(Piece::location).collect();
    if places.is_empty() {
        places.push(used.property);
    }
    let place = places[0];
    let both: [Option<&PropertyDeclaration>; 2] = [slot.1.own, slot.1.task];
    let value = match both {
        [Some(own), Some(task)] => values.convert(found, path, &[own, task], used, report),
        [Some(one), None] | [None, Some(one)] => values.convert(found, path, &[one], used, report),
        [None, None] => None,
    };
    let origin = ValueOrigin { name: slot.1.name.clone(), places, source: used.source };
    given.add(slot.0, value.ok_or(())?, place, Some(origin));
    Ok(())
}

/// Checks that what a component gives the composite that implements it are properties of that, of types that fit.
pub(crate) fn of_composite(member: &Member<'_>, inner: &Unit<'_>, report: &mut Report<'_>) {
    let declared = || {
        let composites = inner.composites.iter();
        composites.flat_map(|one| one.properties.iter().map(|property| (property, &*one.document)))
    };
    let given = &member.component.properties;
    // The first of each name.
    let mut by_name: HashMap<&str, (&Property, &Document)> = HashMap::default();
    if given.len() > FEW {
        declared().for_each(|(one, document)| _ = by_name.entry(&one.name).or_insert((one, document)));
    }
    let find = |name: &str| match given.len() > FEW {
        true => by_name.get(name).copied(),
        false => declared().find(|(one, _)| one.name == *name),
    };
    let known: LazyCell<Vec<&str>, _> =
        LazyCell::new(|| declared().map(|(one, _)| one.name.as_str()).collect());
    let is_partial = member.instance.is_some_and(|instance| instance.partial.is_some());
    let is_known = |one: &&Property| !(one.name.is_empty() || is_partial && has_expression(&one.name));
    for property in given.iter().filter(is_known) {
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
        if let Some(source) = missing::taken_inside(name, inner) {
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
    (property, first, second): (&Property, &ComponentProperty, &ComponentProperty),
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
pub(crate) fn one_value(property: &Property, version: Version, report: &mut Report<'_>) {
    // In SCA 1.0 elements of this name may be parts of a complex value.
    if let (true, [first, second, ..]) = (version.is_1_1(), property.values())
        && property.many().is_none_or(|many| !many.value)
    {
        several((property, first, second), property, report);
    }
}

/// Reports properties that one component gives twice.
pub(crate) fn repeated(component: &ComponentElement, report: &mut Report<'_>) {
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

/// Checks the properties of all components.
pub(crate) fn check_all<'a>(
    fleet: &Fleet<'a>,
    classes: &[ClassIndex<'a>],
    parameters: &mut Parameters<'a>,
    report: &mut Report<'_>,
) -> Vec<ComponentCheck<'a>> {
    let mut values = Conversion::default();
    let mut all = Vec::with_capacity(fleet.members.len());
    for (place, member) in fleet.members.iter().enumerate() {
        report.about(member);
        parameters.types(member, report);
        let mut component = ComponentCheck::default();
        if let Kind::Class(index) = member.kind {
            let giver = Giver::component(member, fleet.component_type(place));
            component.given = check(&giver, &classes[index].table, parameters, &mut values, report);
        } else {
            repeated(member.component, report);
            match fleet.inner(place) {
                Some(inner) => of_composite(member, inner, report),
                None => foreign::properties(member, fleet.known(place), parameters, report),
            }
        }
        all.push(component);
    }
    report.about_all();
    all
}
