//! The types of XML Schema that properties name.

use super::lexical::{self, is_digits};
pub(crate) use super::type_name::is_misspelt;
use super::type_name::local;
use crate::check::report::{Report, replacing};
use crate::diagnostic::{Code, Diagnostic, Severity, codes, nearest, quoted};
use crate::load::vocabulary::XML_SCHEMA;
use crate::model::{Part, Property};
use crate::source::{Location, Text};
use crate::syntax::Document;

/// Which type of XML Schema is made of which other one.
const DERIVED: &[(&str, &str)] = &[
    ("integer", "decimal"),
    ("long", "integer"),
    ("int", "long"),
    ("short", "int"),
    ("byte", "short"),
    ("nonNegativeInteger", "integer"),
    ("positiveInteger", "nonNegativeInteger"),
    ("unsignedLong", "nonNegativeInteger"),
    ("unsignedInt", "unsignedLong"),
    ("unsignedShort", "unsignedInt"),
    ("unsignedByte", "unsignedShort"),
    ("nonPositiveInteger", "integer"),
    ("negativeInteger", "nonPositiveInteger"),
    ("normalizedString", "string"),
    ("token", "normalizedString"),
    ("language", "token"),
    ("NMTOKEN", "token"),
    ("Name", "token"),
    ("NCName", "Name"),
    ("ID", "NCName"),
    ("IDREF", "NCName"),
    ("ENTITY", "NCName"),
    ("dateTimeStamp", "dateTime"),
    ("yearMonthDuration", "duration"),
    ("dayTimeDuration", "duration"),
];

/// The types of XML Schema whose values are checked: the name, what is expected, and whether a text is one.
type SimpleType = (&'static str, &'static str, fn(&str) -> bool);

const SIMPLE_TYPES: &[SimpleType] = &[
    ("boolean", "`true` or `false`", |text| matches!(text, "true" | "false" | "1" | "0")),
    ("int", "a whole number of 32 bits", |text| fits::<i32>(text)),
    ("integer", "a whole number", |text| is_digits(text.strip_prefix(['+', '-']).unwrap_or(text))),
    ("long", "a whole number of 64 bits", |text| fits::<i64>(text)),
    ("short", "a whole number of 16 bits", |text| fits::<i16>(text)),
    ("byte", "a whole number of 8 bits", |text| fits::<i8>(text)),
    ("nonNegativeInteger", "a whole number, not negative", |text| whole(text).is_some_and(|it| it >= 0)),
    ("positiveInteger", "a whole number above 0", |text| whole(text).is_some_and(|it| it > 0)),
    ("nonPositiveInteger", "a whole number, not above 0", |text| whole(text).is_some_and(|it| it <= 0)),
    ("negativeInteger", "a whole number below 0", |text| whole(text).is_some_and(|it| it < 0)),
    ("unsignedLong", "a whole number of 64 bits, not negative", |text| fits::<u64>(text)),
    ("unsignedInt", "a whole number of 32 bits, not negative", |text| fits::<u32>(text)),
    ("unsignedShort", "a whole number of 16 bits, not negative", |text| fits::<u16>(text)),
    ("unsignedByte", "a whole number of 8 bits, not negative", |text| fits::<u8>(text)),
    ("double", "a number", is_float),
    ("float", "a number", is_float),
    ("date", "a date such as `2026-11-22`", lexical::date),
    ("time", "a time such as `12:30:00`", lexical::time),
    ("dateTime", "a date and a time such as `2026-11-22T12:30:00`", lexical::date_time),
    ("duration", "a duration such as `PT1H30M`", lexical::duration),
    ("gYear", "a year such as `2026`", lexical::year),
    ("gYearMonth", "a year and a month such as `2026-11`", lexical::year_month),
    ("gMonth", "a month such as `--11`", lexical::month),
    ("gMonthDay", "a month and a day such as `--11-22`", lexical::month_day),
    ("gDay", "a day such as `---22`", lexical::day),
    ("QName", "a name, with a prefix or without", lexical::qualified),
    ("NCName", "a name without a prefix", lexical::name),
    ("ID", "a name without a prefix", lexical::name),
    ("IDREF", "a name without a prefix", lexical::name),
    ("NMTOKEN", "letters, digits, `.`, `-`, `_` and `:`", lexical::token),
    ("language", "a language such as `en`", lexical::language),
    ("hexBinary", "pairs of hexadecimal digits", lexical::hexadecimal),
    ("base64Binary", "text of base 64", lexical::base_64),
    ("anyURI", "a URI", lexical::uri),
    ("decimal", "a decimal number", |text| is_float(text) && !text.contains(['e', 'E', 'N', 'I'])),
];

