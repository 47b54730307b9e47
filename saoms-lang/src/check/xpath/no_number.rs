//! Arithmetic over what is no number, which comes to `NaN` (XPath 1.0, 3.5): as a rule texts were to be joined.

use std::ops::Range;

use super::parse::{Expression, Node};
use super::value::Value;
use crate::check::path::Fault;
use crate::diagnostic::quoted;

/// An operand of arithmetic that is no number.
pub(super) struct NoNumber {
    at: Range<usize>,
    why: String,
    /// Whether it is a text, which may be meant to be joined.
    is_text: bool,
}

impl NoNumber {
    /// The operand of an operator in a text, with its value and what that is as a text.
    pub(super) fn new(
        operator: &str,
        (operand, whole): (&Expression, &str),
        value: &Value<'_>,
        text: &str,
    ) -> Self {
        let at = operand.span.clone();
        let shown = quoted(&whole[at.clone()]);
        let is_text = !text.is_empty();
        let what = match (&operand.node, value) {
            (Node::Literal(_), _) => format!("{shown} is no number"),
            (_, Value::Nodes(nodes)) if nodes.is_empty() => format!("{shown} leads to nothing"),
            _ if is_text => format!("{shown} is {}, which is no number", quoted(text)),
            _ => format!("{shown} is empty"),
        };
        let why = match operator {
            "+" if is_text => format!("{what}, and `+` adds numbers: `concat(...)` joins texts"),
            _ => format!("{what}, and `{operator}` takes numbers"),
        };
        Self { at, why, is_text }
    }

    /// The fault of an expression that comes to `NaN` by it: where all is added, texts are to be joined.
    pub(super) fn fault(self, expression: &Expression, text: &str) -> Fault {
        let (mut parts, mut rest) = (Vec::new(), expression);
        while let Node::Binary("+", left, right) = &rest.node {
            parts.push(&text[right.span.clone()]);
            rest = left;
        }
        if parts.is_empty() || !self.is_text {
            return Fault::new(self.at, self.why);
        }
        parts.push(&text[rest.span.clone()]);
        parts.reverse();
        let span = expression.span.clone();
        let instead = Some((text[span.clone()].to_owned(), format!("concat({})", parts.join(", "))));
        Fault { instead, ..Fault::new(span, self.why) }
    }
}
