//! Conversion of values to what the declarations of properties ask for.

use std::fmt;

use saoms_api::host::{PropertyValue, declaration::PropertyKind, declaration::Scalar};
use smol_str::SmolStr;

use super::wrong_text;
use crate::check::report::Report;
use crate::check::values::{faulty_values::FaultyValues, raw::Piece, raw::Raw, replica::Instance};
use crate::diagnostic::{Diagnostic, codes, quoted};
use crate::registry::PropertyDeclaration;
use crate::source::{Location, Text};
use crate::syntax::Element;

/// A property, or a part of a complex one, that a value is converted for.
#[derive(Clone, Copy)]
pub(crate) struct Target<'p> {
    /// The property that it is a part of.
    pub(crate) outer: Option<&'p Target<'p>>,
    pub(crate) declaration: &'p PropertyDeclaration,
    /// The place of diagnostics without a value to point at.
    pub(crate) at: Location,
    /// The `source` that leads to a value elsewhere.
    pub(crate) source: Option<Source<'p>>,
}

/// A `source` of a component, and what is known of the values that others take as well.
#[derive(Clone, Copy)]
pub(crate) struct Source<'p> {
    pub(crate) at: Location,
    pub(crate) faulty: &'p FaultyValues,
    /// True for a component that is a replica, or inside one.
    pub(crate) is_copy: bool,
}

/// As in `charger.x`.
impl fmt::Display for Target<'_> {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.outer {
            Some(outer) => write!(out, "{outer}.{}", self.declaration.name),
            None => out.write_str(&self.declaration.name),
        }
    }
}

impl Target<'_> {
    pub(crate) fn quoted(&self) -> String {
        quoted(&self.to_string())
    }

    /// The purpose of the property, and its default.
    fn about(&self) -> Option<String> {
        let default = self.declaration.default.as_ref();
        let default = default.map(|default| format!("the default is {}", quoted(default)));
        let doc = self.declaration.doc.replace('\n', " ");
        let doc = doc.trim().trim_end_matches('.');
        match (doc.is_empty(), default) {
            (true, default) => default,
            (false, None) => Some(format!("{}: {doc}", self.quoted())),
            (false, Some(default)) => Some(format!("{}: {doc}; {default}", self.quoted())),
        }
    }
}

/// A value, converted.
pub(crate) struct Converted {
    pub(crate) value: PropertyValue,
    /// The value with the texts that the composite gives, where one of them is not the usual one of its scalar.
    pub(crate) written: Option<PropertyValue>,
}

impl Converted {
    /// A value that consists of these.
    fn of(parts: Vec<Self>, whole: impl Fn(Vec<PropertyValue>) -> PropertyValue) -> Self {
        let written = |part: &Self| part.written.as_ref().unwrap_or(&part.value).clone();
        let is_unusual = parts.iter().any(|part| part.written.is_some());
        let written = is_unusual.then(|| whole(parts.iter().map(written).collect()));
        Self { value: whole(parts.into_iter().map(|part| part.value).collect()), written }
    }
}

/// The value of a property. `None` when there is a fault, which is reported.
pub(crate) fn convert(raw: &Raw<'_>, target: Target<'_>, report: &mut Report<'_>) -> Option<Converted> {
    let pieces = &raw.0;
    if target.declaration.many {
        // All are looked at, so that all faults are found.
        let values: Vec<Option<Converted>> = pieces.iter().map(|piece| one_value(piece, target, report)).collect();
        let values = values.into_iter().collect::<Option<_>>()?;
        return Some(Converted::of(values, |values| PropertyValue::Many(values.into())));
    }
    if let [first, second, ..] = &pieces[..] {
        let message = format!("the property {} allows one value, found {}", target.quoted(), pieces.len());
        let one = Diagnostic::new(&codes::MANY_VALUES, second.location(), message);
        tell(one.label(first.location(), "the first"), target, report);
        return None;
    }
    let nothing = || match target.declaration.kind {
        PropertyKind::Complex => Piece::Elements([].into(), None),
        _ => Piece::text(Text::new("".into(), target.at), None),
    };
    match pieces.first() {
        Some(piece) => one_value(piece, target, report),
        None => one_value(&nothing(), target, report),
    }
}

