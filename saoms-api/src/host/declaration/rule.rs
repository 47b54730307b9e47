use std::fmt;
use std::time::Duration;

use crate::host::parse_duration;
use crate::time::read_duration;

/// The type of a property, as declarations name it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum PropertyKind {
    /// `true` or `false`; as in XML Schema also `1` or `0`.
    Boolean,
    /// A whole number in decimal digits, with an optional sign.
    Integer,
    /// A finite number: decimals and an exponent are allowed.
    Float,
    /// Any text.
    String,
    /// A duration, as [`parse_duration`] reads it.
    Duration,
    /// One of the allowed texts.
    Enumeration,
    /// Properties of its own.
    Complex,
}

impl PropertyKind {
    /// All of them.
    pub const ALL: [PropertyKind; 7] = [
        PropertyKind::Boolean,
        PropertyKind::Integer,
        PropertyKind::Float,
        PropertyKind::String,
        PropertyKind::Duration,
        PropertyKind::Enumeration,
        PropertyKind::Complex,
    ];

    /// The name that declarations use.
    pub const fn name(self) -> &'static str {
        match self {
            PropertyKind::Boolean => "boolean",
            PropertyKind::Integer => "integer",
            PropertyKind::Float => "float",
            PropertyKind::String => "string",
            PropertyKind::Duration => "duration",
            PropertyKind::Enumeration => "enumeration",
            PropertyKind::Complex => "complex",
        }
    }

    /// True if a value is one text that [`Rule::check`] reads as a [`Scalar`] of its own, rather than choices or
    /// properties.
    pub const fn is_scalar(self) -> bool {
        !matches!(self, PropertyKind::Enumeration | PropertyKind::Complex)
    }

    /// The type of this name.
    pub fn from_name(name: &str) -> Option<PropertyKind> {
        PropertyKind::ALL.into_iter().find(|kind| kind.name() == name)
    }
}

/// A value that was read from text.
#[derive(Clone, Debug, PartialEq)]
pub enum Scalar {
    /// True or false.
    Boolean(bool),
    /// A whole number; `i128` holds those of every integer type.
    Integer(i128),
    /// A finite number.
    Float(f64),
    /// A string, or the chosen text of an enumeration.
    Text(String),
    /// A duration.
    Duration(Duration),
}

/// Rule of the values of a scalar property, from its declaration. The checker and the component read values through it,
/// so they agree.
///
/// ```
/// use saoms_api::host::declaration::{PropertyKind, Rule, Scalar};
///
/// let rule = Rule { min: Some("1"), max: Some("99"), unit: Some("%"), ..Rule::of(PropertyKind::Integer) };
/// assert_eq!(rule.check("35"), Ok(Scalar::Integer(35)));
/// assert_eq!(rule.check("0").unwrap_err(), "`0` is out of range: expected a whole number from 1 to 99 [%]");
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rule<'a> {
    /// Its type.
    pub kind: PropertyKind,
    /// The least value.
    pub min: Option<&'a str>,
    /// The greatest value.
    pub max: Option<&'a str>,
    /// The value below which it has to stay.
    pub exclusive_max: Option<&'a str>,
    /// The unit, for messages.
    pub unit: Option<&'a str>,
    /// The texts that are allowed; empty where all are.
    pub allowed: &'a [&'a str],
    /// True if the text must not be empty or blank.
    pub non_empty: bool,
}

