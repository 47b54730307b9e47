//! Conversion of values to what the declarations of properties ask for.

use std::collections::HashSet;
use std::fmt;

use saoms_api::host::PropertyValue;
use saoms_api::host::declaration::{PropertyKind, parse_scalar};

use crate::check::report::{Report, replacing};
use crate::check::unfolding::replica::{COUNTERS, Instance};
use crate::check::unfolding::replica_plan::as_index;
use crate::check::values::raw::{Piece, Raw};
use crate::diagnostic::{Code, Diagnostic, codes, quoted};
use crate::expression::{INDEX, has_expression, is_name};
use crate::registry::PropertyDeclaration;
use crate::source::{Location, Text};
use crate::syntax::{Element, escaped};

/// A property, or a part of a complex one: as in `charger.x`.
#[derive(Clone, Copy)]
pub(crate) struct Path<'p> {
    pub(crate) outer: Option<&'p Path<'p>>,
    pub(crate) name: &'p str,
}

impl fmt::Display for Path<'_> {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.outer {
            Some(outer) => write!(out, "{outer}.{}", self.name),
            None => out.write_str(self.name),
        }
    }
}

/// The place of a value, and the `source` that leads there.
#[derive(Clone, Copy)]
pub(crate) struct Use {
    /// The place of diagnostics without a value to point at.
    pub(crate) property: Location,
    /// The `source` that leads to a value elsewhere.
    pub(crate) source: Option<Location>,
}

/// Converts values, and reports those that are wrong.
#[derive(Default)]
pub(crate) struct Conversion {
    /// The faults in values that many components may use, so that each is reported once.
    shared: HashSet<(Location, &'static str, String)>,
}

impl Conversion {
    /// The value of a property with one or more declarations, all of which have to accept it. `None` when there is a
    /// fault, which is reported.
    pub(crate) fn convert(
        &mut self,
        raw: Raw<'_>,
        path: Path<'_>,
        declarations: &[&PropertyDeclaration],
        used: Use,
        report: &mut Report<'_>,
    ) -> Option<PropertyValue> {
        let main = declarations.first()?;
        let mut pieces = raw.0;
        if main.many {
            let values = pieces.into_iter().map(|piece| self.piece(piece, path, declarations, used, report));
            // All are looked at, so that all faults are found.
            let values: Vec<Option<PropertyValue>> = values.collect();
            return values.into_iter().collect::<Option<_>>().map(PropertyValue::Many);
        }
        if let Some(second) = pieces.get(1) {
            let message =
                format!("the property {} takes one value, and here are {}", quoted_path(path), pieces.len());
            let one = Diagnostic::new(&codes::MANY_VALUES, second.location(), message);
            self.report(one.label(pieces[0].location(), "the first"), path, main, used, report);
            return None;
        }
        match pieces.pop() {
            Some(piece) => self.piece(piece, path, declarations, used, report),
            None if main.kind == PropertyKind::Complex => {
                self.piece(Piece::Elements([].into(), None), path, declarations, used, report)
            }
            None => {
                let nothing = Text::new("".into(), used.property);
                self.one(&nothing, path, declarations, used, report)
            }
        }
    }

    fn piece(
        &mut self,
        piece: Piece<'_>,
        path: Path<'_>,
        declarations: &[&PropertyDeclaration],
        used: Use,
        report: &mut Report<'_>,
    ) -> Option<PropertyValue> {
        let main = declarations.first()?;
        match (piece, main.kind) {
            (Piece::Elements(elements, instance), PropertyKind::Complex) => {
                self.complex((&elements, instance), path, main, used, report)
            }
            (Piece::Whole(_, root, instance), PropertyKind::Complex) => {
                // A part by its name, or all of them in an element around them.
                let is_part = main.properties.iter().any(|part| part.name == root.local_name());
                let elements = if is_part { vec![root] } else { root.children().collect() };
                self.complex((&elements, instance), path, main, used, report)
            }
            (Piece::Whole(text, ..), _) => self.one(text, path, declarations, used, report),
            (Piece::Elements(elements, _), _) => {
                let at = elements.first().map_or(used.property, |first| first.name_location());
                let message = format!(
                    "the property {} has elements inside: expected {}",
                    quoted_path(path),
                    main.expected()
                );
                self.report(Diagnostic::new(&codes::VALUE_TYPE, at, message), path, main, used, report);
                None
            }
            (Piece::Text(text), PropertyKind::Complex) => {
                let found = if text.is_empty() { "nothing".to_owned() } else { quoted(&text) };
                let message =
                    format!("property {}: found {found}, expected {}", quoted_path(path), main.expected());
                let code = if text.is_empty() { &codes::VALUE_EMPTY } else { &codes::VALUE_TYPE };
                let one = Diagnostic::new(code, text.location, message);
                self.report(one.help("write each as an element inside"), path, main, used, report);
                None
            }
            (Piece::Text(text), _) => self.one(&text, path, declarations, used, report),
        }
    }

