use crate::PropertyValue;
use crate::declaration::{PropertyKind, Rule, Text};

/// The type of a property: `bool`, the integers, `f32` and `f64` (finite), `String`, `Duration`, enums (derive it), other
/// [`Properties`](crate::Properties) structs, `Option` of these (need not be given) and `Vec` of these (any number of values).
///
/// `#[derive(PropertyField)]` on an enum without data allows the names of its variants in lowerCamelCase, or what
/// `#[property(name = "...")]` on a variant says.
pub trait PropertyField: Sized {
    /// What the declaration says about it.
    const TYPE: PropertyShape;

    /// Reads a value.
    ///
    /// # Errors
    /// What was found and what was expected.
    fn from_value(value: &PropertyValue) -> Result<Self, String>;

    /// The value of a property that the composite does not give; `None` where it has to.
    fn absent() -> Option<Self> {
        None
    }
}

/// What the type of a property contributes to its declaration.
#[derive(Clone, Copy, Debug)]
pub struct PropertyShape {
    /// What one value accepts.
    pub rule: Rule<'static>,
    /// Whether it takes any number of values.
    pub many: bool,
    /// Whether it may be absent without a default.
    pub optional: bool,
    /// Further members of the JSON object, each with a comma before it.
    pub details: Text,
}

impl PropertyShape {
    /// One value of a scalar type, required.
    pub const fn scalar(rule: Rule<'static>) -> PropertyShape {
        PropertyShape { rule, many: false, optional: false, details: Text::EMPTY }
    }

    /// The same with these details.
    pub const fn with_details(self, details: Text) -> PropertyShape {
        PropertyShape { details, ..self }
    }

    /// Whether a text is among the allowed ones; for checks of defaults while compiling.
    pub const fn allows(&self, text: &str) -> bool {
        self.rule.allowed.is_empty() || contains(self.rule.allowed, text)
    }

    /// `"name":bound` with a comma before it, or nothing.
    pub const fn bound(kind: PropertyKind, label: &'static str, bound: Option<&'static str>) -> [Text; 2] {
        match (bound, kind) {
            (None, _) => [Text::EMPTY, Text::EMPTY],
            (Some(bound), PropertyKind::Duration) => [Text::Plain(label), Text::Quoted(bound)],
            (Some(bound), _) => [Text::Plain(label), Text::Plain(bound)],
        }
    }
}

/// Whether a name is in a list, while compiling.
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

const fn equal(one: &[u8], other: &[u8]) -> bool {
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