fn whole(text: &str) -> Option<i128> {
    text.parse().ok()
}

fn fits<T: TryFrom<i128>>(text: &str) -> bool {
    whole(text).is_some_and(|it| T::try_from(it).is_ok())
}

fn is_float(text: &str) -> bool {
    let is_number = |c: char| c.is_ascii_digit() || matches!(c, '+' | '-' | '.' | 'e' | 'E');
    matches!(text, "INF" | "-INF" | "NaN") || text.chars().all(is_number) && text.parse::<f64>().is_ok()
}

/// Checks the values that a composite gives its property itself against its type, where that is a simple one of XML Schema.
pub(crate) fn own(typed: Typed<'_>, report: &mut Report<'_>) {
    typed.property.simple_values().for_each(|value| given(typed, value, report));
}

/// The same for a value that somebody else gives the property.
pub(crate) fn given(typed: Typed<'_>, value: &Text, report: &mut Report<'_>) {
    holds(typed, value, &codes::COMPOSITE_VALUE_TYPE, report);
}

/// True if a value is of the type of a property; where it is not, that is reported with this code.
pub(crate) fn holds(typed: Typed<'_>, value: &Text, code: &'static Code, report: &mut Report<'_>) -> bool {
    simple_type(typed).is_none_or(|(of, kind)| is_of(typed.property, (of, kind), value, code, report))
}

/// The same where it is not known what the prefixes of types mean.
pub(crate) fn holds_by_name(property: &Property, value: &Text, report: &mut Report<'_>) -> bool {
    let Some(of) = property.r#type() else { return true };
    let found = SIMPLE_TYPES.iter().find(|(name, ..)| *name == local(of));
    found.is_none_or(|kind| is_of(property, (of, kind), value, &codes::COMPOSITE_VALUE_TYPE, report))
}

/// True if a value is of the type of a property.
pub(crate) fn is_right(typed: Typed<'_>, value: &str) -> bool {
    simple_type(typed).is_none_or(|(_, kind)| is_written(typed.property, kind, value))
}

fn is_written(property: &Property, (_, _, is_one): &SimpleType, value: &str) -> bool {
    // Many values may be written as a list, as in files of SCA 1.0.
    let is_list = property.many().is_some_and(|many| many.value);
    is_one(value) || is_list && !value.trim().is_empty() && value.split_whitespace().all(is_one)
}

fn is_of(
    property: &Property,
    (of, kind): (&Text, &SimpleType),
    value: &Text,
    code: &'static Code,
    report: &mut Report<'_>,
) -> bool {
    if is_written(property, kind, value) {
        return true;
    }
    // In a text of its own an empty value can be seen.
    let is_hidden = value.is_empty() && value.location.file == property.tag().file;
    let at = if is_hidden { property.tag() } else { value.location };
    if report.skip(code, Severity::Error, at) || report.has_told(code, at) || is_told_of(value, report) {
        return false;
    }
    let message = format!(
        "the property {} is of the type {}: found {}, expected {}",
        quoted(&property.name),
        quoted(of),
        if value.is_empty() { "nothing".to_owned() } else { quoted(value) },
        kind.1
    );
    let one = Diagnostic::new(code, at, message).label(of.location, "the type");
    report.push(match meant_boolean(value).filter(|_| kind.0 == "boolean") {
        Some(meant) => one.suggest(replacing(value, meant), at, meant),
        None => one.help("change the value, or the type"),
    });
    false
}

/// The boolean that a text probably means.
fn meant_boolean(text: &str) -> Option<&'static str> {
    match text.to_ascii_lowercase().as_str() {
        "yes" | "y" | "on" | "t" => Some("true"),
        "no" | "n" | "off" | "f" => Some("false"),
        other => nearest(other, ["true", "false"]),
    }
}

/// True if it is told that a value is none for the class that takes it, which says more.
fn is_told_of(value: &Text, report: &Report<'_>) -> bool {
    let of_classes =
        [&codes::VALUE_TYPE, &codes::VALUE_EMPTY, &codes::VALUE_RANGE, &codes::VALUE_NOT_ALLOWED];
    of_classes.into_iter().any(|code| report.has_told(code, value.location))
}

