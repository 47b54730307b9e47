use super::PropertyField;
use crate::declaration::{PropertyKind, Rule, parse_scalar, trim};
use crate::{Failure, Finding, Place, Properties, PropertyValue};

/// Reads one property from the values of a composite.
///
/// # Errors
/// It is missing or not what the rule allows.
pub fn property<T: PropertyField>(
    values: &[(String, PropertyValue)],
    name: &str,
    default: Option<&str>,
    rule: &Rule<'_>,
) -> Result<T, Failure> {
    let failure = |message: String| Failure::from(Finding::new(Place::property(name), message));
    let given = values.iter().find(|(given, _)| given == name).map(|(_, value)| value);
    let value = match (given, default) {
        (Some(value), _) => value,
        // That the rule allows it was seen to when it was compiled and registered.
        (None, Some(default)) => {
            let read = parse_scalar(rule.kind, default).and_then(T::from_scalar);
            let otherwise = || T::from_value(&PropertyValue::Text(default.to_owned()));
            return read.unwrap_or_else(otherwise).map_err(failure);
        }
        (None, None) => {
            let missing =
                || Failure::new(format!("property `{name}` is missing: expected {}", rule.expected()));
            return T::absent().ok_or_else(missing);
        }
    };
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

/// Refuses names that are not declared, and names that are given twice.
///
/// # Errors
/// The first such name.
pub fn only_known(values: &[(String, PropertyValue)], names: &[&str]) -> Result<(), Failure> {
    for (place, (name, _)) in values.iter().enumerate() {
        if !names.contains(&name.as_str()) {
            let known = if names.is_empty() { "no property".to_owned() } else { names.join(", ") };
            return Err(Failure::new(format!("property `{name}` is unknown: expected {known}")));
        }
        if values[..place].iter().any(|(earlier, _)| earlier == name) {
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
