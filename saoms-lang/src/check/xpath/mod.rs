//! The XPath 1.0 of a `source`, whole: what [`path`](super::path) does not take.
//!
//! Variables are the properties of the composite (SCA Assembly 1.1, 4.1.3 and 5.2). As in paths, prefixes of names do not count, white space at the ends of
//! texts is left out, and a value that is one element has the parts of that. There is no root to start from, and no comments or instructions are seen.

mod evaluate;
mod functions;
mod no_number;
mod parse;
mod token;
mod value;

use std::cell::Cell;
use std::ops::Range;
use std::rc::Rc;

use super::path::Fault;
use super::raw::Raw;
use super::whole::Whole;
use crate::source::Location;
use parse::{Expression, Node, Step};

/// An XPath that was read.
pub(super) struct XPath<'t> {
    text: &'t str,
    expression: Expression,
}

impl<'t> XPath<'t> {
    /// Reads an XPath.
    pub(super) fn parse(text: &'t str) -> Result<Self, Fault> {
        parse::parse(text).map(|expression| Self { text, expression })
    }

    /// The properties that it names, each once, with the bytes of the name.
    pub(super) fn variables(&self) -> Vec<(String, Range<usize>)> {
        let mut all = Vec::new();
        variables(&self.expression, &mut all);
        all
    }

    /// What it comes to with these values of its variables. `left` is how many more parts may be looked at.
    pub(super) fn evaluate<'a>(
        &self,
        variables: &[(String, Rc<Whole<'a>>)],
        left: &Cell<usize>,
        place: Location,
    ) -> Result<Raw<'a>, Fault> {
        evaluate::evaluate(&self.expression, self.text, (variables, left), place)
    }
}

fn variables(expression: &Expression, all: &mut Vec<(String, Range<usize>)>) {
    let mut of = |inner: &Expression| variables(inner, all);
    match &expression.node {
        Node::Variable(name) => {
            if all.iter().all(|(known, _)| known != name) {
                all.push((name.clone(), expression.span.start + 1..expression.span.end));
            }
        }
        Node::Call(_, inner) => inner.iter().for_each(of),
        Node::Negation(inner) => of(inner),
        Node::Binary(_, left, right) => {
            of(left);
            of(right);
        }
        Node::Path(start, predicates, steps) => {
            start.iter().for_each(|start| of(start));
            predicates.iter().for_each(&mut of);
            steps.iter().flat_map(|Step { predicates, .. }| predicates).for_each(of);
        }
        Node::Number(_) | Node::Literal(_) => {}
    }
}
