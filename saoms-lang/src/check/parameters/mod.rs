//! The properties of composites: what `source="$name"` and `source="$name/path"` stand for.

mod outside;
mod sources;

use std::collections::{BTreeMap, HashMap, HashSet};
use std::rc::Rc;

use outside::{from_outside, is_asked_for};

use crate::check::fleet::{Fleet, Member};
use crate::check::judged::{Faulty, Judged};
use crate::check::options::Options;
use crate::check::report::Report;
use crate::check::values::expression_scope::is_misspelt;
use crate::check::values::faulty_values::FaultyValues;
use crate::check::values::path::expression;
use crate::check::values::raw::{Raw, beside_source, raw};
use crate::check::values::replica::Instance;
use crate::check::values::shared_values::{Answer, SharedValues};
use crate::check::values::value_type::{Typed, check_match};
use crate::diagnostic::{Diagnostic, codes, quoted};
use crate::limits::{Budget, SOURCE_BYTES, SOURCE_VALUES};
use crate::model::{ComponentElement, Composite, Property};
use crate::source::{Location, Text};
use crate::syntax::escaped;

/// The properties of all composites of a fleet, with their values.
pub(crate) struct Parameters<'a> {
    /// By the places of the fleet's units.
    units: Vec<Declared<'a>>,
    options: &'a Options,
    values: Budget,
    text: Budget,
    /// The elements that paths of sources look at.
    elements: Rc<Budget>,
    pub(crate) faulty: Rc<FaultyValues>,
    /// The first `source` at which it is reported that a composite property, by its place, has no value.
    lacks: HashMap<Location, Location>,
}

/// The properties of one composite, those of what it includes among them.
#[derive(Default)]
struct Declared<'a> {
    by_name: BTreeMap<&'a str, Parameter<'a>>,
    /// The fault of a `source` that leads to none of them: any of them may be meant.
    source: Option<Faulty>,
    /// The fault of one of them without a name: any name may be meant for it.
    name: Option<Faulty>,
    /// The component that the composite implements.
    owner: Option<&'a ComponentElement>,
}

struct Parameter<'a> {
    composite: &'a Composite,
    property: &'a Property,
    given: Option<Given<'a>>,
    /// True if it has to be given a value, and what the component says that the composite implements comes to none.
    lacks_value: bool,
    is_used: bool,
    /// Its values, once they are asked for.
    whole: Option<Rc<SharedValues<'a>>>,
}

impl<'a> Parameter<'a> {
    /// The variable of the environment that counts where nothing else gives a value.
    fn variable(&self, options: &'a Options) -> Option<&'a Text> {
        options.variable(self.property.env()?)
    }
}

/// The value that counts in place of the value that a composite gives its property itself.
#[derive(Clone, Copy)]
enum Given<'a> {
    /// A setting, or a variable of the environment.
    Outside(&'a Text),
    /// The property of the component that the composite implements.
    Component(ValueSite<'a>, &'a Property),
    /// Perhaps something that a fault of that component hides.
    Unknown,
}

/// The surroundings of a property that has a value.
#[derive(Clone, Copy)]
pub(crate) struct ValueSite<'a> {
    pub(crate) unit: usize,
    pub(crate) composite: &'a Composite,
    /// The replica whose numbers are in its texts.
    pub(crate) instance: Option<&'a Instance>,
}

impl<'a> ValueSite<'a> {
    /// The surroundings of the properties of a component.
    fn of(member: &Member<'a>) -> Self {
        Self { unit: member.unit, composite: member.composite, instance: member.instance }
    }
}

impl<'a> Parameters<'a> {
    /// Collects the properties and gives them what counts in place of their own values.
    pub(crate) fn of(fleet: &Fleet<'a>, options: &'a Options, report: &mut Report<'_>) -> Self {
        let mut parameters = Self { faulty: Rc::clone(&fleet.faulty_values), ..Self::new(options, &fleet.elements) };
        for (place, unit) in fleet.units.iter().enumerate() {
            let owner = fleet.scopes[unit.scope].owner.map(|owner| &fleet.members[owner]);
            parameters.declare(place, (&unit.composites, unit.is_absent), owner, report);
        }
        parameters.set(fleet, report);
        parameters.judge(fleet, false, report);
        parameters.take_for_expressions(fleet, report);
        parameters
    }

