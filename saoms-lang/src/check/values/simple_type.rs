//! The simple types of XML Schema that properties of fleets have. Values of other types are accepted unjudged.

use std::ops::RangeInclusive;

/// A simple type of XML Schema.
pub(crate) struct SimpleType {
    name: &'static str,
    /// The type that it restricts.
    base: &'static str,
    /// The description of its values.
    pub(crate) expected: &'static str,
    /// True if a text is one of its values.
    pub(crate) accepts: fn(&str) -> bool,
}

const fn of(
    name: &'static str,
    base: &'static str,
    expected: &'static str,
    accepts: fn(&str) -> bool,
) -> SimpleType {
    SimpleType { name, base, expected, accepts }
}

const TYPES: &[SimpleType] = &[
    of("string", "", "a text", |_| true),
    of("boolean", "", "`true` or `false`", |text| matches!(text, "true" | "false" | "1" | "0")),
    of("decimal", "", "a decimal number", |text| is_float(text) && !text.contains(['e', 'E', 'N', 'I'])),
    of("double", "", "a number", is_float),
    of("float", "", "a number", is_float),
    of("integer", "decimal", "a whole number", |text| {
        is_digits(text.strip_prefix(['+', '-']).unwrap_or(text))
    }),
    of("long", "integer", "a whole number of 64 bits", |text| is_in(text, i64::MIN.into()..=i64::MAX.into())),
    of("int", "long", "a whole number of 32 bits", |text| is_in(text, i32::MIN.into()..=i32::MAX.into())),
    of("short", "int", "a whole number of 16 bits", |text| is_in(text, i16::MIN.into()..=i16::MAX.into())),
    of("byte", "short", "a whole number of 8 bits", |text| is_in(text, i8::MIN.into()..=i8::MAX.into())),
    of("nonNegativeInteger", "integer", "a whole number, not negative", |text| is_in(text, 0..=i128::MAX)),
    of("positiveInteger", "nonNegativeInteger", "a whole number above 0", |text| is_in(text, 1..=i128::MAX)),
    of("unsignedLong", "nonNegativeInteger", "a whole number of 64 bits, not negative", |text| {
        is_in(text, 0..=u64::MAX.into())
    }),
    of("unsignedInt", "unsignedLong", "a whole number of 32 bits, not negative", |text| {
        is_in(text, 0..=u32::MAX.into())
    }),
    of("unsignedShort", "unsignedInt", "a whole number of 16 bits, not negative", |text| {
        is_in(text, 0..=u16::MAX.into())
    }),
    of("unsignedByte", "unsignedShort", "a whole number of 8 bits, not negative", |text| {
        is_in(text, 0..=u8::MAX.into())
    }),
    of("nonPositiveInteger", "integer", "a whole number, not above 0", |text| is_in(text, i128::MIN..=0)),
    of("negativeInteger", "nonPositiveInteger", "a whole number below 0", |text| is_in(text, i128::MIN..=-1)),
    of("duration", "", "a duration such as `PT1H30M`", is_duration),
    of("QName", "", "a name, with a prefix or without", is_qualified_name),
    of("anyURI", "", "a URI", is_uri),
];

impl SimpleType {
    /// The type of this name.
    pub(crate) fn find(name: &str) -> Option<&'static Self> {
        TYPES.iter().find(|one| one.name == name)
    }

    /// True if it is another type, or a restriction of it.
    pub(crate) fn derives_from(&self, other: &Self) -> bool {
        self.name == other.name || Self::find(self.base).is_some_and(|base| base.derives_from(other))
    }

    /// True for the type of truth values.
    pub(crate) fn is_boolean(&self) -> bool {
        self.name == "boolean"
    }
}

fn is_digits(text: &str) -> bool {
    !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit())
}

fn is_in(text: &str, range: RangeInclusive<i128>) -> bool {
    text.parse().is_ok_and(|number| range.contains(&number))
}

fn is_float(text: &str) -> bool {
    let is_number = |c: char| c.is_ascii_digit() || matches!(c, '+' | '-' | '.' | 'e' | 'E');
    matches!(text, "INF" | "-INF" | "NaN") || text.chars().all(is_number) && text.parse::<f64>().is_ok()
}

/// `P1DT2H`.
fn is_duration(text: &str) -> bool {
    let Some(rest) = text.strip_prefix('-').unwrap_or(text).strip_prefix('P') else { return false };
    let (days, time) = rest.split_once('T').map_or((rest, None), |(days, time)| (days, Some(time)));
    let of_time = time.is_none_or(|time| !time.is_empty() && is_counted(time, "HMS"));
    !rest.is_empty() && is_counted(days, "YMD") && of_time
}

/// True for numbers with these units, each once at most and in this order; seconds can have a fraction.
fn is_counted(text: &str, units: &str) -> bool {
    let (mut rest, mut left) = (text, units);
    while let Some(end) = rest.find(|letter: char| letter.is_ascii_alphabetic()) {
        let (number, unit) = (&rest[..end], &rest[end..=end]);
        let Some(place) = left.find(unit) else { return false };
        let (whole, fraction) = number.split_once('.').unwrap_or((number, "0"));
        if !is_digits(whole) || !is_digits(fraction) || number.contains('.') && unit != "S" {
            return false;
        }
        (rest, left) = (&rest[end + 1..], &left[place + 1..]);
    }
    rest.is_empty()
}

fn is_qualified_name(text: &str) -> bool {
    let is_inner = |letter: char| letter.is_alphanumeric() || matches!(letter, '.' | '-' | '_');
    let is_name = |name: &str| {
        name.starts_with(|first: char| first.is_alphabetic() || first == '_') && name.chars().all(is_inner)
    };
    text.split_once(':').map_or_else(|| is_name(text), |(prefix, local)| is_name(prefix) && is_name(local))
}

/// Nearly everything: behind each `%` stand two hexadecimal digits.
fn is_uri(text: &str) -> bool {
    let is_hexadecimal =
        |part: &str| part.len() >= 2 && part.bytes().take(2).all(|digit| digit.is_ascii_hexdigit());
    text.split('%').skip(1).all(is_hexadecimal)
}
