//! The properties of composites: what `source="$name"` and `source="$name/path"` stand for.

mod missing;
mod settings;
mod sources;

use std::cell::OnceCell;
use std::collections::{HashMap, HashSet};
use std::rc::Rc;

use missing::{from_outside, is_asked_for};

use crate::check::fleet::{Fleet, Member, Unit};
use crate::check::options::Options;
use crate::check::report::Report;
use crate::check::unfolding::replica::Instance;
use crate::check::values::path::expression;
use crate::check::values::raw::{Raw, beside_source, raw};
use crate::check::values::shared_values::SharedValues;
use crate::check::values::type_match::{self, Match};
use crate::check::values::value_type::Typed;
use crate::diagnostic::{Diagnostic, codes, nearest, quoted};
use crate::model::{ComponentElement, Composite, Property};
use crate::source::{Location, Text};
use crate::syntax::escaped;

/// The properties of all composites of a fleet, with their values.
pub(crate) struct Parameters<'a> {
    /// By the places of the fleet's units.
    units: Vec<Declared<'a>>,
    options: &'a Options,
    /// The number of more values sources with several can lead to.
    left: usize,
    /// The number of more bytes of text sources can lead to.
    bytes_left: usize,
}

/// Values that sources with several can lead to: each component that takes all of a list has each of its values.
const MOST_VALUES: usize = 4_000_000;

/// Names that a composite does not have which are looked at for one that it has: where a component is full of them they
/// mean nothing by each.
const MOST_MISSPELT: usize = 100;

/// Bytes of text that sources can lead to: each component that takes a text has it.
const MOST_BYTES: usize = 64 << 20;

/// The properties of one composite, those of what it includes among them.
#[derive(Default)]
struct Declared<'a> {
    by_name: HashMap<&'a str, Parameter<'a>>,
    /// Its names in order, once somebody asked.
    names: OnceCell<Vec<&'a str>>,
    /// True if a `source` leads to none of them: one of them is probably meant.
    has_wrong_source: bool,
    /// True if one of them has no name, which is reported.
    has_nameless: bool,
    /// The component that the composite implements.
    owner: Option<&'a ComponentElement>,
}

struct Parameter<'a> {
    composite: &'a Composite,
    property: &'a Property,
    given: Option<Given<'a>>,
    /// The variable of the environment that counts where nobody else gives a value.
    variable: Option<&'a Text>,
    /// True if it has to be given a value, and what the component says that the composite implements comes to none.
    is_unset: bool,
    is_used: bool,
    /// True if what a component gives was held to its type.
    is_judged: bool,
    /// Its values, once somebody asked for them.
    whole: Option<Rc<SharedValues<'a>>>,
}

/// The value that counts in place of the value that a composite gives its property itself.
#[derive(Clone, Copy)]
enum Given<'a> {
    /// A setting, or a variable of the environment.
    Outside(&'a Text),
    /// The property of the component that the composite implements.
    Component(ValueSite<'a>, &'a Property),
}

/// The surroundings of a property that has a value.
#[derive(Clone, Copy)]
pub(crate) struct ValueSite<'a> {
    pub(crate) unit: usize,
    pub(crate) composite: &'a Composite,
    /// The replica whose numbers are in its texts.
    pub(crate) instance: Option<&'a Instance>,
}

/// The values of a property, and the `source` that leads to them.
pub(crate) struct Found<'a> {
    pub(crate) raw: Raw<'a>,
    pub(crate) source: Option<Location>,
}

impl<'a> Declared<'a> {
    /// The names of its properties, sorted.
    fn names(&self) -> &[&'a str] {
        self.names.get_or_init(|| {
            let mut names: Vec<&str> = self.by_name.keys().copied().collect();
            names.sort_unstable();
            names
        })
    }
}