    /// Those of no composite yet.
    pub(crate) fn new(options: &'a Options, elements: &Rc<Budget>) -> Self {
        Self {
            units: Vec::new(),
            options,
            values: Budget::of(SOURCE_VALUES),
            text: Budget::of(SOURCE_BYTES),
            elements: Rc::clone(elements),
            faulty: Rc::default(),
            lacks: HashMap::new(),
        }
    }

    /// The same without bounds on the number and length of values, where whoever has bounds finds them as well.
    pub(crate) fn unbounded(mut self) -> Self {
        (self.values, self.text) = (Budget::of(u64::MAX), Budget::of(u64::MAX));
        self
    }

    /// Declares the properties of a unit of these composites, which may not be there, in place of others. `owner` is
    /// the component that the first of them implements. Repeated ones are reported.
    pub(crate) fn declare(
        &mut self,
        unit: usize,
        (composites, is_absent): (&[&'a Composite], bool),
        owner: Option<&Member<'a>>,
        report: &mut Report<'_>,
    ) {
        let mut declared = declared(composites, is_absent, report);
        if let Some(owner) = owner {
            declared.owner = Some(owner.component);
            for property in &owner.component.properties {
                if let Some(parameter) = declared.by_name.get_mut(property.name.as_str()) {
                    // A second one is reported.
                    parameter.given.get_or_insert(Given::Component(ValueSite::of(owner), property));
                }
            }
        }
        for (name, parameter) in declared.by_name.iter_mut().filter(|(_, parameter)| parameter.given.is_none()) {
            let given = match owner {
                Some(owner) => owner.may_give_others().then_some(Given::Unknown),
                None => {
                    let mut settings = self.options.settings.iter();
                    settings.find(|setting| *setting.name == **name).map(|setting| Given::Outside(&setting.value))
                }
            };
            parameter.given = given.or_else(|| parameter.variable(self.options).map(Given::Outside));
        }
        if self.units.len() <= unit {
            self.units.resize_with(unit + 1, Declared::default);
        }
        self.units[unit] = declared;
    }

    /// Holds what comes from the command line and the environment to the types of the properties, or else what
    /// components give properties that were not taken: it has to be right all the same, and there where it has to be.
    fn judge(&mut self, fleet: &Fleet<'a>, is_of_components: bool, report: &mut Report<'_>) {
        for (place, unit) in fleet.units.iter().enumerate().filter(|(_, unit)| !(is_of_components && unit.is_absent)) {
            if let Some(owner) = fleet.scopes[unit.scope].owner.filter(|_| is_of_components) {
                report.about(&fleet.members[owner]);
            }
            for property in unit.composites.iter().flat_map(|composite| &composite.properties) {
                let parameter = self.units[place].by_name.get(property.name.as_str());
                let is_asked = parameter.is_some_and(|parameter| match parameter.given {
                    Some(Given::Outside(_)) => !is_of_components,
                    Some(Given::Component(..)) => is_of_components && parameter.whole.is_none(),
                    Some(Given::Unknown) | None => false,
                });
                if is_asked {
                    let _ = self.whole(place, &property.name, report);
                }
            }
            report.about_all();
        }
    }

    /// The values behind the `source` of a component's property with that, or its own. Faults are reported.
    fn shared(
        &mut self,
        place: ValueSite<'a>,
        property: &'a Property,
        report: &mut Report<'_>,
    ) -> Judged<(Rc<SharedValues<'a>>, Option<Location>)> {
        if place.instance.is_some_and(|instance| instance.hides(property, &place.composite.document)) {
            return Err(Faulty);
        }
        if let Some(source) = property.source() {
            let whole = self.resolve(place.unit, source, report)?;
            if !whole.raw.0.is_empty() {
                let named = expression(source).and_then(|(name, _)| self.units[place.unit].by_name.get(name));
                let is_given = |one: &Property| one.has_value() || one.must_supply().is_some_and(|must| must.value);
                if named.is_some_and(|named| is_given(named.property)) {
                    beside_source(property, source, &place.composite.document, report);
                }
                return Ok((whole, Some(source.location)));
            }
            // A source without a value leaves what stands in the property itself, as SCA says.
        }
        Ok((SharedValues::new(raw(property, &place.composite.document, place.instance, report)?), None))
    }

    /// The values of a component's property as its class takes them, what is inside of an `element`, with the `source`
    /// that leads there. Faults are reported.
    pub(crate) fn taken(
        &mut self,
        member: &Member<'a>,
        property: &'a Property,
        report: &mut Report<'_>,
    ) -> Judged<(Raw<'a>, Option<Location>)> {
        let (values, source) = self.shared(ValueSite::of(member), property, report)?;
        Ok((values.into_raw().inside_elements_of(property), source))
    }

    /// Checks that the properties of a component that say a type take their values from properties of types that fit.
    pub(crate) fn types(&self, member: &Member<'a>, report: &mut Report<'_>) {
        for property in &member.component.properties {
            if let Some(source) = property.source()
                && let Some(from) = self.declaration(member.unit, source)
            {
                let own = Typed { property, document: &member.composite.document };
                check_match(own, from, Some(source.location), report);
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
        one.label(owner.name.location, "this component gives no value").help(help)
    }

    fn named_by<'n>(&self, unit: usize, source: &'n str) -> Option<(&'n str, &Parameter<'a>)> {
        let (name, _) = expression(source)?;
        Some((name, self.units[unit].by_name.get(name)?))
    }

    /// True if the reason is reported why the composite property that a `source` names has no value: it is misspelt
    /// where it is given, or comes from a file, as those of components can.
    pub(crate) fn is_lack_reported(&self, unit: usize, source: &Text) -> bool {
        let declared = &self.units[unit];
        let Some((name, Parameter { composite, property, .. })) = self.named_by(unit, source) else {
            return false;
        };
        let is_declared = |name: &str| declared.by_name.contains_key(name);
        let is_told = self.lacks.get(&property.name.location).is_some_and(|first| *first != source.location);
        is_told
            || declared.owner.is_some_and(|owner| is_misspelt(name, owner, is_declared))
            || property.origin.element(&composite.document).attribute("file").is_some()
    }

    /// Notes that it is reported at a `source` that the composite property that it names has no value. Other uses of
    /// the property lack the same one.
    pub(crate) fn tell_lack(&mut self, unit: usize, source: &Text) {
        if let Some((_, parameter)) = self.named_by(unit, source) {
            let place = parameter.property.name.location;
            self.lacks.entry(place).or_insert(source.location);
        }
    }

    /// Lets any property of a composite be meant by what is wrong in it.
    pub(crate) fn leave_open(&mut self, unit: usize) {
        self.units[unit].source = Some(Faulty);
    }

    /// Counts what composites that are not fully known take from those around them.
    fn pass_on(&mut self, fleet: &Fleet<'a>) {
        for unit in (0..self.units.len()).rev() {
            // What a misspelt property of the component takes that this composite implements is meant to be used.
            if let Some(owner) = fleet.scopes[fleet.units[unit].scope].owner.map(|owner| &fleet.members[owner]) {
                let sources = owner.component.properties.iter().filter_map(|given| {
                    let is_known = self.units[unit].by_name.contains_key(given.name.as_str());
                    expression(given.source()?).filter(|_| !is_known)
                });
                for (name, _) in sources.collect::<Vec<_>>() {
                    self.units[owner.unit].by_name.get_mut(name).into_iter().for_each(|outer| outer.is_used = true);
                }
            }
            let is_open = self.units[unit].source.is_some() || fleet.scopes[fleet.units[unit].scope].fault.is_some();
            let open = self.units[unit].by_name.values().filter(|parameter| is_open || parameter.is_used);
            let from: Vec<(usize, &'a str)> = open
                .filter_map(|parameter| match parameter.given {
                    Some(Given::Component(place, given)) => Some((place.unit, expression(given.source()?)?.0)),
                    _ => None,
                })
                .collect();
            for (outer, name) in from {
                self.units[outer].by_name.get_mut(name).into_iter().for_each(|outside| outside.is_used = true);
            }
        }
    }

    /// The values that `source` leads to in this unit. Faults are reported.
    pub(crate) fn resolve(&mut self, unit: usize, source: &Text, report: &mut Report<'_>) -> Answer<'a> {
        let whole = self.follow(unit, source, report)?;
        // One value is no list.
        let count = Some(whole.raw.0.len()).filter(|count| *count > 1).unwrap_or_default();
        let exceeded = [
            (&self.values, count, "4000000 values", "takes all values of a property has a copy of each value"),
            (&self.text, whole.raw.bytes(), "64 MB of text", "takes a long text has a copy of it"),
        ]
        .into_iter()
        .find(|(budget, cost, ..)| !budget.spend(*cost as u64));
        let Some((budget, _, most, has)) = exceeded else { return Ok(whole) };
        if budget.is_to_report() {
            let message = format!("the components take more than {most} by `source`");
            let help = format!("use fewer: each component that {has}");
            report.push(Diagnostic::new(&codes::FLEET_TOO_LARGE, source.location, message).help(help));
        }
        Err(Faulty)
    }

    /// Reports the properties that have to have a value and have none, and those that nothing uses.
    pub(crate) fn finish(mut self, fleet: &Fleet<'a>, report: &mut Report<'_>) {
        self.judge(fleet, true, report);
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
                let is_given = parameter.given.is_some() && !parameter.lacks_value
                    || owner.is_some_and(|owner| is_misspelt(name, owner.component, is_declared));
                if is_asked_for(property) && !is_given {
                    owner.into_iter().for_each(|owner| report.about(owner));
                    report.push(self.missing(place, property, self.options.assume_classes));
                    report.about_all();
                }
                let origin = property.origin;
                let is_open = declared.source.is_some() || fleet.scopes[unit.scope].fault.is_some();
                // No `source` can name one that is of the wrong form, which is reported.
                let is_open = is_open || name.contains(|c: char| c.is_whitespace() || c == '/');
                let is_open = is_open || report.diagnostics().is_meant(origin.file(), name);
                if !used.contains(&(origin.file(), origin.element)) && !is_open {
                    let message = format!("no component uses the property {} of the composite", quoted(name));
                    let one = Diagnostic::new(&codes::UNUSED_PROPERTY, name.location, message);
                    let components = unit.composites.iter().flat_map(|composite| &composite.components);
                    let namesakes = components.filter_map(|component| {
                        let own = component.properties.iter().find(|one| one.name == *name.as_str())?;
                        own.source().is_none().then_some((component, own))
                    });
                    report.push(match namesakes.into_iter().next() {
                        Some((component, own)) => one
                            .label(own.name.location, "this component gives its property a value of its own")
                            .help(format!(
                                "let component {} take the value, with `source=\"${}\"` in place of its own, or remove \
                                 the property of the composite",
                                quoted(&component.name),
                                escaped(name)
                            )),
                        None => one.help(format!(
                            "remove it, or use its value in a component with `source=\"${}\"`",
                            escaped(name)
                        )),
                    });
                }
            }
        }
    }
}

/// The properties of a composite and of what it includes. Repeated ones are reported.
fn declared<'a>(composites: &[&'a Composite], is_absent: bool, report: &mut Report<'_>) -> Declared<'a> {
    let mut all = Declared::default();
    let properties = composites.iter().flat_map(|one| one.properties.iter().map(move |property| (*one, property)));
    for (composite, property) in properties {
        if property.name.is_empty() {
            all.name = Some(Faulty);
            continue;
        }
        let parameter = Parameter { composite, property, given: None, lacks_value: false, is_used: false, whole: None };
        match all.by_name.get(property.name.as_str()) {
            Some(first) if std::ptr::eq(first.property, property) => {}
            // What is not there may say otherwise what another composite says that is there in place of it.
            Some(first) if !is_absent || std::ptr::eq(first.composite, composite) => {
                let message = format!("the composite has two properties {}", quoted(&property.name));
                let one = Diagnostic::new(&codes::COMPOSITE_PART_REPEATED, property.name.location, message)
                    .label(first.property.name.location, "the first");
                report.push(one.rule("ASM60014").help("give each its own name"));
            }
            _ => _ = all.by_name.insert(&property.name, parameter),
        }
    }
    all
}
