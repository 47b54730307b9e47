//! The types of XML Schema that properties name.

use super::report::{Report, replacing};
use crate::diagnostic::{Diagnostic, codes, nearest, quoted};
use crate::model::{Part, Property};
use crate::source::Text;
use crate::xml::Document;

const XML_SCHEMA: &str = "http://www.w3.org/2001/XMLSchema";

/// The simple types that XML Schema 1.0 and 1.1 have, and their common ancestor.
const BUILT_IN: &[&str] = &[
    "anyType",
    "anySimpleType",
    "anyAtomicType",
    "string",
    "boolean",
    "decimal",
    "float",
    "double",
    "duration",
    "dateTime",
    "time",
    "date",
    "gYearMonth",
    "gYear",
    "gMonthDay",
    "gDay",
    "gMonth",
    "hexBinary",
    "base64Binary",
    "anyURI",
    "QName",
    "NOTATION",
    "normalizedString",
    "token",
    "language",
    "NMTOKEN",
    "NMTOKENS",
    "Name",
    "NCName",
    "ID",
    "IDREF",
    "IDREFS",
    "ENTITY",
    "ENTITIES",
    "integer",
    "nonPositiveInteger",
    "negativeInteger",
    "long",
    "int",
    "short",
    "byte",
    "nonNegativeInteger",
    "unsignedLong",
    "unsignedInt",
    "unsignedShort",
    "unsignedByte",
    "positiveInteger",
    "yearMonthDuration",
    "dayTimeDuration",
    "dateTimeStamp",
];

/// The types of XML Schema whose values are checked: the name, what is expected, and whether a text is one.
type SimpleType = (&'static str, &'static str, fn(&str) -> bool);

const SIMPLE_TYPES: &[SimpleType] = &[
    ("boolean", "`true` or `false`", |text| matches!(text, "true" | "false" | "1" | "0")),
    ("int", "a whole number of 32 bits", |text| whole(text).is_some_and(|it| i32::try_from(it).is_ok())),
    ("integer", "a whole number", |text| is_digits(text.trim_start_matches(['+', '-']))),
    ("long", "a whole number of 64 bits", |text| whole(text).is_some_and(|it| i64::try_from(it).is_ok())),
    ("short", "a whole number of 16 bits", |text| whole(text).is_some_and(|it| i16::try_from(it).is_ok())),
    ("byte", "a whole number of 8 bits", |text| whole(text).is_some_and(|it| i8::try_from(it).is_ok())),
    ("nonNegativeInteger", "a whole number, not negative", |text| is_digits(text.trim_start_matches('+'))),
    ("double", "a number", is_float),
    ("float", "a number", is_float),
    ("decimal", "a decimal number", |text| is_float(text) && !text.contains(['e', 'E', 'N', 'I'])),
];

fn whole(text: &str) -> Option<i128> {
    text.parse().ok()
}

fn is_digits(text: &str) -> bool {
    !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit())
}

fn is_float(text: &str) -> bool {
    let is_number = |c: char| c.is_ascii_digit() || matches!(c, '+' | '-' | '.' | 'e' | 'E');
    matches!(text, "INF" | "-INF" | "NaN") || text.chars().all(is_number) && text.parse::<f64>().is_ok()
}

/// Checks the values that a composite gives its property itself against its type, where that is a simple one of XML Schema.
pub(super) fn own(property: &Property, report: &mut Report<'_>) {
    property.simple_values().for_each(|value| given(property, value, report));
}

/// The same for a value that somebody else gives the property.
pub(super) fn given(property: &Property, value: &Text, report: &mut Report<'_>) {
    let Some(of) = property.r#type() else { return };
    let local = of.rsplit(':').next().unwrap_or(of);
    let Some((_, expected, is_one)) = SIMPLE_TYPES.iter().find(|(name, ..)| *name == local) else { return };
    if value.is_empty() || is_one(value) {
        return;
    }
    let message = format!(
        "the property {} is of the type {}: found {}, expected {expected}",
        quoted(&property.name),
        quoted(of),
        quoted(value)
    );
    let one =
        Diagnostic::new(&codes::COMPOSITE_VALUE_TYPE, value.location, message).label(of.location, "the type");
    report.push(one.help("change the value, or the type"));
}

/// Reports a type in the namespace of XML Schema that is not there.
pub(super) fn named(property: &Property, document: &Document, report: &mut Report<'_>) {
    let Some(of) = property.r#type().filter(|of| !of.is_empty()) else { return };
    let (prefix, local) = of.split_once(':').unwrap_or(("", of));
    if BUILT_IN.contains(&local) {
        return;
    }
    let element = document.element(property.origin().element);
    if element.resolve_prefix(prefix).is_none_or(|namespace| namespace != XML_SCHEMA) {
        return;
    }
    let message = format!("XML Schema has no type {}", quoted(local));
    let one = Diagnostic::new(&codes::UNKNOWN_TYPE, of.location, message);
    report.push(match nearest(local, BUILT_IN.iter().copied()) {
        Some(meant) => {
            let meant = if prefix.is_empty() { meant.to_owned() } else { format!("{prefix}:{meant}") };
            one.suggest(replacing(of, &meant), of.location, meant)
        }
        None => one.help("its types are `string`, `boolean`, `int`, `double` and so on; a type of your own has the prefix of its own namespace"),
    });
}