impl<'a> Parameters<'a> {
    /// Collects the properties and gives them what counts in place of their own values.
    pub(crate) fn of(fleet: &Fleet<'a>, options: &'a Options, report: &mut Report<'_>) -> Self {
        let owner = |unit: &Unit<'_>| Some(fleet.members[fleet.scopes[unit.scope].owner?].component);
        let with_owner = |unit| Declared { owner: owner(unit), ..declared(unit, report) };
        let units = fleet.units.iter().map(with_owner).collect();
        let mut parameters = Self { units, options, left: MOST_VALUES, bytes_left: MOST_BYTES };
        for (place, unit) in fleet.units.iter().enumerate() {
            let Some(owner) = fleet.scopes[unit.scope].owner else { continue };
            let owner = &fleet.members[owner];
            let outside = ValueSite { unit: owner.unit, composite: owner.composite, instance: owner.instance };
            for property in &owner.component.properties {
                if let Some(parameter) = parameters.units[place].by_name.get_mut(property.name.as_str()) {
                    // A second one is reported.
                    parameter.given.get_or_insert(Given::Component(outside, property));
                }
            }
        }
        parameters.set(fleet, options, report);
        let declared = parameters.units.iter_mut().flat_map(|unit| unit.by_name.values_mut());
        for parameter in declared {
            parameter.variable = parameter.property.env().and_then(|named| options.variable(named));
            parameter.given = parameter.given.or(parameter.variable.map(Given::Outside));
        }
        parameters.judge_outside(fleet, report);
        parameters.take_for_expressions(fleet, report);
        parameters
    }

    /// Holds what comes from the command line and the environment to the types of the properties.
    fn judge_outside(&mut self, fleet: &Fleet<'a>, report: &mut Report<'_>) {
        for (place, unit) in fleet.units.iter().enumerate() {
            for property in unit.composites.iter().flat_map(|composite| &composite.properties) {
                let parameter = self.units[place].by_name.get(property.name.as_str());
                if parameter.is_some_and(|parameter| matches!(parameter.given, Some(Given::Outside(_)))) {
                    let _ = self.whole(place, &property.name, report);
                }
            }
        }
    }

