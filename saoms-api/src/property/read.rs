use super::{PropertyField, equal, values_of};
use crate::host::declaration::{PlainBounds, PropertyKind, Rule, Scalar, parse_scalar, trim};
use crate::host::{PropertyValue, SmolStr};
use crate::time::read_duration;
use crate::{Failure, Finding, Place, Properties};

/// The default of a property: as text, and as the compiler reads it, which it cannot where this is text or a choice.
#[derive(Clone, Debug)]
pub struct Preset {
    text: &'static str,
    scalar: Option<Scalar>,
}

impl Preset {
    /// A default of this kind; a number with a fraction comes as such, too.
    pub const fn of(kind: PropertyKind, text: &'static str, fraction: Option<f64>) -> Preset {
        let scalar = match (kind, fraction) {
            (PropertyKind::Boolean, _) => Some(Scalar::Boolean(equal(text.as_bytes(), b"true"))),
            (PropertyKind::Float, Some(number)) => Some(Scalar::Float(number)),
            (PropertyKind::Integer, _) => match i128::from_str_radix(text, 10) {
                Ok(number) => Some(Scalar::Integer(number)),
                Err(_) => None,
            },
            (PropertyKind::Duration, _) => match read_duration(text) {
                Ok(duration) => Some(Scalar::Duration(duration)),
                Err(_) => None,
            },
            _ => None,
        };
        Preset { text, scalar }
    }

    /// Reads the preset. The rule allows it: that was checked when it was compiled and registered.
    #[inline(always)]
    fn read<T: PropertyField>(self, kind: PropertyKind) -> Result<T, String> {
        if let Some(read) = T::from_choice(self.text) {
            return Ok(read);
        }
        match self.scalar.and_then(T::from_scalar) {
            Some(read) => read,
            None => read_default(self.text, kind),
        }
    }
}

/// The default that is no choice, and that the compiler cannot read.
fn read_default<T: PropertyField>(text: &str, kind: PropertyKind) -> Result<T, String> {
    let read = parse_scalar(kind, text).and_then(T::from_scalar);
    read.unwrap_or_else(|| T::from_value(&PropertyValue::from(text)))
}

/// Reads one property from the values of a composite.
///
/// # Errors
/// It is missing or not what the rule allows.
// What is called for each property of each component is inlined, so that names are compared by their known lengths, and
// defaults and bounds are there without being read. Failures are few and large, so that they are boxed.
#[inline(always)]
pub fn property<T: PropertyField>(
    values: &mut Values<'_>,
    name: &str,
    default: Option<Preset>,
    (rule, bounds): (&Rule<'_>, Option<PlainBounds>),
) -> Result<T, Box<Failure>> {
    let Some(value) = values.take(name) else {
        return match default {
            Some(default) => default.read(rule.kind).map_err(|message| failure(name, message)),
            None => T::absent().ok_or_else(|| missing(name, rule)),
        };
    };
    let plain = value.as_text().and_then(|text| match bounds {
        Some(bounds) => T::from_scalar(Scalar::Integer(i128::from(bounds.read(text)?)))?.ok(),
        None => T::from_text(text).filter(|_| rule.allows_plain_text(text)),
    });
    match plain {
        Some(read) => Ok(read),
        None => given(value, name, rule),
    }
}

#[cold]
fn missing(name: &str, rule: &Rule<'_>) -> Box<Failure> {
    Box::new(Failure::new(format!("property `{name}` is missing: expected {}", rule.expected())))
}

#[cold]
fn failure(name: &str, message: String) -> Box<Failure> {
    Box::new(Finding::new(Place::property(name), message).into())
}

fn given<T: PropertyField>(value: &PropertyValue, name: &str, rule: &Rule<'_>) -> Result<T, Box<Failure>> {
    let failure = |message| failure(name, message);
    if let (PropertyValue::Text(text), true) = (value, rule.kind.is_scalar())
        && let Some(read) = T::from_scalar(rule.check(text).map_err(failure)?)
    {
        return read.map_err(failure);
    }
    let value_read = T::from_value(value);
    // The rule of the property is narrower than that of its type, so its message says more.
    accept(value, rule).map_err(failure)?;
    value_read.map_err(failure)
}

fn accept(value: &PropertyValue, rule: &Rule<'_>) -> Result<(), String> {
    match value {
        PropertyValue::Text(_) if rule.kind == PropertyKind::Complex => Ok(()),
        PropertyValue::Text(text) => rule.check(text).map(|_| ()),
        PropertyValue::Many(values) => values.iter().try_for_each(|value| accept(value, rule)),
        PropertyValue::Complex(_) => Ok(()),
    }
}

/// The values that a composite gives, to be taken in the order of the declaration.
#[derive(Debug)]
pub struct Values<'v> {
    all: &'v [(SmolStr, PropertyValue)],
    /// Those that were not taken yet; `None` where they are not in that order.
    rest: Option<&'v [(SmolStr, PropertyValue)]>,
}

