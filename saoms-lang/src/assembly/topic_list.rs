//! The language of the task property `trigger`: names of topics, separated by blanks or commas.

use std::ops::Range;

use saoms_api::PropertyField;
use saoms_api::host::PropertyValue;
use saoms_api::host::declaration::{PropertyKind, PropertyShape, Rule};

/// A list of topics, by the names that the class declares.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct TopicList(pub Vec<String>);

impl TopicList {
    /// True if the topic that a class declares under this name is one of them.
    pub fn has(&self, declared: &str) -> bool {
        self.0.iter().any(|name| name == declared)
    }
}

/// The names in a text, each with its bytes.
pub(crate) fn names(text: &str) -> impl Iterator<Item = (&str, Range<usize>)> {
    let is_separator = |c: char| c == ',' || c.is_whitespace();
    let names = text.split(is_separator).filter(|name| !name.is_empty());
    names.map(move |name| {
        let start = name.as_ptr() as usize - text.as_ptr() as usize;
        (name, start..start + name.len())
    })
}

impl PropertyField for TopicList {
    const TYPE: PropertyShape =
        PropertyShape { optional: true, ..PropertyShape::scalar(Rule::of(PropertyKind::String)) };

    fn from_value(value: &PropertyValue, _: &Rule<'_>) -> Result<Self, String> {
        let text = value.as_text().ok_or_else(|| "expected names of topics".to_owned())?;
        Ok(Self(names(text).map(|(name, _)| name.to_owned()).collect()))
    }

    fn absent() -> Option<Self> {
        Some(Self::default())
    }

    fn to_value(&self) -> Option<PropertyValue> {
        (!self.0.is_empty()).then(|| PropertyValue::from(&*self.0.join(" ")))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_separated_by_blanks_or_commas() {
        let found: Vec<_> = names(" A,B\n\t C , ").collect();
        assert_eq!(found, [("A", 1..2), ("B", 3..4), ("C", 7..8)]);
    }
}