    /// The value of a property that takes one text.
    fn one(
        &mut self,
        text: &Text,
        path: Path<'_>,
        declarations: &[&PropertyDeclaration],
        used: Use,
        report: &mut Report<'_>,
    ) -> Option<PropertyValue> {
        self.text(text, path, declarations.iter().copied(), used, report)?;
        Some(PropertyValue::Text(text.value.clone()))
    }

    /// Holds a text to the declarations of a property that takes one; `None` when there is a fault, which is reported.
    pub(crate) fn text<'d>(
        &mut self,
        text: &Text,
        path: Path<'_>,
        declarations: impl Iterator<Item = &'d PropertyDeclaration>,
        used: Use,
        report: &mut Report<'_>,
    ) -> Option<()> {
        for declaration in declarations {
            if let Err(message) = declaration.allows(text) {
                let one = wrong(text, path, declaration, &message, report.has_index());
                self.report(one, path, declaration, used, report);
                return None;
            }
        }
        Some(())
    }

    fn complex(
        &mut self,
        (elements, instance): (&[Element<'_>], Option<&Instance>),
        path: Path<'_>,
        declaration: &PropertyDeclaration,
        used: Use,
        report: &mut Report<'_>,
    ) -> Option<PropertyValue> {
        let parts = &declaration.properties;
        let mut given: Vec<Vec<Element<'_>>> = vec![Vec::new(); parts.len()];
        let mut is_sound = true;
        for element in elements {
            let name = element.local_name();
            let at = element.name_location();
            match parts.iter().position(|part| part.name == name) {
                Some(part) if parts[part].many || given[part].is_empty() => given[part].push(*element),
                Some(part) => {
                    let message =
                        format!("the property {} has two parts {}", quoted_path(path), quoted(name));
                    let one = Diagnostic::new(&codes::PROPERTY_REPEATED, at, message);
                    let one = one.label(given[part][0].name_location(), "the first");
                    self.report(one, path, declaration, used, report);
                    is_sound = false;
                }
                None => {
                    let names = parts.iter().map(|part| part.name.as_str());
                    let message = format!("the property {} has no part {}", quoted_path(path), quoted(name));
                    let one =
                        report.unknown(&codes::UNKNOWN_PROPERTY, at, message, name, ("its parts are", names));
                    self.report(one, path, declaration, used, report);
                    is_sound = false;
                }
            }
        }
        let mut values = Vec::new();
        for (part, given) in parts.iter().zip(given) {
            let inner = Path { outer: Some(&path), name: &part.name };
            if given.is_empty() {
                if part.required {
                    let message = format!(
                        "the property {} is missing: expected {}",
                        quoted_path(inner),
                        part.expected()
                    );
                    let one = Diagnostic::new(&codes::PROPERTY_MISSING, used.property, message);
                    self.report(one, inner, part, used, report);
                    is_sound = false;
                }
                continue;
            }
            let used = Use { property: given[0].name_location(), ..used };
            match self.convert(Raw::of_elements(&given, instance), inner, &[part], used, report) {
                Some(value) => values.push((part.name.as_str().into(), value)),
                None => is_sound = false,
            }
        }
        is_sound.then_some(PropertyValue::Complex(values.into()))
    }

    /// Reports a fault, with what there is to know about the property.
    fn report(
        &mut self,
        mut one: Diagnostic,
        path: Path<'_>,
        declaration: &PropertyDeclaration,
        used: Use,
        report: &mut Report<'_>,
    ) {
        if let Some(source) = used.source {
            // That it is not of the type of the composite's property is told.
            if report.has_told(&codes::COMPOSITE_VALUE_TYPE, one.location) {
                return;
            }
            if !self.shared.insert((one.location, one.code.id, path.to_string())) {
                return;
            }
            one = one.label(source, format!("used here as {}", quoted_path(path)));
        }
        if let Some(about) = about(path, declaration) {
            one = one.help(about);
        }
        report.push(one);
    }
}

pub(crate) fn quoted_path(path: Path<'_>) -> String {
    quoted(&path.to_string())
}

/// The purpose of a property, and its default.
fn about(path: Path<'_>, declaration: &PropertyDeclaration) -> Option<String> {
    let default = declaration.default.as_ref().map(|default| format!("the default is {}", quoted(default)));
    let doc = declaration.doc.replace('\n', " ");
    let doc = doc.trim().trim_end_matches('.');
    match (doc.is_empty(), default) {
        (true, None) => None,
        (true, Some(default)) => Some(default),
        (false, None) => Some(format!("{}: {doc}", quoted_path(path))),
        (false, Some(default)) => Some(format!("{}: {doc}; {default}", quoted_path(path))),
    }
}

/// A text that is not what the declaration asks for, as its rule says it.
fn wrong(
    text: &Text,
    path: Path<'_>,
    declaration: &PropertyDeclaration,
    message: &str,
    has_index: bool,
) -> Diagnostic {
    // The rule repeats all of the text, however long.
    let rest = message.strip_prefix(&format!("`{}`", text.trim()));
    let said = rest.map_or_else(|| message.to_owned(), |rest| format!("{}{rest}", quoted(text.trim())));
    let code = code(text, declaration, rest.unwrap_or_default());
    let one = Diagnostic::new(code, text.location, format!("property {}: {said}", quoted_path(path)));
    if let Some(meant) = meant(text.trim(), declaration) {
        return one.suggest(replacing(text, &meant), text.location, escaped(&meant));
    }
    let is_counter = text.trim() == INDEX || has_index && COUNTERS.contains(&text.trim());
    let by_index = if is_counter { Some(format!("${{{INDEX}}}")) } else { as_index(text.trim()) };
    match by_index.filter(|meant| meant != text.trim()) {
        Some(meant) if has_index => {
            return one.suggest(replacing(text, &meant), text.location, escaped(&meant));
        }
        Some(meant) => {
            return one
                .help(format!("{} is for replicas: give the component a `saoms:count`", quoted(&meant)));
        }
        None => {}
    }
    if has_expression(text) {
        let one = one.help("`${...}` stands for a number in components with a `saoms:count` alone");
        let name = text.trim().strip_prefix("${").and_then(|rest| rest.strip_suffix('}')).map(str::trim);
        return match name.filter(|name| is_name(name) && *name != INDEX) {
            Some(name) => one.help(by_source(name)),
            None => one,
        };
    }
    let argument = text.trim().strip_prefix("$(arg ").and_then(|rest| rest.strip_suffix(')'));
    match argument.or_else(|| text.trim().strip_prefix('$')).map(str::trim).filter(|name| is_name(name)) {
        Some(name) => one.help(by_source(name)),
        None => one,
    }
}

fn by_source(name: &str) -> String {
    format!("write `source=\"${name}\"` for the value of the property {} of the composite", quoted(name))
}

fn code(text: &str, declaration: &PropertyDeclaration, said: &str) -> &'static Code {
    if text.trim().is_empty() {
        return &codes::VALUE_EMPTY;
    }
    let beyond = [" is out of range", " is negative"].into_iter().any(|what| said.starts_with(what));
    match parse_scalar(declaration.kind, text) {
        _ if beyond => &codes::VALUE_RANGE,
        Some(_) => &codes::VALUE_NOT_ALLOWED,
        None => &codes::VALUE_TYPE,
    }
}

/// The probable meaning of a wrong text: an allowed one that is spelt alike, another way to say yes or no, a decimal comma, a
/// number with its unit.
fn meant(text: &str, declaration: &PropertyDeclaration) -> Option<String> {
    if text.is_empty() {
        return None;
    }
    let allowed = declaration.allowed.iter().map(String::as_str);
    if let Some(near) = crate::diagnostic::nearest(text, allowed) {
        return Some(near.to_owned());
    }
    let lower = text.to_ascii_lowercase();
    let said = match (declaration.kind, lower.as_str()) {
        (PropertyKind::Boolean, "yes" | "on" | "y" | "t") => "true".to_owned(),
        (PropertyKind::Boolean, "no" | "off" | "n" | "f") => "false".to_owned(),
        (PropertyKind::Boolean, _) => {
            crate::diagnostic::nearest(text, ["true", "false"]).unwrap_or_default().to_owned()
        }
        (PropertyKind::Integer | PropertyKind::Float, _) => {
            let unit = declaration.unit.as_deref().unwrap_or_default();
            let text = text.strip_suffix(unit).unwrap_or(text).trim();
            let is_whole = declaration.kind == PropertyKind::Integer;
            let text = text.strip_suffix(".0").filter(|_| is_whole).unwrap_or(text);
            without_unit(text).unwrap_or(text).replace(',', ".")
        }
        (PropertyKind::Duration, _) => duration(&lower).unwrap_or_else(|| lower.replace(',', ".")),
        _ => lower,
    };
    (said != text && declaration.check(&said).is_ok()).then_some(said)
}

/// A number without the unit that people write behind numbers of its kind.
fn without_unit(text: &str) -> Option<&str> {
    const UNITS: [&str; 9] = ["%", "percent", "m", "cm", "mm", "ms", "s", "block", "blocks"];
    let number = text.trim_end_matches(|c: char| !c.is_ascii_digit());
    let unit = text[number.len()..].trim();
    UNITS.iter().any(|known| known.eq_ignore_ascii_case(unit)).then_some(number)
}

/// A duration whose unit is written out, or how often a second.
fn duration(text: &str) -> Option<String> {
    let digits = text.trim_end_matches(|c: char| !c.is_ascii_digit());
    let unit = text[digits.len()..].trim();
    let digits = digits.trim();
    let short = match unit {
        "hz" => {
            let often: f64 = digits.parse().ok().filter(|often| *often > 0.0)?;
            let micros = (1e6 / often).round() as u64;
            return Some(match micros.is_multiple_of(1000) {
                true => format!("{}ms", micros / 1000),
                false => format!("{micros}us"),
            });
        }
        "msec" | "msecs" | "millis" | "millisecond" | "milliseconds" => "ms",
        "usec" | "usecs" | "\u{b5}s" | "\u{3bc}s" | "micros" | "microsecond" | "microseconds" => "us",
        "sec" | "secs" | "second" | "seconds" => "s",
        "mins" | "minute" | "minutes" => "min",
        "hr" | "hrs" | "hour" | "hours" => "h",
        _ => return None,
    };
    Some(format!("{digits}{short}"))
}
