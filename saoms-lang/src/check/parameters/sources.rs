//! Following a `source`: to a property, into its value, or through an XPath.

use std::rc::Rc;

use super::{Given, Parameters};
use crate::check::fleet::Fleet;
use crate::check::path::{Fault, expression, steps};
use crate::check::raw::{Piece, Raw, raw};
use crate::check::report::{Report, replacing};
use crate::check::value_type::{self, Typed};
use crate::check::whole::Whole;
use crate::check::xpath::XPath;
use crate::check::{Setting, Variable};
use crate::diagnostic::{Diagnostic, Severity, codes, quoted};
use crate::model::Property;
use crate::source::Text;
use crate::xml::{Element, escaped};

impl<'a> Parameters<'a> {
    /// Notes what expressions use, and what they have it from. What is wrong with that is reported.
    pub(super) fn take_for_expressions(&mut self, fleet: &Fleet<'a>, report: &mut Report<'_>) {
        // From the inside out: what a name takes as a whole from a composite around is asked for there as well.
        for (unit, names) in fleet.names.iter().enumerate().rev() {
            for name in names.iter().flat_map(|names| names.used()) {
                if let Some((around, source)) = self.source_of(unit, &name)
                    && let Some((whole, None)) = expression(source)
                    && let Some(around) = &fleet.names[around]
                {
                    around.ask(whole);
                }
            }
        }
        let mut is_room_told = false;
        for (unit, names) in fleet.names.iter().enumerate() {
            let Some(names) = names else { continue };
            let owner = fleet.scopes[fleet.units[unit].scope].owner;
            for name in names.used() {
                let Some(parameter) = self.units[unit].by_name.get_mut(name.as_str()) else { continue };
                parameter.is_used = true;
                let source = self.source_of(unit, &name);
                let is_simple = source.is_none_or(|(unit, source)| self.declaration(unit, source).is_some());
                if !names.is_faulty(&name) && is_simple {
                    continue;
                }
                owner.into_iter().for_each(|owner| report.about(&fleet.members[owner]));
                let found = self.whole(unit, &name, report);
                let is_for_room = found.is_ok() && names.is_faulty(&name);
                if let Some((_, source)) = source.filter(|_| is_for_room && !is_room_told) {
                    is_room_told = true;
                    let message = "what this looks at is more than there is room for";
                    let one = Diagnostic::new(&codes::SOURCE_MALFORMED, source.location, message);
                    report.push(
                        one.help("look at fewer parts of values: a path such as `$name/part[2]` is free"),
                    );
                }
                report.about_all();
            }
        }
    }

    /// The `source` that gives a property its value, and the unit that it is written in.
    fn source_of(&self, unit: usize, name: &str) -> Option<(usize, &'a Text)> {
        match self.units[unit].by_name.get(name)?.given? {
            Given::Component(place, given) => Some((place.unit, given.source()?)),
            _ => None,
        }
    }

