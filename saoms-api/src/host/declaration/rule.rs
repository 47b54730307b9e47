use std::borrow::Cow;
use std::fmt;

use smol_str::SmolStr;

use super::{Bound, PropertyKind, Scalar, parse_scalar, trim};
use crate::host::parse_duration;

/// Rule of the values of a scalar property, from its declaration. The checker and the component read values through it,
/// so they agree.
///
/// ```
/// use saoms_api::host::declaration::{Bound, PropertyKind, Rule, Scalar};
///
/// let bound = |text| Bound::read(PropertyKind::Integer, text);
/// let rule = Rule { min: bound("1"), max: bound("99"), unit: Some("%"), ..Rule::of(PropertyKind::Integer) };
/// assert_eq!(rule.check("35"), Ok(Scalar::Integer(35.into())));
/// assert_eq!(rule.check("0").unwrap_err(), "`0` is out of range: expected a whole number from 1 to 99 [%]");
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rule<'a> {
    /// Its type.
    pub kind: PropertyKind,
    /// The least value.
    pub min: Option<Bound<'a>>,
    /// The greatest value.
    pub max: Option<Bound<'a>>,
    /// The value below which it has to stay.
    pub exclusive_max: Option<Bound<'a>>,
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
    pub fn check(&self, text: impl Into<SmolStr>) -> Result<Scalar, String> {
        self.read(&text.into())
    }

    fn read(&self, text: &SmolStr) -> Result<Scalar, String> {
        if (self.non_empty || self.kind != PropertyKind::String) && trim(text).is_empty() {
            return Err(format!("the value is empty: expected {}", Expected(self)));
        }
        match parse_scalar(self.kind, text) {
            Some(value) if self.allows(&value) => Ok(value),
            Some(Scalar::Text(_)) => Err(self.refusal("not allowed", text)),
            Some(_) => Err(self.refusal("out of range", text)),
            None => Err(self.refusal(why_not(self.kind, text), text)),
        }
    }

    /// Takes a value that a property is given: as it is if the rule allows it, or else read from its text. So what a
    /// plugin gets as text is read, and a value of another type is taken for what it would mean in a file.
    ///
    /// # Errors
    /// As [`check`](Rule::check).
    #[inline]
    pub fn take<'v>(&self, given: &'v Scalar) -> Result<Cow<'v, Scalar>, String> {
        match self.allows(given) {
            true => Ok(Cow::Borrowed(given)),
            false => self.read(&given.text()).map(Cow::Owned),
        }
    }

    /// True for a value of its type that it allows.
    #[inline]
    fn allows(&self, value: &Scalar) -> bool {
        let Scalar::Text(text) = value else { return self.is_within(value) };
        let trimmed = trim(text);
        let is_whole = match self.kind {
            PropertyKind::String => !self.non_empty || !trimmed.is_empty(),
            PropertyKind::Enumeration => !trimmed.is_empty() && trimmed.len() == text.len(),
            _ => false,
        };
        is_whole && (self.allowed.is_empty() || self.allowed.contains(&text.as_str()))
    }

    /// True for a value of its type within its bounds.
    #[inline]
    pub(crate) const fn is_within(&self, value: &Scalar) -> bool {
        match (self.kind, value) {
            (PropertyKind::Boolean, Scalar::Boolean(_))
            | (PropertyKind::String | PropertyKind::Enumeration, Scalar::Text(_)) => return true,
            (PropertyKind::Integer, Scalar::Integer(_))
            | (PropertyKind::Float, Scalar::Float(_))
            | (PropertyKind::Duration, Scalar::Duration(_)) => {}
            _ => return false,
        }
        let Some(value) = value.number() else { return false };
        !(matches!(self.min, Some(min) if value.is_below(min.number()))
            || matches!(self.max, Some(max) if max.number().is_below(value))
            || matches!(self.exclusive_max, Some(max) if !value.is_below(max.number())))
    }

    fn refusal(&self, what: &str, text: &str) -> String {
        format!("`{}` is {what}: expected {}", text.trim(), Expected(self))
    }

    /// Description of the expected value, as in `a whole number from 1 to 99 [%]`.
    pub fn expected(&self) -> String {
        Expected(self).to_string()
    }
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
        match [rule.min, rule.max, rule.exclusive_max].map(|bound| bound.map(|bound| bound.text())) {
            [None, None, None] => {}
            [Some(min), None, None] => write!(formatter, ", at least {min}")?,
            [None, Some(max), _] => write!(formatter, ", at most {max}")?,
            [None, None, Some(max)] => write!(formatter, ", below {max}")?,
            [Some(min), Some(max), _] => write!(formatter, " from {min} to {max}")?,
            [Some(min), None, Some(max)] => write!(formatter, " from {min} to below {max}")?,
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