/// The same, with how its values are written. A type of the same name in a namespace of users is another one.
fn simple_type(typed: Typed<'_>) -> Option<(&Text, &'static SimpleType)> {
    let of = typed.property.r#type()?;
    let local = local(of);
    let found = SIMPLE_TYPES.iter().find(|(name, ..)| *name == local)?;
    let is_ours = !of.contains(':') || typed.namespace(of).is_none_or(|namespace| namespace == XML_SCHEMA);
    is_ours.then_some((of, found))
}

/// A property that may have a type, and the document that says what the prefixes in it mean.
#[derive(Clone, Copy)]
pub(crate) struct Typed<'a> {
    pub(crate) property: &'a Property,
    pub(crate) document: &'a Document,
}

impl Typed<'_> {
    fn namespace(&self, of: &str) -> Option<String> {
        let prefix = of.split_once(':').map_or("", |(prefix, _)| prefix);
        let element = self.document.element(self.property.origin().element);
        element.resolve_prefix(prefix).map(|namespace| namespace.into_owned())
    }
}

/// The relation of another property to the one at hand.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Match {
    /// Its declaration.
    Declaration,
    /// The source of its value, which is written here.
    Source(Location),
}

/// True if two properties of which one gives the other its values can have one type: the same, or one that is made of the other. Where they cannot,
/// that is reported.
pub(crate) fn matches(own: Typed<'_>, other: Typed<'_>, how: Match, report: &mut Report<'_>) -> bool {
    let of = |typed: &Typed<'_>| {
        let (of, element) = (typed.property.r#type(), typed.property.element());
        let of = of.map(|of| (of, true)).or_else(|| Some((element?, false)));
        of.filter(|(of, _)| !of.is_empty()).map(|(of, is_type)| (of.clone(), is_type))
    };
    let (Some((here, is_type)), Some((there, is_type_there))) = (of(&own), of(&other)) else { return true };
    let (here, there) = (&here, &there);
    let (name, meant) = (local(here), local(there));
    let is_same = match (own.namespace(here).as_deref(), other.namespace(there).as_deref()) {
        // Whether an element is of a type is in the schemas of users.
        _ if is_type != is_type_there => return true,
        (Some(XML_SCHEMA), Some(XML_SCHEMA)) => derives(name, meant) || derives(meant, name),
        // What types of users are made of is in their schemas.
        (Some(one), Some(another)) if one != another => [one, another].contains(&XML_SCHEMA),
        _ => name == meant,
    };
    // A slip in the name of one is told by itself.
    let is_slip = |(typed, of): (Typed<'_>, &Text)| {
        is_misspelt(of) && typed.namespace(of).is_some_and(|namespace| namespace == XML_SCHEMA)
    };
    if !is_same && ![(own, here), (other, there)].into_iter().any(is_slip) {
        let (at, what, help, rule) = match how {
            Match::Declaration => {
                let help = match is_type {
                    true => "leave `type` out: that of the declaration holds",
                    false => "leave `element` out: that of the declaration holds",
                };
                (here.location, "where it is declared", help, "ASM50036")
            }
            Match::Source(at) => {
                let help = if is_type { "give both one type" } else { "give both one element" };
                (at, "where its value comes from", help, "ASM50038")
            }
        };
        let kind = if is_type { "is of the type" } else { "is of the element" };
        let message = format!(
            "the property {} {kind} {}, and of {} {what}",
            quoted(&own.property.name),
            quoted(here),
            quoted(there)
        );
        let mut one = Diagnostic::new(&codes::VALUE_TYPE, at, message).rule(rule);
        if at != here.location {
            one = one.label(here.location, if is_type { "its type" } else { "its element" });
        }
        report.push(one.label(there.location, what).help(help));
    }
    is_same
}

/// True if a type of XML Schema is another one, or made of it.
fn derives(name: &str, from: &str) -> bool {
    let mut name = name;
    loop {
        if name == from {
            return true;
        }
        match DERIVED.iter().find(|(derived, _)| *derived == name) {
            Some((_, base)) => name = base,
            None => return matches!(from, "anyType" | "anySimpleType" | "anyAtomicType"),
        }
    }
}