    /// What a `source` stands for. Faults are reported.
    pub(super) fn follow(
        &mut self,
        place: usize,
        source: &Text,
        report: &mut Report<'_>,
    ) -> Result<Rc<Whole<'a>>, ()> {
        let known = &self.units[place].by_name;
        let simple = expression(source).filter(|(name, _)| known.contains_key(name) || is_name(name));
        let Some((name, path)) = simple else { return self.by_xpath(place, source, report) };
        self.named(place, source, (name, 1), report)?;
        let whole = self.whole(place, name, report)?;
        let parameter = &self.units[place].by_name[name];
        let property = parameter.property;
        let Some(path) = path else {
            // Where the composite does not say it, the component that it implements may.
            let typed = match parameter.given {
                Some(Given::Component(_, outside)) if property.element().is_none() => outside,
                _ => property,
            };
            return Ok(self.taken_as(typed, whole));
        };
        if whole.raw().0.is_empty() {
            // What has no value has no parts either.
            return Ok(whole);
        }
        match whole.part(path) {
            // Without more steps it is the value itself.
            Ok(raw) if steps(path).nth(1).is_none() => Ok(self.taken_as(property, Whole::new(raw))),
            Ok(raw) => Ok(Whole::new(raw)),
            Err(Fault { is_understood: false, .. }) => self.by_xpath(place, source, report),
            Err(fault) => malformed(source, name.len() + 1, fault, report),
        }
    }

    /// What is taken of the values of a property.
    fn taken_as(&self, property: &Property, values: Rc<Whole<'a>>) -> Rc<Whole<'a>> {
        if self.keeps_elements { values } else { values.inside_elements_of(property) }
    }

    /// The `element` of the values that a `source` leads to, and where it is written.
    pub(in crate::check) fn element_of(&self, unit: usize, source: &str) -> Option<(&'a Text, Element<'a>)> {
        let (name, path) = expression(source)?;
        if path.is_some_and(|path| path.contains('/')) {
            return None;
        }
        let parameter = self.units[unit].by_name.get(name)?;
        if let Some(Given::Component(outside, outer)) = parameter.given
            && parameter.property.element().is_none()
        {
            let outer_element = outer.origin.element(&outside.composite.document);
            return match outer.element() {
                Some(of) => Some((of, outer_element)),
                None => self.element_of(outside.unit, outer.source()?),
            };
        }
        let element = parameter.property.origin.element(&parameter.composite.document);
        Some((parameter.property.element()?, element))
    }

    /// A `source` that nobody can follow yet as one of the outermost composite, with the properties of that which it names. `None` where there is none
    /// that says the same.
    pub(in crate::check) fn open(&self, unit: usize, source: &str) -> Option<(String, Vec<String>)> {
        let (mut unit, mut source) = (unit, source.to_owned());
        while self.units[unit].owner.is_some() {
            let (name, path) = expression(&source)?;
            let Some(Given::Component(outside, outer)) = self.units[unit].by_name.get(name)?.given else {
                return None;
            };
            source = format!("{}{}", outer.source()?.as_str(), path.unwrap_or_default());
            unit = outside.unit;
        }
        let is_in_name = |letter: char| letter.is_alphanumeric() || matches!(letter, '_' | '-' | '.' | ':');
        let after = source.split('$').skip(1);
        let names = after
            .map(|rest| rest[..rest.find(|letter| !is_in_name(letter)).unwrap_or(rest.len())].to_owned());
        let names = names.collect();
        Some((source, names))
    }

    /// Finds the property of a name that a `source` has at a byte, and notes that it is used. One that is not there is reported.
    fn named(
        &mut self,
        place: usize,
        source: &Text,
        (name, start): (&str, usize),
        report: &mut Report<'_>,
    ) -> Result<(), ()> {
        let unit = &mut self.units[place];
        if let Some(parameter) = unit.by_name.get_mut(name) {
            parameter.is_used = true;
            return Ok(());
        }
        unit.has_wrong_source = true;
        // That it is not there is told where a component gives it a value, or where one is declared without its name.
        if unit.has_nameless || unit.owner.is_some_and(|owner| owner.property(name).is_some()) {
            return Err(());
        }
        let names = unit.names();
        let at = report.part(source, start..start + name.len());
        let message = format!("the composite has no property {}", quoted(name));
        let known = ("its properties are", names.iter().copied());
        let one = report.unknown(&codes::UNKNOWN_SOURCE, at, message, name, known);
        report.push(match names.is_empty() {
            true => one.help("declare it: `<property name=\"...\">...</property>` in the composite"),
            false => one,
        });
        Err(())
    }

    /// The whole value of a property that is there.
    pub(super) fn whole(
        &mut self,
        place: usize,
        name: &str,
        report: &mut Report<'_>,
    ) -> Result<Rc<Whole<'a>>, ()> {
        let Some(parameter) = self.units[place].by_name.get_mut(name) else { return Err(()) };
        if let Some(known) = &parameter.whole {
            return Ok(Rc::clone(known));
        }
        let (composite, property, given) = (parameter.composite, parameter.property, parameter.given);
        let variable = parameter.variable;
        let is_judged = std::mem::replace(&mut parameter.is_judged, true);
        let typed = Typed { property, document: &composite.document };
        let mut whole = match given {
            // One that is not of its type is reported.
            Some(Given::Setting(Setting { value, .. }) | Given::Variable(Variable { value, .. })) => {
                if !value_type::is_right(typed, value) {
                    return Err(());
                }
                Whole::new(Raw::one(value))
            }
            Some(Given::Component(outside, outer)) => {
                let (whole, _) = self.shared(outside, outer, report)?;
                for piece in whole.raw().0.iter().filter(|_| !is_judged) {
                    if let Piece::Text(text) = piece
                        && !report.has_told(&codes::COMPOSITE_VALUE_TYPE, text.location)
                    {
                        value_type::given(typed, text, report);
                    }
                }
                whole
            }
            None => Whole::new(Raw(Vec::new())),
        };
        if whole.raw().0.is_empty() {
            whole = Whole::new(match variable {
                Some(Variable { value, .. }) => {
                    if !value_type::is_right(typed, value) {
                        value_type::given(typed, value, report);
                        return Err(());
                    }
                    Raw::one(value)
                }
                None => raw(property, &composite.document, None, report)?,
            });
        }
        if whole.raw().0.is_empty() && property.must_supply().is_some_and(|must| must.value) {
            // Reported where it should have been supplied.
            if let Some(parameter) = self.units[place].by_name.get_mut(name) {
                parameter.is_unset = true;
            }
            return Err(());
        }
        let whole = whole.given_to(property);
        if let Some(parameter) = self.units[place].by_name.get_mut(name) {
            parameter.whole = Some(Rc::clone(&whole));
        }
        Ok(whole)
    }

    /// What a `source` stands for that is more than a path.
    fn by_xpath(
        &mut self,
        place: usize,
        source: &Text,
        report: &mut Report<'_>,
    ) -> Result<Rc<Whole<'a>>, ()> {
        if !source.contains(['$', '(']) {
            let unit = &mut self.units[place];
            unit.has_wrong_source = true;
            let message = format!("{} names no property of the composite", quoted(source));
            let mut one = Diagnostic::new(&codes::SOURCE_MALFORMED, source.location, message)
                .help("write `$name`, or `$name/part` for a part of a complex property");
            if unit.by_name.contains_key(source.as_str()) {
                one = one.suggest("insert `$`", source.location, escaped(&format!("${source}")));
            }
            report.push(one);
            return Err(());
        }
        let key = (place, source.to_string());
        if let Some((first, found)) = self.found.get(&key) {
            return Ok(Rc::clone(found).moved(*first, source.location));
        }
        let xpath = match XPath::parse(source) {
            Ok(xpath) => xpath,
            Err(fault) => {
                self.units[place].has_wrong_source = true;
                return malformed(source, 0, fault, report);
            }
        };
        let named = xpath.variables();
        let mut variables = Vec::with_capacity(named.len());
        // With a fault in one of them the others are used all the same.
        let known = named.iter().map(|(name, at)| self.named(place, source, (name, at.start), report));
        known.fold(Ok(()), Result::and)?;
        for (name, _) in &named {
            variables.push((name.clone(), self.whole(place, name, report)?));
        }
        // Of the first for which there is no room that is reported.
        if self.parts_left.get() == 0 {
            return Err(());
        }
        let found = match xpath.evaluate(&variables, &self.parts_left, source.location) {
            Ok(found) => found,
            // What has no value has no parts either.
            Err(_)
                if !variables.is_empty() && variables.iter().all(|(_, whole)| whole.raw().0.is_empty()) =>
            {
                return Ok(Whole::new(Raw(Vec::new())));
            }
            Err(fault) => return malformed(source, 0, fault, report),
        };
        let found = Whole::new(found);
        let found = match &named[..] {
            [(only, _)] => self.taken_as(self.units[place].by_name[only.as_str()].property, found),
            _ => found,
        };
        self.found.insert(key, (source.location, Rc::clone(&found)));
        Ok(found)
    }
}

