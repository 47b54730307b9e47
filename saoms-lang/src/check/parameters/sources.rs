//! Following a `source`: to a property, and into its value.

use std::rc::Rc;

use super::{Given, Parameters};
use crate::check::fleet::Fleet;
use crate::check::judged::{Faulty, Judged};
use crate::check::report::{Report, replacing};
use crate::check::values::path::{FORMS, PathFault, PathFaultKind, expression};
use crate::check::values::raw::{Piece, Raw, is_one_of_several, raw};
use crate::check::values::shared_values::{Answer, SharedValues};
use crate::check::values::value_type::Typed;
use crate::diagnostic::{Diagnostic, Severity, codes, quoted};
use crate::source::Text;
use crate::syntax::escaped;

impl<'a> Parameters<'a> {
    /// Notes what expressions use, and what they have it from. What is wrong with that is reported.
    pub(super) fn take_for_expressions(&mut self, fleet: &Fleet<'a>, report: &mut Report<'_>) {
        // From the inside out: what a name takes as a whole from a composite around is asked for there as well.
        for (unit, names) in fleet.names.iter().enumerate().rev() {
            for name in names.iter().flat_map(|names| names.used()) {
                if let Some((around, source)) = self.source_of(unit, name)
                    && let Some((whole, None)) = expression(source)
                    && let Some(around) = &fleet.names[around]
                {
                    around.ask(whole);
                }
            }
        }
        for (unit, names) in fleet.names.iter().enumerate() {
            let Some(names) = names else { continue };
            let owner = fleet.scopes[fleet.units[unit].scope].owner;
            for name in names.used() {
                let Some(parameter) = self.units[unit].by_name.get_mut(name) else { continue };
                parameter.is_used = true;
                let source = self.source_of(unit, name);
                let is_simple = source.is_none_or(|(unit, source)| self.declaration(unit, source).is_some());
                if !names.is_faulty(name) && is_simple {
                    continue;
                }
                owner.into_iter().for_each(|owner| report.about(&fleet.members[owner]));
                let _ = self.whole(unit, name, report);
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

    /// The values that a `source` leads to. Faults are reported.
    pub(super) fn follow(&mut self, place: usize, source: &Text, report: &mut Report<'_>) -> Answer<'a> {
        let known = &self.units[place].by_name;
        let simple = expression(source).filter(|(name, _)| known.contains_key(name) || is_name(name));
        let Some((name, path)) = simple else {
            return Err(self.no_path(place, source, report));
        };
        self.named(place, source, name, report)?;
        let Some(path) = path else { return self.taken_whole(place, name, report) };
        let whole = self.whole(place, name, report)?;
        let property = self.units[place].by_name[name].property;
        let found = whole.led_to(path, property, &self.elements);
        found.map_err(|fault| self.malformed(source, name.len() + 1, fault, report))
    }

    /// Finds the property that a `source` names, and notes that it is used. One that is not there is reported.
    fn named(&mut self, place: usize, source: &Text, name: &str, report: &mut Report<'_>) -> Judged<()> {
        let unit = &mut self.units[place];
        if let Some(parameter) = unit.by_name.get_mut(name) {
            parameter.is_used = true;
            return Ok(());
        }
        unit.source = Some(Faulty);
        // That it is not there is reported where a component gives it a value, or where one is declared without a name.
        if unit.name.is_some() || unit.owner.is_some_and(|owner| owner.property(name).is_some()) {
            return Err(Faulty);
        }
        // It may be the one of the composite around that is meant.
        unit.owner.into_iter().for_each(|owner| report.diagnostics().add_meant(owner.origin.file(), name));
        let names = unit.by_name.keys().copied();
        let at = report.part(source, 1..1 + name.len());
        let message = format!("the composite has no property {}", quoted(name));
        let known = ("its properties are", names);
        let one = report.unknown(&codes::UNKNOWN_SOURCE, at, message, name, known);
        report.push(match unit.by_name.is_empty() {
            true => one.help("declare it: `<property name=\"...\">...</property>` in the composite"),
            false if one.suggestions.is_empty() && unit.owner.is_some() => one.help(format!(
                "properties of the outer composite are not visible here: declare {} here, and set it in the component",
                quoted(name)
            )),
            false => one,
        });
        Err(Faulty)
    }

    /// The values of a property of this name as a whole, as components take them.
    pub(crate) fn taken_whole(&mut self, place: usize, name: &str, report: &mut Report<'_>) -> Answer<'a> {
        let whole = self.whole(place, name, report)?;
        let parameter = &self.units[place].by_name[name];
        // Where the composite does not say it, the component that it implements may.
        let typed = match parameter.given {
            Some(Given::Component(_, outside)) if parameter.property.element().is_none() => outside,
            _ => parameter.property,
        };
        Ok(whole.inside_elements_of(typed))
    }

    /// The whole value of a property that is there.
    pub(super) fn whole(&mut self, place: usize, name: &str, report: &mut Report<'_>) -> Answer<'a> {
        let Some(parameter) = self.units[place].by_name.get_mut(name) else { return Err(Faulty) };
        if let Some(known) = &parameter.whole {
            return Ok(Rc::clone(known));
        }
        let (composite, property, given) = (parameter.composite, parameter.property, parameter.given);
        let variable = parameter.variable(self.options);
        let mut whole = match given {
            Some(Given::Outside(value)) => SharedValues::new(Raw::one(value)),
            Some(Given::Component(outside, outer)) => self.shared(outside, outer, report)?.0,
            Some(Given::Unknown) => return Err(Faulty),
            None => SharedValues::new(Raw(Vec::new())),
        };
        if let (true, Some(value)) = (whole.raw.0.is_empty(), variable) {
            whole = SharedValues::new(Raw::one(value));
        }
        let typed = Typed { property, document: &composite.document };
        for piece in &whole.raw.0 {
            if let Piece::Text(text) = piece {
                typed.check(text, &self.faulty, report);
            }
        }
        if whole.raw.0.is_empty() {
            // That there is more than one, or that its text is faulty, is reported.
            if is_one_of_several(property, composite.version)
                || property.origin.element(&composite.document).has_damaged_content()
            {
                return Err(Faulty);
            }
            whole = SharedValues::new(raw(property, &composite.document, None, report)?);
        }
        if whole.raw.0.is_empty() && property.must_supply().is_some_and(|must| must.value) {
            // Reported where it should have been supplied.
            if let Some(parameter) = self.units[place].by_name.get_mut(name) {
                parameter.lacks_value = true;
            }
            return Err(Faulty);
        }
        let whole = whole.given_to(property);
        if let Some(parameter) = self.units[place].by_name.get_mut(name) {
            parameter.whole = Some(Rc::clone(&whole));
        }
        Ok(whole)
    }

    /// Reports a `source` that is no path from a property.
    fn no_path(&mut self, place: usize, source: &Text, report: &mut Report<'_>) -> Faulty {
        let unit = &mut self.units[place];
        unit.source = Some(Faulty);
        // A replica has the value of an expression here.
        let written = Text::new(report.written(source.location).into(), source.location);
        let source = if braced(&written).is_some() { &written } else { source };
        if source.contains(['$', '(']) {
            let fault = braced(source).unwrap_or_else(|| {
                PathFault::unknown(0..source.len(), format!("{} is not the path of a property", quoted(source)))
            });
            return self.malformed(source, 0, fault, report);
        }
        let message = format!("{} does not name a property of the composite", quoted(source));
        let help = match source.rsplit_once('.') {
            // As the ending of a file.
            Some((_, ending)) if ending.len() <= 9 && ending.chars().all(char::is_alphanumeric) => format!(
                "write `file=\"{source}\"` for the contents of this file, or `value=\"{source}\"` where its name is the \
                 value"
            ),
            _ => "write `$name` without braces, or `$name/part` for a part of a complex property".to_owned(),
        };
        let mut one = Diagnostic::new(&codes::SOURCE_MALFORMED, source.location, message).help(help);
        if unit.by_name.contains_key(source.as_str()) {
            one = one.suggest("insert `$`", source.location, escaped(&format!("${source}")));
        }
        report.push(one);
        Faulty
    }

    /// Reports a fault of a `source`, whose bytes count from a place in it. Another program may understand any XPath.
    fn malformed(&mut self, source: &Text, start: usize, fault: PathFault, report: &mut Report<'_>) -> Faulty {
        let PathFault { step, message, kind, instead } = fault;
        let step = start + step.start..start + step.end;
        let at = report.part(source, step.clone());
        if kind == PathFaultKind::TooMany {
            if self.elements.is_to_report() {
                let one = Diagnostic::new(&codes::FLEET_TOO_LARGE, at, message);
                report.push(one.help("name the parts, or use an attribute or a position, without `//`"));
            }
            return Faulty;
        }
        let mut one = Diagnostic::new(&codes::SOURCE_MALFORMED, at, message);
        if let Some((name, meant)) = instead
            && let Some(place) = source[step.clone()].find(&name)
        {
            let place = step.start + place;
            let place = report.part(source, place..place + name.len());
            one = one.suggest(replacing(&name, &meant), place, escaped(&meant));
        }
        if kind == PathFaultKind::Unknown {
            one = match self.options.assume_classes {
                true => one.severity(Severity::Warning).help("it is not checked: another program may understand it"),
                false => one.help(format!(
                    "a `source` is `$name`, `$name[2]`, or a path from there, `$name/step/step`: {FORMS}"
                )),
            };
        }
        report.push(one);
        Faulty
    }
}

/// The fault of `${name}`, as where texts are made of others.
fn braced(source: &str) -> Option<PathFault> {
    let (name, _) = source.strip_prefix("${")?.split_once('}')?;
    let written = format!("${{{name}}}");
    let fault = PathFault::unknown(0..written.len(), "write the property's name without braces here");
    is_name(name.trim()).then(|| PathFault { instead: Some((written, format!("${}", name.trim()))), ..fault })
}

/// True if it can be the name of a property, as far as that tells it from other parts of a path.
fn is_name(name: &str) -> bool {
    let is_inner = |letter: char| letter.is_alphanumeric() || matches!(letter, '_' | '-' | '.' | ':');
    !name.is_empty() && name.chars().all(is_inner)
}