fn one_value(piece: &Piece<'_>, target: Target<'_>, report: &mut Report<'_>) -> Option<Converted> {
    let declaration = target.declaration;
    let one = match (piece, declaration.kind) {
        (Piece::Elements(elements, instance), PropertyKind::Complex) => {
            return complex_value(elements, *instance, target, report);
        }
        (Piece::Whole(_, root, instance), PropertyKind::Complex) => {
            // A part by its name, or all of them in an element around them.
            let is_part = declaration.properties.iter().any(|part| part.name == root.local_name());
            let elements = if is_part { vec![*root] } else { root.children().collect() };
            return complex_value(&elements, *instance, target, report);
        }
        (Piece::Text(text), PropertyKind::Complex) => {
            let found = if text.is_empty() { "nothing".to_owned() } else { quoted(text) };
            let (name, expected) = (target.quoted(), declaration.expected());
            let message = format!("property {name}: found {found}, expected {expected}");
            let code = if text.is_empty() { &codes::VALUE_EMPTY } else { &codes::VALUE_TYPE };
            Diagnostic::new(code, text.location, message).help("write each of them as an element inside")
        }
        (Piece::Whole(text, ..), _) => return text_value(text, target, report),
        (Piece::Text(text), _) => return text_value(text, target, report),
        (Piece::Elements(elements, _), _) => {
            let at = elements.first().map_or(target.at, |first| first.name_location());
            let (name, expected) = (target.quoted(), declaration.expected());
            let message = format!("the property {name} has elements inside: expected {expected}");
            Diagnostic::new(&codes::VALUE_TYPE, at, message)
        }
    };
    tell(one, target, report);
    None
}

/// The value of a property that takes one text.
fn text_value(text: &Text, target: Target<'_>, report: &mut Report<'_>) -> Option<Converted> {
    let wrong = |message: String| {
        // It is meant to be used.
        text.strip_prefix('$').into_iter().for_each(|name| report.diagnostics().add_meant(text.location.file, name));
        let one = wrong_text::diagnostic(text, target, &message, report.has_index());
        tell(one, target, report);
    };
    let value = target.declaration.check(text.value.clone()).map_err(wrong).ok()?;
    let written = (!value.is_usually(text)).then(|| Scalar::Text(text.value.clone()).into());
    Some(Converted { value: value.into(), written })
}

/// The value of a complex property, of its parts.
fn complex_value(
    elements: &[Element<'_>],
    instance: Option<&Instance>,
    target: Target<'_>,
    report: &mut Report<'_>,
) -> Option<Converted> {
    let parts = &target.declaration.properties;
    let given = given_parts(elements, target, report);
    let mut is_sound = given.iter().map(Vec::len).sum::<usize>() == elements.len();
    let (mut names, mut values): (Vec<SmolStr>, Vec<_>) = Default::default();
    for (declaration, given) in parts.iter().zip(given) {
        let inner = Target { outer: Some(&target), declaration, ..target };
        let Some(first) = given.first() else {
            if declaration.required {
                let (name, expected) = (inner.quoted(), declaration.expected());
                let message = format!("the property {name} is missing: expected {expected}");
                let one = Diagnostic::new(&codes::PROPERTY_MISSING, target.at, message);
                tell(one, inner, report);
                is_sound = false;
            }
            continue;
        };
        let inner = Target { at: first.name_location(), ..inner };
        match convert(&Raw::of_elements(&given, instance), inner, report) {
            Some(value) => {
                names.push(declaration.name.as_str().into());
                values.push(value);
            }
            None => is_sound = false,
        }
    }
    let named = |values: Vec<_>| PropertyValue::Complex(names.iter().cloned().zip(values).collect());
    is_sound.then(|| Converted::of(values, named))
}

/// The elements of each part of a complex property. Others are reported, as are second ones of a single part.
fn given_parts<'e>(elements: &[Element<'e>], target: Target<'_>, report: &mut Report<'_>) -> Vec<Vec<Element<'e>>> {
    let parts = &target.declaration.properties;
    let mut given: Vec<Vec<Element<'e>>> = vec![Vec::new(); parts.len()];
    for element in elements {
        let (name, at) = (element.local_name(), element.name_location());
        let one = match parts.iter().position(|part| part.name == name) {
            Some(part) if parts[part].many || given[part].is_empty() => {
                given[part].push(*element);
                continue;
            }
            Some(part) => {
                let message = format!("the property {} has two parts {}", target.quoted(), quoted(name));
                let one = Diagnostic::new(&codes::PROPERTY_REPEATED, at, message);
                one.label(given[part][0].name_location(), "the first")
            }
            None => {
                let names = parts.iter().map(|part| part.name.as_str());
                let message = format!("the property {} has no part {}", target.quoted(), quoted(name));
                report.unknown(&codes::UNKNOWN_PROPERTY, at, message, name, ("its parts are", names))
            }
        };
        tell(one, target, report);
    }
    given
}

/// Reports a fault, with what there is to know about the property.
fn tell(mut one: Diagnostic, target: Target<'_>, report: &mut Report<'_>) {
    if let Some(Source { at, faulty, is_copy }) = target.source {
        // It is not of the type of the composite's property, or another replica takes it.
        let is_mistyped = faulty.has(&codes::COMPOSITE_VALUE_TYPE, one.location, false);
        if is_mistyped || !faulty.add(one.code, one.location, is_copy) && is_copy {
            return;
        }
        one = one.label(at, format!("used here as {}", target.quoted()));
    }
    one.help.extend(target.about());
    report.push(one);
}
