//! The simple types of XML Schema that properties name: values against them, and the types of two properties where one
//! gives the other its values. Values of other types are accepted unjudged.

use std::ops::RangeInclusive;

use super::faulty_values::FaultyValues;
use super::type_name::local;
use crate::check::report::{Report, replacing};
use crate::diagnostic::{Diagnostic, Severity, codes, meant_boolean, quoted};
use crate::expression::has_expression;
use crate::load::vocabulary::XML_SCHEMA;
use crate::model::{Part, Property};
use crate::source::{Location, Text};
use crate::syntax::{Document, is_qualified_name};

/// A property that may have a type, and the document that says what the prefixes in it mean.
#[derive(Clone, Copy)]
pub(crate) struct Typed<'a> {
    pub(crate) property: &'a Property,
    pub(crate) document: &'a Document,
}

impl<'a> Typed<'a> {
    /// Its type as it is written, where that is a simple one of XML Schema, and not of the same name elsewhere.
    pub(crate) fn simple_type(&self) -> Option<(&'a Text, &'static SimpleType)> {
        let of = self.property.r#type()?;
        let found = SimpleType::find(local(of))?;
        let namespace = of.split_once(':').and_then(|(prefix, _)| {
            let element = self.property.origin().element(self.document);
            element.resolve_prefix(prefix)
        });
        namespace.is_none_or(|namespace| namespace == XML_SCHEMA).then_some((of, found))
    }

    /// Reports a value that is not of its type.
    pub(crate) fn check(&self, value: &Text, faulty: &FaultyValues, report: &mut Report<'_>) {
        if let Some(of) = self.simple_type() {
            holds(self.property, of, value, faulty, report);
        }
    }
}

/// True if a value is of the type of a property, whatever its prefix means. That it is not is reported.
pub(crate) fn holds_by_name(property: &Property, value: &Text, faulty: &FaultyValues, report: &mut Report<'_>) -> bool {
    let of = property.r#type().and_then(|named| Some((named, SimpleType::find(local(named))?)));
    of.is_none_or(|of| holds(property, of, value, faulty, report))
}

fn holds(
    property: &Property,
    (named, of): (&Text, &SimpleType),
    value: &Text,
    faulty: &FaultyValues,
    report: &mut Report<'_>,
) -> bool {
    // Many values may be written as a list, as in files of SCA 1.0.
    let is_list = property.many().is_some_and(|many| many.value) && !value.trim().is_empty();
    if of.accepts(value) || is_list && value.split_whitespace().all(|one| of.accepts(one)) {
        return true;
    }
    // In a text of its own an empty value can be seen.
    let is_hidden = value.is_empty() && value.location.file == property.tag().file;
    let at = if is_hidden { property.tag() } else { value.location };
    let code = &codes::COMPOSITE_VALUE_TYPE;
    // The class that takes a value may refuse it as well, which says more.
    if report.skip(code, Severity::Error, at) || faulty.is_refused(value.location) || !faulty.add(code, at, false) {
        return false;
    }
    let message = format!(
        "the property {} has the type {}: found {}, expected {}",
        quoted(&property.name),
        quoted(named),
        if value.is_empty() { "nothing".to_owned() } else { quoted(value) },
        of.expected
    );
    let one = Diagnostic::new(code, at, message).label(named.location, "the type");
    report.push(match meant_boolean(value).filter(|_| of.name == "boolean") {
        Some(meant) => one.suggest(replacing(value, meant), at, meant),
        None if has_expression(value) => one.help("`${...}` is evaluated only in components with a `saoms:count`"),
        None => one.help("change the value, or the type"),
    });
    false
}

/// Reports two properties of simple types of XML Schema where neither holds the values of the other. What other
/// types and elements are made of is in the schemas of users. The other one is the declaration of the first, or where
/// the `source` at a place leads to.
pub(crate) fn check_match(own: Typed<'_>, other: Typed<'_>, source: Option<Location>, report: &mut Report<'_>) {
    let (Some((here, mine)), Some((there, others))) = (own.simple_type(), other.simple_type()) else {
        return;
    };
    if mine.is_within(others) || others.is_within(mine) {
        return;
    }
    let (at, whose, help, rule) = match source {
        None => {
            let help = "remove `type`: the type of the declaration is used";
            (here.location, "where it is declared", help, "ASM50036")
        }
        Some(at) => (at, "where its value comes from", "give both the same type", "ASM50038"),
    };
    let message = format!(
        "the property {} has the type {} here, but {} {whose}",
        quoted(&own.property.name),
        quoted(here),
        quoted(there)
    );
    let mut one = Diagnostic::new(&codes::VALUE_TYPE, at, message).rule(rule);
    if at != here.location {
        one = one.label(here.location, "its type");
    }
    report.push(one.label(there.location, whose).help(help));
}

