use super::scalar;
use crate::host::PropertyValue;
use crate::host::declaration::{Bound, ConstText, PropertyKind, Rule, Scalar};

/// The type of a property: `bool`, the integers, `f32` and `f64` (finite), `String`, `SmolStr`, `Secret`, `Duration`,
/// enums (derive it), other [`Properties`](crate::Properties) structs, `Option` of these (need not be given) and `Vec`
/// of these (any number of values).
///
/// `#[derive(PropertyField)]` on an enum without data allows the names of its variants in lowerCamelCase, or what
/// `#[property(name = "...")]` on a variant says.
pub trait PropertyField: Sized {
    /// Shape of the property in its declaration.
    const TYPE: PropertyShape;

    /// Reads a value through the rule of the property, which is that of the type or narrower.
    ///
    /// # Errors
    /// The message, with found and expected value.
    fn from_value(value: &PropertyValue, rule: &Rule<'_>) -> Result<Self, String> {
        let read = Self::from_scalar(&*scalar(value, rule)?);
        read.unwrap_or_else(|| Err(format!("expected {}", rule.expected())))
    }

    /// The same from a scalar that the rule allows; `None` where the type is not made of such.
    fn from_scalar(_: &Scalar) -> Option<Result<Self, String>> {
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
    pub const fn bound(kind: PropertyKind, label: &'static str, bound: Option<Bound<'static>>) -> [ConstText; 2] {
        match (bound, kind) {
            (None, _) => [ConstText::EMPTY, ConstText::EMPTY],
            (Some(bound), PropertyKind::Duration) => [ConstText::Plain(label), ConstText::Quoted(bound.text())],
            (Some(bound), _) => [ConstText::Plain(label), ConstText::Plain(bound.text())],
        }
    }
}

/// True if the rule allows a default. Runs at compile time, for types that the macro itself cannot see; the compiler
/// checks the literals of plain `bool`s and numbers.
pub const fn default_fits(rule: &Rule<'_>, text: &str, default: &Scalar) -> bool {
    match rule.kind {
        PropertyKind::Enumeration => contains(rule.allowed, text),
        _ => rule.is_within(default),
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
