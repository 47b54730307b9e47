//! From tokens to an expression (XPath 1.0, 2 and 3).

use std::ops::Range;

use super::functions::{self, Function};
use super::token::{Placed, Token, tokens};
use crate::check::path::Fault;
use crate::diagnostic::quoted;

/// Expressions inside each other.
const MOST_DEEP: usize = 60;
/// Operators in one expression: each stands around those before it.
const MOST_OPERATORS: usize = 1_000;

/// An expression with its bytes.
#[derive(Debug)]
pub(super) struct Expression {
    pub(super) node: Node,
    pub(super) span: Range<usize>,
}

#[derive(Debug)]
pub(super) enum Node {
    Number(f64),
    Literal(String),
    Variable(String),
    Call(&'static Function, Vec<Expression>),
    Negation(Box<Expression>),
    Binary(&'static str, Box<Expression>, Box<Expression>),
    /// What a path starts from; `None` for the node at hand. Then those of its nodes that the predicates take, and the steps from these.
    Path(Option<Box<Expression>>, Vec<Expression>, Vec<Step>),
}

/// A step of a path.
#[derive(Debug)]
pub(super) struct Step {
    pub(super) axis: Axis,
    pub(super) test: Test,
    pub(super) predicates: Vec<Expression>,
    pub(super) span: Range<usize>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Axis {
    Child,
    Attribute,
    Own,
    Parent,
    Ancestor,
    AncestorOrSelf,
    Descendant,
    DescendantOrSelf,
    FollowingSibling,
    PrecedingSibling,
}

const AXES: [(&str, Axis); 10] = [
    ("child", Axis::Child),
    ("attribute", Axis::Attribute),
    ("self", Axis::Own),
    ("parent", Axis::Parent),
    ("ancestor", Axis::Ancestor),
    ("ancestor-or-self", Axis::AncestorOrSelf),
    ("descendant", Axis::Descendant),
    ("descendant-or-self", Axis::DescendantOrSelf),
    ("following-sibling", Axis::FollowingSibling),
    ("preceding-sibling", Axis::PrecedingSibling),
];

/// What a step asks of nodes.
#[derive(Debug, PartialEq)]
pub(super) enum Test {
    /// Elements, or attributes, of any name.
    Any,
    /// Those of this name without its prefix.
    Name(String),
    /// `text()`
    Text,
    /// `node()`
    All,
}

/// The operators, those that bind least first.
const LEVELS: [&[&str]; 7] =
    [&["or"], &["and"], &["=", "!="], &["<", "<=", ">", ">="], &["+", "-"], &["*", "div", "mod"], &["|"]];
/// The level behind which a minus stands.
const UNARY: usize = 6;

/// Reads an expression.
pub(super) fn parse(text: &str) -> Result<Expression, Fault> {
    let mut parser = Parser { tokens: tokens(text)?, at: 0, operators: 0, length: text.len(), depth: 0 };
    let expression = parser.level(0)?;
    match parser.tokens.get(parser.at) {
        None => Ok(expression),
        Some((_, span)) => {
            let found = quoted(&text[span.clone()]);
            Err(Fault::unknown(span.clone(), format!("{found} cannot stand here")))
        }
    }
}

struct Parser {
    tokens: Vec<Placed>,
    at: usize,
    operators: usize,
    length: usize,
    depth: usize,
}

impl Parser {
    fn peek(&self) -> Option<&Token> {
        self.tokens.get(self.at).map(|(token, _)| token)
    }

    /// The bytes of the next token.
    fn here(&self) -> Range<usize> {
        self.tokens.get(self.at).map_or(self.length..self.length, |(_, span)| span.clone())
    }

    /// The bytes from a place up to the last token.
    fn since(&self, start: usize) -> Range<usize> {
        let end = self.at.checked_sub(1).map_or(start, |last| self.tokens[last].1.end);
        start..end.max(start)
    }

    fn take(&mut self, wanted: &'static str) -> bool {
        let is_there = matches!(self.peek(), Some(Token::Sign(sign)) if *sign == wanted);
        self.at += usize::from(is_there);
        is_there
    }

    /// Goes past a sign that has to be next.
    fn require(&mut self, wanted: &'static str) -> Result<(), Fault> {
        match self.take(wanted) {
            true => Ok(()),
            false => Err(Fault::unknown(self.here(), format!("{} is expected here", quoted(wanted)))),
        }
    }

    fn operator(&mut self, known: &[&'static str]) -> Option<&'static str> {
        let Some(Token::Operator(found)) = self.peek() else { return None };
        let found = known.iter().copied().find(|known| known == found)?;
        self.at += 1;
        Some(found)
    }

    fn level(&mut self, level: usize) -> Result<Expression, Fault> {
        let Some(operators) = LEVELS.get(level) else { return self.path() };
        let start = self.here().start;
        if level == UNARY && self.operator(&["-"]).is_some() {
            let inner = self.deeper(|parser| parser.level(level))?;
            return Ok(Expression { node: Node::Negation(Box::new(inner)), span: self.since(start) });
        }
        let mut left = self.level(level + 1)?;
        while let Some(operator) = self.operator(operators) {
            self.operators += 1;
            if self.operators > MOST_OPERATORS {
                let message = format!("there are more than {MOST_OPERATORS} operators");
                return Err(Fault::new(self.here(), message));
            }
            let right = self.level(level + 1)?;
            let node = Node::Binary(operator, Box::new(left), Box::new(right));
            left = Expression { node, span: self.since(start) };
        }
        Ok(left)
    }

    fn deeper<T>(&mut self, read: impl FnOnce(&mut Self) -> Result<T, Fault>) -> Result<T, Fault> {
        self.depth += 1;
        if self.depth > MOST_DEEP {
            return Err(Fault::new(
                self.here(),
                format!("expressions are inside each other more than {MOST_DEEP} deep"),
            ));
        }
        let read = read(self);
        self.depth -= 1;
        read
    }

    fn path(&mut self) -> Result<Expression, Fault> {
        let start = self.here().start;
        let first = self.primary()?;
        let is_relative = first.is_none();
        let (mut predicates, mut steps) = (Vec::new(), Vec::new());
        if is_relative {
            if matches!(self.peek(), Some(Token::Sign("/" | "//"))) {
                let message = "a path starts at a property: `$name/...`";
                return Err(Fault::new(self.here(), message));
            }
            steps.push(self.step()?);
        } else {
            predicates = self.predicates()?;
        }
        loop {
            if self.take("//") {
                let span = self.since(self.here().start.saturating_sub(2));
                steps.push(Step {
                    axis: Axis::DescendantOrSelf,
                    test: Test::All,
                    predicates: Vec::new(),
                    span,
                });
            } else if !self.take("/") {
                break;
            }
            steps.push(self.step()?);
        }
        match first {
            Some(first) if predicates.is_empty() && steps.is_empty() => Ok(first),
            first => {
                let node = Node::Path(first.map(Box::new), predicates, steps);
                Ok(Expression { node, span: self.since(start) })
            }
        }
    }

    /// A variable, a text, a number, a call or what stands in parentheses; `None` for the step of a path.
    fn primary(&mut self) -> Result<Option<Expression>, Fault> {
        let span = self.here();
        let node = match self.peek() {
            Some(Token::Number(number)) => Node::Number(*number),
            Some(Token::Literal(text)) => Node::Literal(text.clone()),
            Some(Token::Variable(name)) => Node::Variable(name.clone()),
            Some(Token::Sign("(")) => {
                self.at += 1;
                let inner = self.deeper(|parser| parser.level(0))?;
                self.require(")")?;
                return Ok(Some(inner));
            }
            Some(Token::Name(name)) if self.is_call() && !matches!(&**name, "text" | "node" | "comment") => {
                let name = name.clone();
                return self.call(&name).map(Some);
            }
            _ => return Ok(None),
        };
        self.at += 1;
        Ok(Some(Expression { node, span }))
    }

    fn is_call(&self) -> bool {
        matches!(self.tokens.get(self.at + 1), Some((Token::Sign("("), _)))
    }

    fn call(&mut self, name: &str) -> Result<Expression, Fault> {
        let span = self.here();
        let Some(function) = functions::ALL.iter().find(|known| known.name == name) else {
            let known = functions::ALL.iter().map(|known| known.name);
            let message = format!("there is no function {} in XPath 1.0", quoted(name));
            return Err(Fault::unknown(span, message).near(name, known));
        };
        self.at += 2;
        let mut arguments = Vec::new();
        if !self.take(")") {
            loop {
                arguments.push(self.deeper(|parser| parser.level(0))?);
                if !self.take(",") {
                    break;
                }
            }
            self.require(")")?;
        }
        if !function.takes(arguments.len()) {
            let message =
                format!("{} takes {}, and here are {}", quoted(name), function.arguments(), arguments.len());
            return Err(Fault::new(self.since(span.start), message));
        }
        Ok(Expression { node: Node::Call(function, arguments), span: self.since(span.start) })
    }

    fn predicates(&mut self) -> Result<Vec<Expression>, Fault> {
        let mut all = Vec::new();
        while self.take("[") {
            all.push(self.deeper(|parser| parser.level(0))?);
            self.require("]")?;
        }
        Ok(all)
    }

    fn step(&mut self) -> Result<Step, Fault> {
        let start = self.here();
        for (sign, axis) in [(".", Axis::Own), ("..", Axis::Parent)] {
            if self.take(sign) {
                return Ok(Step { axis, test: Test::All, predicates: Vec::new(), span: start });
            }
        }
        let mut axis = Axis::Child;
        if self.take("@") {
            axis = Axis::Attribute;
        } else if let (Some(Token::Name(name)), Some((Token::Sign("::"), _))) =
            (self.peek(), self.tokens.get(self.at + 1))
        {
            let Some((_, known)) = AXES.iter().find(|(known, _)| known == name) else {
                return Err(Fault::unknown(start, format!("there is no axis {}", quoted(name))));
            };
            axis = *known;
            self.at += 2;
        }
        let test = self.test()?;
        let predicates = self.predicates()?;
        Ok(Step { axis, test, predicates, span: self.since(start.start) })
    }

    fn test(&mut self) -> Result<Test, Fault> {
        if self.take("*") {
            return Ok(Test::Any);
        }
        let here = self.here();
        let Some(Token::Name(name)) = self.peek() else {
            let message = match self.at.checked_sub(1).map(|last| &self.tokens[last].0) {
                Some(Token::Sign("/" | "//")) => "a step is missing: `name`, `*`, `@attribute`, `text()`",
                _ => "a value is missing: `$name`, a path, a text in quotes or a number",
            };
            return Err(Fault::unknown(here, message.to_owned()));
        };
        let name = name.clone();
        if self.is_call() {
            let test = match &*name {
                "text" => Test::Text,
                "node" => Test::All,
                _ => return Err(Fault::unknown(here, format!("{} cannot stand in a path", quoted(&name)))),
            };
            self.at += 2;
            self.require(")")?;
            return Ok(test);
        }
        self.at += 1;
        let local = name.rsplit(':').next().unwrap_or(&name);
        Ok(if local == "*" { Test::Any } else { Test::Name(local.to_owned()) })
    }
}