/// A simple type of XML Schema.
pub(crate) struct SimpleType {
    name: &'static str,
    /// The description of its values.
    pub(crate) expected: &'static str,
    values: Values,
}

enum Values {
    /// Whole numbers of a range.
    Whole(RangeInclusive<i128>),
    /// Texts of a form.
    Form(fn(&str) -> bool),
}

const fn form(name: &'static str, expected: &'static str, accepts: fn(&str) -> bool) -> SimpleType {
    SimpleType { name, expected, values: Values::Form(accepts) }
}

const fn whole(name: &'static str, expected: &'static str, range: RangeInclusive<i128>) -> SimpleType {
    SimpleType { name, expected, values: Values::Whole(range) }
}

const TYPES: &[SimpleType] = &[
    form("string", "a text", |_| true),
    form("boolean", "`true` or `false`", |text| matches!(text, "true" | "false" | "1" | "0")),
    form("decimal", "a decimal number", |text| is_float(text) && !text.contains(['e', 'E', 'N', 'I'])),
    form("double", "a number", is_float),
    form("float", "a number", is_float),
    whole("integer", "a whole number", i128::MIN..=i128::MAX),
    whole("long", "a whole number of 64 bits", -(1 << 63)..=(1 << 63) - 1),
    whole("int", "a whole number of 32 bits", -(1 << 31)..=(1 << 31) - 1),
    whole("short", "a whole number of 16 bits", -(1 << 15)..=(1 << 15) - 1),
    whole("byte", "a whole number of 8 bits", -(1 << 7)..=(1 << 7) - 1),
    whole("nonNegativeInteger", "a whole number, not negative", 0..=i128::MAX),
    whole("positiveInteger", "a whole number above 0", 1..=i128::MAX),
    whole("unsignedLong", "a whole number of 64 bits, not negative", 0..=(1 << 64) - 1),
    whole("unsignedInt", "a whole number of 32 bits, not negative", 0..=(1 << 32) - 1),
    whole("unsignedShort", "a whole number of 16 bits, not negative", 0..=(1 << 16) - 1),
    whole("unsignedByte", "a whole number of 8 bits, not negative", 0..=(1 << 8) - 1),
    whole("nonPositiveInteger", "a whole number, not above 0", i128::MIN..=0),
    whole("negativeInteger", "a whole number below 0", i128::MIN..=-1),
    form("duration", "a duration such as `PT1H30M`", is_duration),
    form("QName", "a name, with a prefix or without", is_qualified_name),
    form("anyURI", "a URI", is_uri),
];

impl SimpleType {
    /// The type of this name.
    pub(crate) fn find(name: &str) -> Option<&'static Self> {
        TYPES.iter().find(|one| one.name == name)
    }

    /// True if a text is one of its values.
    pub(crate) fn accepts(&self, text: &str) -> bool {
        match &self.values {
            Values::Whole(range) => text.parse().is_ok_and(|number| range.contains(&number)),
            Values::Form(accepts) => accepts(text),
        }
    }

    /// True if each of its values is one of another type.
    pub(crate) fn is_within(&self, other: &Self) -> bool {
        match (&self.values, &other.values) {
            (Values::Whole(own), Values::Whole(range)) => range.contains(own.start()) && range.contains(own.end()),
            (Values::Whole(_), _) => other.name == "decimal",
            _ => self.name == other.name,
        }
    }

    pub(crate) fn is_whole(&self) -> bool {
        matches!(self.values, Values::Whole(_))
    }
}

fn is_float(text: &str) -> bool {
    let is_number = |c: char| c.is_ascii_digit() || matches!(c, '+' | '-' | '.' | 'e' | 'E');
    matches!(text, "INF" | "-INF" | "NaN") || text.chars().all(is_number) && text.parse::<f64>().is_ok()
}

/// `P1DT2H`: numbers with units, whatever their order.
fn is_duration(text: &str) -> bool {
    let Some(rest) = text.strip_prefix('-').unwrap_or(text).strip_prefix('P') else { return false };
    let is_part = |c: char| c.is_ascii_digit() || matches!(c, '.' | 'T' | 'Y' | 'M' | 'D' | 'H' | 'S');
    rest.starts_with(|c: char| c.is_ascii_digit() || c == 'T')
        && rest.ends_with(['Y', 'M', 'D', 'H', 'S'])
        && rest.chars().all(is_part)
}

/// Nearly everything: behind each `%` stand two hexadecimal digits.
fn is_uri(text: &str) -> bool {
    let is_hexadecimal = |part: &str| part.len() >= 2 && part.bytes().take(2).all(|digit| digit.is_ascii_hexdigit());
    text.split('%').skip(1).all(is_hexadecimal)
}