impl<'v> Values<'v> {
    /// The value of this name.
    #[inline(always)]
    fn take(&mut self, name: &str) -> Option<&'v PropertyValue> {
        match self.rest {
            Some([(given, value), rest @ ..]) if given == name => {
                self.rest = Some(rest);
                Some(value)
            }
            Some(_) => None,
            None => self.find(name),
        }
    }

    #[cold]
    fn find(&self, name: &str) -> Option<&'v PropertyValue> {
        self.all.iter().find(|(given, _)| given == name).map(|(_, value)| value)
    }

    /// Passes over those with these names.
    fn pass(&mut self, names: &[&str]) {
        while let Some([(name, _), rest @ ..]) = self.rest
            && names.contains(&name.as_str())
        {
            self.rest = Some(rest);
        }
    }
}

/// Reads the values of a property struct that stands in the place of a field.
///
/// # Errors
/// As [`Properties::from_values`].
pub fn flat<P: Properties>(values: &mut Values<'_>) -> Result<P, Box<Failure>> {
    let inner = values_of(values.all, P::NAMES);
    values.pass(P::NAMES);
    P::from_values(&inner).map_err(Box::new)
}

/// Makes a property struct of values; `names` are those of its declaration, in order.
///
/// # Errors
/// As [`Properties::from_values`].
pub fn read<P>(
    all: &[(SmolStr, PropertyValue)],
    names: &[&str],
    make: fn(&mut Values<'_>) -> Result<P, Box<Failure>>,
) -> Result<P, Failure> {
    // In the order of the declaration, as hosts give them, all are taken, and so each is known and there once.
    let mut in_order = Values { all, rest: Some(all) };
    let mut made = make(&mut in_order);
    if in_order.rest != Some(&[]) {
        only_known(all, names)?;
        made = make(&mut Values { all, rest: None });
    }
    made.map_err(|failure| *failure)
}

/// Refuses names that are not declared, and names that are given twice.
///
/// # Errors
/// The first such name.
pub(super) fn only_known(all: &[(SmolStr, PropertyValue)], names: &[&str]) -> Result<(), Failure> {
    for (place, (name, _)) in all.iter().enumerate() {
        if !names.contains(&name.as_str()) {
            let known = if names.is_empty() { "no property".to_owned() } else { names.join(", ") };
            return Err(Failure::new(format!("property `{name}` is unknown: expected {known}")));
        }
        if all[..place].iter().any(|(earlier, _)| earlier == name) {
            return Err(Failure::new(format!("property `{name}` is given twice")));
        }
    }
    Ok(())
}

/// Reads a complex value.
///
/// # Errors
/// As [`Properties::from_values`], or the value is not complex.
pub fn complex<P: Properties>(value: &PropertyValue) -> Result<P, String> {
    let found = match value {
        PropertyValue::Complex(values) => {
            return P::from_values(values).map_err(|failure| failure.message().to_owned());
        }
        PropertyValue::Text(text) => format!("`{}`", text.trim()),
        PropertyValue::Many(_) => "a list".to_owned(),
    };
    Err(format!("found {found}: expected the properties {}", P::NAMES.join(", ")))
}

/// Reads the choice of an enumeration: its place among the allowed texts.
///
/// # Errors
/// The value is not one of them.
pub fn chosen(value: &PropertyValue, allowed: &[&str]) -> Result<usize, String> {
    let rule = Rule { allowed, ..Rule::of(PropertyKind::Enumeration) };
    let PropertyValue::Text(text) = value else { return Err(format!("expected {}", rule.expected())) };
    let found = trim(text);
    let place = allowed.iter().position(|allowed| *allowed == found);
    place.ok_or_else(|| rule.check(text).err().unwrap_or_else(|| format!("expected {}", rule.expected())))
}
