//! The simple types of XML Schema that properties of fleets have. Values of other types are accepted unjudged.

use std::ops::RangeInclusive;

use crate::syntax::is_qualified_name;

/// A simple type of XML Schema.
pub(crate) struct SimpleType {
    name: &'static str,
    /// The description of its values.
    pub(crate) expected: &'static str,
    values: Values,
}

/// The values of a type.
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

    /// True for the type of truth values.
    pub(crate) fn is_boolean(&self) -> bool {
        self.name == "boolean"
    }

    /// True for types of whole numbers.
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