    /// The values of a component's property: those that its `source` leads to, or its own. Faults are reported.
    pub(crate) fn values(
        &mut self,
        place: ValueSite<'a>,
        property: &'a Property,
        report: &mut Report<'_>,
    ) -> Result<Found<'a>, ()> {
        let (whole, source) = self.shared(place, property, report)?;
        Ok(Found { raw: whole.into_raw(), source })
    }

    /// The same, with the `source`, as all share them who take them.
    fn shared(
        &mut self,
        place: ValueSite<'a>,
        property: &'a Property,
        report: &mut Report<'_>,
    ) -> Result<(Rc<SharedValues<'a>>, Option<Location>), ()> {
        if place.instance.is_some_and(|instance| instance.hides(property, &place.composite.document)) {
            return Err(());
        }
        if let Some(source) = property.source() {
            let whole = self.resolve(place.unit, source, report)?;
            if !whole.raw().0.is_empty() {
                let named = expression(source).and_then(|(name, _)| self.units[place.unit].by_name.get(name));
                if named.is_some_and(|named| named.property.has_value()) {
                    beside_source(property, source, &place.composite.document, report);
                }
                return Ok((whole, Some(source.location)));
            }
            // A source without a value leaves what stands in the property itself, as SCA says.
        }
        Ok((SharedValues::new(raw(property, &place.composite.document, place.instance, report)?), None))
    }

    /// The values of a component's property as its class takes them: what is inside of an `element`. Faults are
    /// reported.
    pub(crate) fn taken(
        &mut self,
        place: ValueSite<'a>,
        property: &'a Property,
        report: &mut Report<'_>,
    ) -> Result<Found<'a>, ()> {
        let found = self.values(place, property, report)?;
        Ok(Found { raw: found.raw.inside_elements_of(property), ..found })
    }

    /// Checks that the properties of a component that say a type take their values from properties of types that fit.
    pub(crate) fn types(&self, member: &Member<'a>, report: &mut Report<'_>) {
        for property in &member.component.properties {
            if let Some(source) = property.source()
                && let Some(from) = self.declaration(member.unit, source)
            {
                let own = Typed { property, document: &member.composite.document };
                type_match::check(own, from, Match::Source(source.location), report);
            }
        }
    }

    /// The declaration of the composite property that a `source` names as a whole.
    pub(crate) fn declaration(&self, unit: usize, source: &str) -> Option<Typed<'a>> {
        let (name, None) = expression(source)? else { return None };
        let found = self.units[unit].by_name.get(name)?;
        Some(Typed { property: found.property, document: &found.composite.document })
    }

    /// A diagnostic about the composite property that a `source` names, with where it is and how it can get a value.
    pub(crate) fn supply(&self, unit: usize, source: &str, one: Diagnostic) -> Diagnostic {
        let declared = &self.units[unit];
        let Some((name, parameter)) = self.named_by(unit, source) else { return one };
        let one = one.label(parameter.property.name.location, "declared here, without a value");
        let Some(owner) = declared.owner else { return one.help(from_outside(parameter.property)) };
        let help = format!(
            "add `<property name=\"{}\">...</property>` to the component {}, which the composite implements",
            escaped(name),
            quoted(&owner.name)
        );
        one.label(owner.name.location, "gives it none").help(help)
    }

    fn named_by<'n>(&self, unit: usize, source: &'n str) -> Option<(&'n str, &Parameter<'a>)> {
        let (name, _) = expression(source)?;
        Some((name, self.units[unit].by_name.get(name)?))
    }

    /// True if it is told why the composite property that a `source` names has no value: it is misspelt where it is
    /// given, or comes from a file, as those of components can.
    pub(crate) fn is_told(&self, unit: usize, source: &str) -> bool {
        let declared = &self.units[unit];
        let Some((name, Parameter { composite, property, .. })) = self.named_by(unit, source) else {
            return false;
        };
        let is_declared = |name: &str| declared.by_name.contains_key(name);
        declared.owner.is_some_and(|owner| is_misspelt(name, owner, is_declared))
            || property.origin.element(&composite.document).attribute("file").is_some()
    }

    /// Lets any property of a composite be meant by what is wrong in it.
    pub(crate) fn leave_open(&mut self, unit: usize) {
        self.units[unit].has_wrong_source = true;
    }

    /// Counts what composites of which not all is known take from those around them.
    fn pass_on(&mut self, fleet: &Fleet<'a>) {
        let mut passed: HashSet<(usize, &str)> = HashSet::new();
        for unit in (0..self.units.len()).rev() {
            let is_open = self.units[unit].has_wrong_source || fleet.scopes[fleet.units[unit].scope].is_faulty;
            if !is_open && passed.is_empty() {
                continue;
            }
            let all = self.units[unit].by_name.iter();
            let open = all.filter(|(name, _)| is_open || passed.contains(&(unit, **name)));
            let from: Vec<(usize, &'a str)> = open
                .filter_map(|(_, parameter)| match parameter.given {
                    Some(Given::Component(place, given)) => Some((place.unit, expression(given.source()?)?.0)),
                    _ => None,
                })
                .collect();
            for (outer, name) in from {
                if let Some(parameter) = self.units[outer].by_name.get_mut(name) {
                    parameter.is_used = true;
                    passed.insert((outer, name));
                }
            }
        }
    }

    /// The values that `source` leads to in this unit. Faults are reported.
    pub(crate) fn resolve(
        &mut self,
        unit: usize,
        source: &Text,
        report: &mut Report<'_>,
    ) -> Result<Rc<SharedValues<'a>>, ()> {
        let whole = self.follow(unit, source, report)?;
        let raw = whole.raw();
        let (left, count) = (self.left, raw.0.len());
        if count > 1 {
            self.left = left.saturating_sub(count);
            if left <= count {
                if left > 0 {
                    let message = format!("sources come to more than {MOST_VALUES} values");
                    let one = Diagnostic::new(&codes::FLEET_TOO_LARGE, source.location, message);
                    report.push(one.help(
                        "each component that takes all values of a property has each of them: is this what is meant?",
                    ));
                }
                return Err(());
            }
        }
        let left = self.bytes_left.saturating_sub(raw.bytes());
        let before = std::mem::replace(&mut self.bytes_left, left);
        if self.bytes_left == 0 {
            if before > 0 {
                let message = format!("sources come to more than {} MB of text", MOST_BYTES >> 20);
                let one = Diagnostic::new(&codes::FLEET_TOO_LARGE, source.location, message);
                report.push(one.help("each component that takes a long text has it: is this what is meant?"));
            }
            return Err(());
        }
        Ok(whole)
    }

    /// Reports the properties that have to have a value and have none, and those that nothing uses.
    pub(crate) fn finish(mut self, fleet: &Fleet<'a>, report: &mut Report<'_>) {
        self.follow_all(fleet, report);
        self.pass_on(fleet);
        // A composite may be there several times; what is used in one of them is used.
        let all = self.units.iter().flat_map(|declared| declared.by_name.values());
        let used = all.filter(|parameter| parameter.is_used).map(|parameter| parameter.property.origin);
        let used: HashSet<_> = used.map(|origin| (origin.file(), origin.element)).collect();
        for (place, unit) in fleet.units.iter().enumerate().filter(|(_, unit)| !unit.is_absent) {
            let declared = &self.units[place];
            let owner = fleet.scopes[unit.scope].owner.map(|owner| &fleet.members[owner]);
            for property in unit.composites.iter().flat_map(|composite| &composite.properties) {
                let Some(parameter) = declared.by_name.get(property.name.as_str()) else { continue };
                if !std::ptr::eq(parameter.property, property) {
                    continue;
                }
                let name = &property.name;
                let is_declared = |name: &str| declared.by_name.contains_key(name);
                let is_given = parameter.given.is_some() && !parameter.is_unset
                    || owner.is_some_and(|owner| {
                        owner.may_give_others() || is_misspelt(name, owner.component, is_declared)
                    });
                if is_asked_for(property) && !is_given {
                    owner.into_iter().for_each(|owner| report.about(owner));
                    report.push(self.missing(place, property, self.options.assume_classes));
                    report.about_all();
                }
                let origin = property.origin;
                let is_open = declared.has_wrong_source || fleet.scopes[unit.scope].is_faulty;
                // No `source` can name one that is of the wrong form, which is reported.
                let is_open = is_open || name.contains(char::is_whitespace);
                if !used.contains(&(origin.file(), origin.element)) && !is_open {
                    let message = format!("the property {} of the composite is used by no component", quoted(name));
                    let one = Diagnostic::new(&codes::UNUSED_PROPERTY, name.location, message);
                    report.push(one.help(format!("a component takes its value with `source=\"${}\"`", escaped(name))));
                }
            }
        }
    }
}

