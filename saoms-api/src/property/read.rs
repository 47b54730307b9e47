use std::borrow::Cow;

use super::{PropertyField, values_of};
use crate::host::declaration::{Rule, Scalar};
use crate::host::{PropertyValue, SmolStr};
use crate::{Failure, Finding, Place, Properties};

/// Reads one property from the values of a composite, or its default, which the rule allows.
///
/// # Errors
/// It is missing or not what the rule allows.
// Failures are few and large, so that they are boxed.
pub fn property<T: PropertyField>(
    values: &mut Values<'_>,
    name: &str,
    default: Option<&Scalar>,
    rule: &Rule<'_>,
) -> Result<T, Box<Failure>> {
    let read = match values.take(name) {
        Some(value) => Some(T::from_value(value, rule)),
        None => default.map(|default| {
            let read = T::from_scalar(default);
            read.unwrap_or_else(|| T::from_value(&default.clone().into(), rule))
        }),
    };
    match read {
        Some(read) => read.map_err(|message| failure(name, message)),
        None => T::absent().ok_or_else(|| missing(name, rule)),
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

/// Takes a scalar through its rule.
///
/// # Errors
/// As [`Rule::take`], or the value is none.
#[inline]
pub fn scalar<'v>(value: &'v PropertyValue, rule: &Rule<'_>) -> Result<Cow<'v, Scalar>, String> {
    let found = match value {
        PropertyValue::Scalar(scalar) => return rule.take(scalar),
        PropertyValue::Many(_) => "a list",
        PropertyValue::Complex(_) => "a complex value",
    };
    Err(format!("found {found}: expected {}", rule.expected()))
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
    #[inline]
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
        PropertyValue::Scalar(scalar) => format!("`{}`", scalar.text().trim()),
        PropertyValue::Many(_) => "a list".to_owned(),
    };
    Err(format!("found {found}: expected the properties {}", P::NAMES.join(", ")))
}