impl<'a> Rule<'a> {
    /// Any value of the type.
    pub const fn of(kind: PropertyKind) -> Rule<'a> {
        Rule { kind, min: None, max: None, exclusive_max: None, unit: None, allowed: &[], non_empty: false }
    }

    /// Reads a value and checks it. Blanks around it do not count, except in a string.
    ///
    /// # Errors
    /// The message in one line, with found and expected value.
    pub fn check(&self, text: &str) -> Result<Scalar, String> {
        match self.kind {
            PropertyKind::String => self.text(text).map(|()| Scalar::Text(text.to_owned())),
            PropertyKind::Enumeration => self.text(text).map(|()| Scalar::Text(text.trim().to_owned())),
            PropertyKind::Integer => {
                let plain = PlainBounds::of(self).and_then(|bounds| bounds.read(text));
                let plain = plain.map(|number| Ok(i128::from(number)));
                plain.unwrap_or_else(|| self.within(text, integer, is_far)).map(Scalar::Integer)
            }
            PropertyKind::Float => self.within(text, float, |_, _, _| false).map(Scalar::Float),
            PropertyKind::Duration => self.within(text, duration, |_, _, _| false).map(Scalar::Duration),
            PropertyKind::Boolean => self.within(text, boolean, |_, _, _| false).map(Scalar::Boolean),
            // No text is one.
            PropertyKind::Complex => self.within(text, |_| None::<bool>, |_, _, _| false).map(Scalar::Boolean),
        }
    }

    /// As [`check`](Rule::check), where the value is not asked for.
    ///
    /// # Errors
    /// As there.
    pub fn allows(&self, text: &str) -> Result<(), String> {
        match self.kind {
            PropertyKind::String | PropertyKind::Enumeration => self.text(text),
            PropertyKind::Integer if PlainBounds::of(self).is_some_and(|bounds| bounds.read(text).is_some()) => Ok(()),
            PropertyKind::Integer => self.within(text, integer, is_far).map(drop),
            PropertyKind::Float => self.within(text, float, |_, _, _| false).map(drop),
            PropertyKind::Duration => self.within(text, duration, |_, _, _| false).map(drop),
            _ => self.check(text).map(drop),
        }
    }

    /// True if it takes any text that is not blank.
    #[inline]
    pub fn takes_any_text(&self) -> bool {
        matches!(self.kind, PropertyKind::String) && self.allowed.is_empty()
    }

    /// True if the beginning of a text shows that it is allowed. Other texts need [`check`](Rule::check).
    #[inline]
    pub(crate) fn allows_plain_text(&self, text: &str) -> bool {
        self.takes_any_text() && text.bytes().next().is_some_and(|first| first.is_ascii_graphic())
    }

    fn text(&self, text: &str) -> Result<(), String> {
        let trimmed = trim(text);
        if trimmed.is_empty() && (self.non_empty || self.kind != PropertyKind::String) {
            return Err(format!("the value is empty: expected {}", Expected(self)));
        }
        let value = if self.kind == PropertyKind::String { text } else { trimmed };
        match self.allowed.is_empty() || self.allowed.contains(&value) {
            true => Ok(()),
            false => Err(self.refusal("not allowed", text)),
        }
    }

    /// Reads a value that has an order, and compares it with the bounds. Values that `is_far` knows to be beyond the
    /// bounds are not read; it is called with true for the least value.
    fn within<T: PartialOrd>(
        &self,
        text: &str,
        read: impl Fn(&str) -> Option<T>,
        is_far: impl Fn(&T, &str, bool) -> bool,
    ) -> Result<T, String> {
        let trimmed = trim(text);
        if trimmed.is_empty() {
            return Err(format!("the value is empty: expected {}", Expected(self)));
        }
        let Some(value) = read(trimmed) else {
            return Err(self.refusal(why_not(self.kind, text), text));
        };
        let near = |bound: Option<&'a str>, is_least| {
            bound.map(trim).filter(|bound| !is_far(&value, bound, is_least)).and_then(&read)
        };
        let below = near(self.min, true).is_some_and(|min| value < min);
        let above = near(self.max, false).is_some_and(|max| value > max)
            || near(self.exclusive_max, false).is_some_and(|max| value >= max);
        if below || above { Err(self.refusal("out of range", text)) } else { Ok(value) }
    }

    fn refusal(&self, what: &str, text: &str) -> String {
        format!("`{}` is {what}: expected {}", text.trim(), Expected(self))
    }

    /// Description of the expected value, as in `a whole number from 1 to 99 [%]`.
    pub fn expected(&self) -> String {
        Expected(self).to_string()
    }
}

/// The whole numbers that a rule allows, as far as they are nothing but a few digits, as most are. The bounds of a rule
/// are texts, which need not be read again for each value.
///
/// ```
/// use saoms_api::host::declaration::{PlainBounds, PropertyKind, Rule};
///
/// const RULE: Rule<'static> = Rule { min: Some("1"), max: Some("99"), ..Rule::of(PropertyKind::Integer) };
/// const BOUNDS: Option<PlainBounds> = PlainBounds::of(&RULE);
/// let bounds = BOUNDS.unwrap();
/// assert_eq!((bounds.read("35"), bounds.read("0"), bounds.read(" 35 ")), (Some(35), None, None));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PlainBounds {
    least: u32,
    most: u32,
}

impl PlainBounds {
    /// Those of a rule for whole numbers; `None` for any other one, and where no such text is certainly allowed.
    pub const fn of(rule: &Rule<'_>) -> Option<PlainBounds> {
        if !matches!(rule.kind, PropertyKind::Integer) || rule.exclusive_max.is_some() {
            return None;
        }
        let least = match rule.min {
            None => Some(0),
            Some(min) => match min.as_bytes() {
                [b'-', digits @ ..] if few_digits(digits).is_some() || is_large(digits) => Some(0),
                digits => few_digits(digits),
            },
        };
        let most = match rule.max {
            None => Some(MOST_DIGITS),
            Some(max) if is_large(max.as_bytes()) => Some(MOST_DIGITS),
            Some(max) => few_digits(max.as_bytes()),
        };
        match (least, most) {
            (Some(least), Some(most)) => Some(PlainBounds { least, most }),
            _ => None,
        }
    }