/// Reports a fault of a `source`, whose bytes count from a place in it. Whoever runs a composite of another program may understand more than XPath 1.0.
fn malformed<T>(source: &Text, start: usize, fault: Fault, report: &mut Report<'_>) -> Result<T, ()> {
    let Fault { step, message, is_understood, instead } = fault;
    let step = start + step.start..start + step.end;
    let at = report.part(source, step.clone());
    let mut one = Diagnostic::new(&codes::SOURCE_MALFORMED, at, message);
    if let Some((name, meant)) = instead
        && let Some(place) = source[step.clone()].find(&name)
    {
        let place = step.start + place;
        let place = report.part(source, place..place + name.len());
        one = one.suggest(replacing(&name, &meant), place, escaped(&meant));
    }
    report.push(match (is_understood, report.assumes) {
        (true, _) => one,
        (false, true) => {
            one.severity(Severity::Warning).help("another program may understand it: it is taken as given")
        }
        (false, false) => one.help(
            "a `source` is `$name`, a path from there as `$name/part[2]/@attribute`, or another XPath 1.0",
        ),
    });
    Err(())
}

/// Whether it can be the name of a property, as far as that tells it from other parts of an XPath.
fn is_name(name: &str) -> bool {
    let is_inner = |letter: char| letter.is_alphanumeric() || matches!(letter, '_' | '-' | '.' | ':');
    !name.is_empty() && name.chars().all(is_inner)
}
