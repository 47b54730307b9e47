use crate::host::declaration::{ConstText, PropertyKind, Rule, Scalar};
use crate::host::{PropertyValue, SmolStr};
use crate::time::read_duration;

/// The type of a property: `bool`, the integers, `f32` and `f64` (finite), `String`, `SmolStr`, `Duration`, enums
/// (derive it), other [`Properties`](crate::Properties) structs, `Option` of these (need not be given) and `Vec` of
/// these (any number of values).
///
/// `#[derive(PropertyField)]` on an enum without data allows the names of its variants in lowerCamelCase, or what
/// `#[property(name = "...")]` on a variant says.
pub trait PropertyField: Sized {
    /// Shape of the property in its declaration.
    const TYPE: PropertyShape;

    /// Reads a value.
    ///
    /// # Errors
    /// The message, with found and expected value.
    fn from_value(value: &PropertyValue) -> Result<Self, String>;

    /// The same from the text of a scalar that was read and checked already; `None` where the type is not made of such.
    fn from_scalar(_: Scalar) -> Option<Result<Self, String>> {
        None
    }

    /// The same from a text that its rule allows; `None` where the type is no text.
    fn from_text(_: &SmolStr) -> Option<Self> {
        None
    }

    /// The same from the text of a choice; `None` where that is none, and where the type has no choices.
    fn from_choice(_: &str) -> Option<Self> {
        None
    }

    /// The value of a property that the composite does not give; `None` where it has to.
    fn absent() -> Option<Self> {
        None
    }

    /// The value as a composite gives it; `None` where it gives none, and for a type that is read alone.
    fn to_value(&self) -> Option<PropertyValue> {
        None
    }
}

/// The part of a property's declaration that its type determines.
#[derive(Clone, Copy, Debug)]
pub struct PropertyShape {
    /// Rule of one value.
    pub rule: Rule<'static>,
    /// True if it takes any number of values.
    pub many: bool,
    /// True if it may be absent without a default.
    pub optional: bool,
    /// Further members of the JSON object, each with a comma before it.
    pub details: ConstText,
}

impl PropertyShape {
    /// One value of a scalar type, required.
    pub const fn scalar(rule: Rule<'static>) -> PropertyShape {
        PropertyShape { rule, many: false, optional: false, details: ConstText::EMPTY }
    }

    /// The same with these details.
    pub const fn with_details(self, details: ConstText) -> PropertyShape {
        PropertyShape { details, ..self }
    }

    /// `"name":bound` with a comma before it, or nothing.
    pub const fn bound(kind: PropertyKind, label: &'static str, bound: Option<&'static str>) -> [ConstText; 2] {
        match (bound, kind) {
            (None, _) => [ConstText::EMPTY, ConstText::EMPTY],
            (Some(bound), PropertyKind::Duration) => [ConstText::Plain(label), ConstText::Quoted(bound)],
            (Some(bound), _) => [ConstText::Plain(label), ConstText::Plain(bound)],
        }
    }
}

/// True if the rule allows a default. Runs at compile time, for types that the macro itself cannot see; the compiler
/// checks the literals of plain `bool`s and numbers.
pub const fn default_fits(rule: &Rule<'_>, default: &str) -> bool {
    match rule.kind {
        PropertyKind::Boolean => contains(&["true", "false"], default),
        PropertyKind::Enumeration => contains(rule.allowed, default),
        PropertyKind::Integer => match integer(default) {
            Some(default) => {
                !(matches!(bound(rule.min), Some(min) if default < min)
                    || matches!(bound(rule.max), Some(max) if default > max)
                    || matches!(bound(rule.exclusive_max), Some(max) if default >= max))
            }
            None => false,
        },
        PropertyKind::Duration => {
            let Ok(default) = read_duration(default) else { return false };
            let default = default.as_nanos();
            !(matches!(nanos(rule.min), Some(min) if default < min)
                || matches!(nanos(rule.max), Some(max) if default > max)
                || matches!(nanos(rule.exclusive_max), Some(max) if default >= max))
        }
        PropertyKind::Float => matches!(default.as_bytes(), [b'0'..=b'9', ..] | [b'-', b'0'..=b'9', ..]),
        PropertyKind::String => true,
        PropertyKind::Complex => false,
    }
}

const fn bound(bound: Option<&str>) -> Option<i128> {
    match bound {
        Some(bound) => integer(bound),
        None => None,
    }
}

const fn integer(text: &str) -> Option<i128> {
    match i128::from_str_radix(text, 10) {
        Ok(number) => Some(number),
        Err(_) => None,
    }
}

/// True if the bounds of the rule are values of its type. Runs at compile time.
pub const fn bounds_fit(rule: &Rule<'_>) -> bool {
    let some = rule.min.is_some() || rule.max.is_some() || rule.exclusive_max.is_some();
    match rule.kind {
        PropertyKind::Integer | PropertyKind::Float => true,
        PropertyKind::Duration => {
            (rule.min.is_none() || nanos(rule.min).is_some())
                && (rule.max.is_none() || nanos(rule.max).is_some())
                && (rule.exclusive_max.is_none() || nanos(rule.exclusive_max).is_some())
        }
        _ => !some,
    }
}

const fn nanos(bound: Option<&str>) -> Option<u128> {
    match bound {
        Some(bound) => match read_duration(bound) {
            Ok(duration) => Some(duration.as_nanos()),
            Err(_) => None,
        },
        None => None,
    }
}

/// True if a name is in a list. Runs at compile time.
pub const fn contains(names: &[&str], name: &str) -> bool {
    let mut at = 0;
    while at < names.len() {
        if equal(names[at].as_bytes(), name.as_bytes()) {
            return true;
        }
        at += 1;
    }
    false
}

/// True if two names are equal. Runs at compile time.
pub const fn equal(one: &[u8], other: &[u8]) -> bool {
    if one.len() != other.len() {
        return false;
    }
    let mut at = 0;
    while at < one.len() {
        if one[at] != other[at] {
            return false;
        }
        at += 1;
    }
    true
}