    /// The number; `None` where [`Rule::check`] has to look at the text.
    #[inline]
    pub const fn read(self, text: &str) -> Option<u32> {
        match few_digits(text.as_bytes()) {
            Some(number) if self.least <= number && number <= self.most => Some(number),
            _ => None,
        }
    }
}

/// Reads a value of a scalar type. `None` when the text is no such value; [`Rule::check`] says why.
pub fn parse_scalar(kind: PropertyKind, text: &str) -> Option<Scalar> {
    let trimmed = trim(text);
    match kind {
        PropertyKind::Boolean => boolean(trimmed).map(Scalar::Boolean),
        PropertyKind::Integer => integer(trimmed).map(Scalar::Integer),
        PropertyKind::Float => float(trimmed).map(Scalar::Float),
        PropertyKind::String => Some(Scalar::Text(text.to_owned())),
        PropertyKind::Duration => duration(trimmed).map(Scalar::Duration),
        PropertyKind::Enumeration => Some(Scalar::Text(trimmed.to_owned())),
        PropertyKind::Complex => None,
    }
}

/// A text without the blanks around it. Most texts have none: then a look at both ends is enough.
pub(crate) fn trim(text: &str) -> &str {
    match text.as_bytes() {
        [first, .., last] if first.is_ascii_graphic() && last.is_ascii_graphic() => text,
        [only] if only.is_ascii_graphic() => text,
        _ => text.trim(),
    }
}

fn boolean(text: &str) -> Option<bool> {
    match text {
        "true" | "1" => Some(true),
        "false" | "0" => Some(false),
        _ => None,
    }
}

/// A number; `parse` also knows `inf` and `NaN`, which no range could refuse.
fn float(text: &str) -> Option<f64> {
    text.parse().ok().filter(|value: &f64| value.is_finite())
}

fn duration(text: &str) -> Option<Duration> {
    read_duration(text).ok()
}

/// A whole number; those of ordinary size are read much faster than 128 bits are.
fn integer(text: &str) -> Option<i128> {
    match few_digits(text.as_bytes()) {
        Some(number) => Some(i128::from(number)),
        None => text.parse::<i64>().map(i128::from).ok().or_else(|| text.parse().ok()),
    }
}

/// So many digits fit into 32 bits.
const FEW: usize = 9;
/// The largest number of so many digits.
const MOST_DIGITS: u32 = 999_999_999;

/// The number that nothing but a few digits make.
#[inline]
const fn few_digits(text: &[u8]) -> Option<u32> {
    if text.is_empty() || text.len() > FEW {
        return None;
    }
    let (mut number, mut at) = (0, 0);
    while at < text.len() {
        let digit = text[at].wrapping_sub(b'0');
        if digit > 9 {
            return None;
        }
        number = number * 10 + digit as u32;
        at += 1;
    }
    Some(number)
}

/// True if the number has more than a few digits.
const fn is_large(digits: &[u8]) -> bool {
    digits.len() > FEW && matches!(digits, [b'1'..=b'9', ..])
}

/// True if a whole number is certainly above this minimum, or below this maximum: most bounds are those of a type, far
/// away, and reading them takes longer than reading the number.
fn is_far(number: &i128, bound: &str, is_least: bool) -> bool {
    /// Numbers of more digits are at least so large.
    const NEAR: std::ops::Range<i128> = -999_999_999..1_000_000_000;
    let digits = if is_least { bound.strip_prefix('-') } else { Some(bound) };
    digits.is_some_and(|digits| is_large(digits.as_bytes())) && NEAR.contains(number)
}

/// The reason why a text is no value of the type.
fn why_not(kind: PropertyKind, text: &str) -> &'static str {
    let text = text.trim();
    match kind {
        PropertyKind::Boolean => "not a boolean",
        PropertyKind::Integer => {
            let digits = text.strip_prefix(['+', '-']).unwrap_or(text);
            // Digits alone were refused, so there are too many.
            match digits.is_empty() || digits.bytes().any(|byte| !byte.is_ascii_digit()) {
                false => "out of range",
                true => "not a whole number",
            }
        }
        PropertyKind::Float => match text.parse::<f64>() {
            Ok(value) if value.is_infinite() && text.contains(|c: char| c.is_ascii_digit()) => "out of range",
            _ => "not a number",
        },
        PropertyKind::Duration => match text.strip_prefix('-').map(parse_duration) {
            Some(Ok(_)) => "negative",
            _ if parse_duration(text).is_err_and(|said| said.ends_with("longer than any run can last")) => {
                "out of range"
            }
            _ => "not a duration",
        },
        PropertyKind::String | PropertyKind::Enumeration => "not allowed",
        PropertyKind::Complex => "a single value",
    }
}