/// The properties of a composite and of what it includes. Repeated ones are reported.
fn declared<'a>(unit: &Unit<'a>, report: &mut Report<'_>) -> Declared<'a> {
    let mut all = Declared::default();
    let properties = unit
        .composites
        .iter()
        .flat_map(|composite| composite.properties.iter().map(move |property| (*composite, property)));
    for (composite, property) in properties {
        if property.name.is_empty() {
            all.has_nameless = true;
            continue;
        }
        // What is not there may say otherwise what another composite says that is there in place of it, or be the same
        // composite.
        let is_instead = |first: &Parameter<'_>| unit.is_absent && !std::ptr::eq(first.composite, composite);
        let first = all.by_name.get(property.name.as_str());
        if first.is_some_and(|first| std::ptr::eq(first.property, property)) {
            continue;
        }
        if let Some(first) = first.filter(|first| !is_instead(first)) {
            let message = format!("the composite has two properties {}", quoted(&property.name));
            report.push(
                Diagnostic::new(&codes::COMPOSITE_PART_REPEATED, property.name.location, message)
                    .rule("ASM60014")
                    .label(first.property.name.location, "the first")
                    .help("give each its own name"),
            );
            continue;
        }
        all.by_name.insert(
            &property.name,
            Parameter {
                composite,
                property,
                given: None,
                variable: None,
                is_unset: false,
                is_used: false,
                is_judged: false,
                whole: None,
            },
        );
    }
    all
}

/// True if the component that a composite implements gives this property under a misspelt name, which is reported.
pub(crate) fn is_misspelt(name: &str, owner: &ComponentElement, is_declared: impl Fn(&str) -> bool) -> bool {
    let unknown = owner.properties.iter().filter(|given| !is_declared(&given.name));
    unknown.take(MOST_MISSPELT).any(|given| nearest(&given.name, [name]).is_some())
}
