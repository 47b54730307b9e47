//! What expressions come to, and how it is converted and compared (XPath 1.0, 3.4 and 4).

use super::evaluate::Scope;
use crate::check::instance::Instance;
use crate::source::FileId;
use crate::xml::{Attribute, Element, ElementId};

/// What an expression comes to.
pub(super) enum Value<'a> {
    /// Nodes in document order, each once.
    Nodes(Vec<Node<'a>>),
    Text(String),
    Number(f64),
    Boolean(bool),
}

/// A part of the value of a property.
#[derive(Clone, Copy)]
pub(super) enum Node<'a> {
    /// A whole value: the place of the variable, and of the value among those of it.
    Value(usize, usize),
    Element(Element<'a>, Option<&'a Instance>),
    /// An attribute with its element.
    Attribute(Attribute<'a>, Element<'a>, Option<&'a Instance>),
    /// The text directly inside an element.
    Text(Element<'a>, Option<&'a Instance>),
}

/// What tells a node from others, and its order among them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(super) enum Key {
    Value(usize, usize),
    Part(FileId, ElementId, u32),
}

impl Node<'_> {
    pub(super) fn key(&self) -> Key {
        match self {
            Self::Value(variable, value) => Key::Value(*variable, *value),
            Self::Element(one, _) => Key::Part(one.document().file(), one.id(), 0),
            Self::Text(one, _) => Key::Part(one.document().file(), one.id(), 1),
            Self::Attribute(attribute, one, _) => {
                Key::Part(one.document().file(), one.id(), 2 + attribute.span().start)
            }
        }
    }
}

impl<'a> Value<'a> {
    pub(super) fn boolean(&self) -> bool {
        match self {
            Self::Nodes(nodes) => !nodes.is_empty(),
            Self::Text(text) => !text.is_empty(),
            Self::Number(number) => *number != 0.0 && !number.is_nan(),
            Self::Boolean(value) => *value,
        }
    }

    pub(super) fn text(&self, scope: &Scope<'_, 'a>) -> String {
        match self {
            Self::Nodes(nodes) => nodes.first().map_or_else(String::new, |node| scope.text(node)),
            Self::Text(text) => text.clone(),
            Self::Number(number) => written(*number),
            Self::Boolean(value) => value.to_string(),
        }
    }

    pub(super) fn number(&self, scope: &Scope<'_, 'a>) -> f64 {
        match self {
            Self::Number(number) => *number,
            Self::Boolean(value) => f64::from(u8::from(*value)),
            other => number(&other.text(scope)),
        }
    }
}

/// A number as XPath writes it.
fn written(number: f64) -> String {
    if number.is_infinite() {
        return if number > 0.0 { "Infinity".to_owned() } else { "-Infinity".to_owned() };
    }
    // There is one zero.
    format!("{}", if number == 0.0 { 0.0 } else { number })
}

/// The number that a text is; not a number where it is none.
pub(super) fn number(text: &str) -> f64 {
    let text = text.trim();
    let is_part = |letter: char| letter.is_ascii_digit() || letter == '.';
    match text.strip_prefix('-').unwrap_or(text).chars().all(is_part) {
        true => text.parse().unwrap_or(f64::NAN),
        false => f64::NAN,
    }
}

/// Whether two values compare so. Of nodes it is enough that one does.
pub(super) fn compares<'a>(
    operator: &str,
    left: &Value<'a>,
    right: &Value<'a>,
    scope: &Scope<'_, 'a>,
) -> bool {
    match (left, right) {
        (Value::Boolean(_), _) | (_, Value::Boolean(_)) if matches!(operator, "=" | "!=") => {
            (left.boolean() == right.boolean()) == (operator == "=")
        }
        (Value::Nodes(nodes), Value::Boolean(_)) | (Value::Boolean(_), Value::Nodes(nodes)) => {
            let is_there = Value::Boolean(!nodes.is_empty());
            match left {
                Value::Nodes(_) => compares(operator, &is_there, right, scope),
                _ => compares(operator, left, &is_there, scope),
            }
        }
        (Value::Nodes(nodes), other) => nodes
            .iter()
            .any(|node| scope.spend(1) && compares(operator, &Value::Text(scope.text(node)), other, scope)),
        (other, Value::Nodes(nodes)) => nodes
            .iter()
            .any(|node| scope.spend(1) && compares(operator, other, &Value::Text(scope.text(node)), scope)),
        (Value::Text(one), Value::Text(other)) if matches!(operator, "=" | "!=") => {
            (one == other) == (operator == "=")
        }
        _ => {
            let (one, other) = (left.number(scope), right.number(scope));
            match operator {
                "=" => one == other,
                "!=" => one != other,
                "<" => one < other,
                "<=" => one <= other,
                ">" => one > other,
                _ => one >= other,
            }
        }
    }
}