struct Expected<'a>(&'a Rule<'a>);

impl fmt::Display for Expected<'_> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let rule = self.0;
        if !rule.allowed.is_empty() {
            return list(rule.allowed, formatter);
        }
        formatter.write_str(match rule.kind {
            PropertyKind::Boolean => "`true` or `false`",
            PropertyKind::Integer => "a whole number",
            PropertyKind::Float => "a number",
            PropertyKind::String if rule.non_empty => "a text that is not empty",
            PropertyKind::String => "a text",
            PropertyKind::Duration => "a duration",
            PropertyKind::Enumeration => "one of the allowed values",
            PropertyKind::Complex => "properties of its own",
        })?;
        match (rule.min, rule.max, rule.exclusive_max) {
            (None, None, None) => {}
            (Some(min), None, None) => write!(formatter, ", at least {min}")?,
            (None, Some(max), _) => write!(formatter, ", at most {max}")?,
            (None, None, Some(max)) => write!(formatter, ", below {max}")?,
            (Some(min), Some(max), _) => write!(formatter, " from {min} to {max}")?,
            (Some(min), None, Some(max)) => write!(formatter, " from {min} to below {max}")?,
        }
        match (rule.unit, rule.kind) {
            (_, PropertyKind::Duration) => formatter.write_str(" (in ms, or with a unit: ns, us, ms, s, min, h)"),
            (Some(unit), _) => write!(formatter, " [{unit}]"),
            (None, _) => Ok(()),
        }
    }
}

fn list(allowed: &[&str], formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
    for (place, value) in allowed.iter().enumerate() {
        let before = match place {
            0 => "",
            last if last + 1 == allowed.len() => " or ",
            _ => ", ",
        };
        write!(formatter, "{before}`{value}`")?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn plain_bounds_allow_what_the_rule_allows() {
        let bounds = [
            None,
            Some("0"),
            Some("7"),
            Some("-7"),
            Some("07"),
            Some(" 7"),
            Some("+7"),
            Some("999999999"),
            Some("1000000000"),
            Some("-1000000000"),
            Some("x"),
        ];
        let texts = ["0", "6", "7", "007", "8", "999999998", "999999999", "1000000000", "-7", "+7", " 7", "", "x"];
        let mut plain = 0;
        for (min, max) in bounds.iter().flat_map(|min| bounds.iter().map(|max| (*min, *max))) {
            let rule = Rule { min, max, ..Rule::of(PropertyKind::Integer) };
            for text in texts {
                let read = PlainBounds::of(&rule).and_then(|bounds| bounds.read(text));
                let by_rule = rule.within(text, integer, |_, _, _| false);
                assert!(read.is_none_or(|read| by_rule == Ok(i128::from(read))), "{rule:?}: {text}");
                plain += usize::from(read.is_some());
            }
        }
        assert_eq!(plain, 161, "texts that are plain numbers within plain bounds");
        let rule = Rule { exclusive_max: Some("7"), ..Rule::of(PropertyKind::Integer) };
        assert_eq!(PlainBounds::of(&rule), None);
        assert_eq!(PlainBounds::of(&Rule::of(PropertyKind::Float)), None);
    }

    #[test]
    fn bounds_that_are_not_read_are_beyond_the_number() {
        let bounds = [
            "0",
            "7",
            "-7",
            "999999999",
            "1000000000",
            "-999999999",
            "-1000000000",
            "4294967295",
            "-2147483648",
            "9223372036854775808",
            "-170141183460469231731687303715884105728",
            "0000000001",
            "-0000000001",
        ];
        let numbers = [0, 1, -1, 999_999_999, -999_999_999, 1_000_000_000, -1_000_000_000, i128::MAX, i128::MIN];
        let mut unread = 0;
        for (bound, number) in bounds.iter().flat_map(|bound| numbers.map(|number| (*bound, number))) {
            let read: i128 = bound.parse().unwrap();
            for is_least in [false, true] {
                let is_far = is_far(&number, bound, is_least);
                assert!(!is_far || if is_least { read < number } else { read > number }, "{bound} of {number}");
                unread += usize::from(is_far);
            }
        }
        assert_eq!(unread, 30, "of each of the larger bounds, where the number is of ordinary size");
    }
}
