//! The parser from tokens to an expression.

use std::ops::Range;

use smol_str::SmolStr;

use super::token::{Placed, Token, tokens};
use super::{ExpressionError, ExpressionFault, ExpressionValue};
use crate::diagnostic::quoted;
use crate::limits::{EXPRESSION_DEPTH, EXPRESSION_OPERATORS};

/// An expression with its bytes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Expression {
    pub(super) at: Range<usize>,
    pub(super) node: Node,
    /// The text of a divisor, for the fault that it is zero; empty for others.
    pub(super) divisor: SmolStr,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Node {
    Value(ExpressionValue),
    /// With its own bytes: those of the expression hold the parentheses around it, too.
    Name(String, Range<usize>),
    Negative(Box<Expression>),
    Not(Box<Expression>),
    Two(Box<Expression>, &'static str, Box<Expression>),
}

impl Expression {
    fn new(at: Range<usize>, node: Node) -> Self {
        Self { at, node, divisor: SmolStr::default() }
    }

    /// The names in it, each with its bytes.
    pub fn names(&self) -> Vec<(&str, Range<usize>)> {
        let mut all = Vec::new();
        let mut open = vec![self];
        while let Some(one) = open.pop() {
            match &one.node {
                Node::Value(_) => {}
                Node::Name(name, at) => all.push((name.as_str(), at.clone())),
                Node::Negative(inner) | Node::Not(inner) => open.push(inner),
                Node::Two(left, _, right) => open.extend([&**right, &**left]),
            }
        }
        all
    }
}

/// Reads a text that is one expression.
///
/// # Errors
/// It is none.
pub fn parse(text: &str) -> Result<Expression, ExpressionFault> {
    let (expression, end) = parse_from(text, 0)?;
    if end < text.len() {
        return Err(ExpressionError::new("unexpected `:`").at(end..end + 1));
    }
    Ok(expression)
}

/// Reads the expression in `text[start..]` up to its end or to a `:`; and where that is.
pub(super) fn parse_from(text: &str, start: usize) -> Result<(Expression, usize), ExpressionFault> {
    let (tokens, end) = tokens(text, start)?;
    let mut parser = Parser { text, tokens: &tokens, next: 0, end, operators: 0, depth: 0 };
    let whole = parser.level(0)?;
    match tokens.get(parser.next) {
        None => Ok((whole, end)),
        Some((token, at)) => {
            let message = match token {
                Token::Sign(sign) => format!("unexpected {}", quoted(sign)),
                _ => "expected an operator before this".to_owned(),
            };
            let word = text[at.clone()].to_ascii_lowercase();
            let one = ExpressionError::new(message);
            let meant = match word.as_str() {
                "and" | "or" if word != text[at.clone()] => Some(word.as_str()),
                "mod" => Some("%"),
                "div" => Some("/"),
                "eq" => Some("=="),
                "ne" => Some("!="),
                "gt" => Some(">"),
                "ge" => Some(">="),
                "lt" => Some("<"),
                "le" => Some("<="),
                _ => None,
            };
            let one = meant.into_iter().fold(one, ExpressionError::instead);
            // A value with its unit is no number.
            let number = text[..at.start].trim_end_matches(|sign: char| sign.is_ascii_digit() || sign == '.');
            let value = &text[number.len()..at.end];
            let has_unit = number.len() < at.start && meant.is_none() && matches!(token, Token::Word(_));
            let one = if has_unit { one.help(format!("write a text in quotes: `'{value}'`")) } else { one };
            Err(one.at(at.clone()))
        }
    }
}

/// The operators from those that bind least; `not` and the sign stand between them.
const LEVELS: [&[&str]; 5] = [&["or"], &["and"], &["==", "!=", "<", "<=", ">", ">="], &["+", "-"], &["*", "/", "%"]];
const COMPARISON: usize = 2;

struct Parser<'t> {
    text: &'t str,
    tokens: &'t [Placed],
    next: usize,
    end: usize,
    operators: usize,
    depth: usize,
}

impl Parser<'_> {
    /// The next token as an operator or a word.
    fn sign(&self) -> &str {
        match self.tokens.get(self.next) {
            Some((Token::Word(word), _)) => word,
            Some((Token::Sign(sign), _)) => sign,
            _ => "",
        }
    }

    /// Parses operators of this level and those that bind tighter. They are climbed in a loop, so that parentheses cost
    /// the stack no frame for each level:
    /// <https://en.wikipedia.org/wiki/Operator-precedence_parser#Precedence_climbing_method>.
    fn level(&mut self, lowest: usize) -> Result<Expression, ExpressionFault> {
        let mut left = match self.sign() {
            "not" if lowest <= COMPARISON => self.prefix(COMPARISON, Node::Not)?,
            _ => self.operand()?,
        };
        let mut is_comparison = false;
        while let Some((level, operator)) = self.operator(lowest) {
            if is_comparison && level == COMPARISON {
                let at = self.tokens[self.next].1.clone();
                let problem = ExpressionError::new("two comparisons in a row");
                return Err(problem.help("join them with `and`").at(at));
            }
            is_comparison = level == COMPARISON;
            self.next += 1;
            let mut right = self.level(level + 1)?;
            if matches!(operator, "/" | "%") {
                let text = &self.text[right.at.clone()];
                let inside = text.strip_prefix('(').and_then(|text| text.strip_suffix(')'));
                right.divisor = inside.unwrap_or(text).trim().into();
            }
            let at = left.at.start..right.at.end;
            self.operators += 1;
            if self.operators > EXPRESSION_OPERATORS {
                return Err(ExpressionError::new("the expression is too long").at(at));
            }
            left = Expression::new(at, Node::Two(Box::new(left), operator, Box::new(right)));
        }
        Ok(left)
    }

    /// The operator that comes next, with its level, where that is at least `lowest`.
    fn operator(&self, lowest: usize) -> Option<(usize, &'static str)> {
        let sign = self.sign();
        let levels = LEVELS.iter().enumerate().skip(lowest);
        let mut all = levels.flat_map(|(level, operators)| operators.iter().map(move |one| (level, *one)));
        all.find(|(_, one)| *one == sign)
    }

    /// `not` or `-`, and what follows it.
    fn prefix(&mut self, level: usize, make: fn(Box<Expression>) -> Node) -> Result<Expression, ExpressionFault> {
        let start = self.tokens[self.next].1.clone();
        self.next += 1;
        self.deeper(start.clone())?;
        let inner = self.level(level)?;
        self.depth -= 1;
        Ok(Expression::new(start.start..inner.at.end, make(Box::new(inner))))
    }

    fn deeper(&mut self, at: Range<usize>) -> Result<(), ExpressionFault> {
        self.depth += 1;
        match self.depth > EXPRESSION_DEPTH {
            true => Err(ExpressionError::new("parentheses and operators are nested too deeply").at(at)),
            false => Ok(()),
        }
    }

    fn operand(&mut self) -> Result<Expression, ExpressionFault> {
        let Some((token, at)) = self.tokens.get(self.next) else {
            let at = self.tokens.last().map_or(self.end..self.end, |(_, at)| at.clone());
            let message = if self.tokens.is_empty() { "expected an expression" } else { "expected a value after this" };
            return Err(ExpressionError::new(message).at(at));
        };
        let node = match token {
            Token::Integer(number) => Node::Value(ExpressionValue::Integer(*number)),
            Token::Text(text) => Node::Value(ExpressionValue::Text(text.as_str().into())),
            Token::Word(word) => match word.as_str() {
                "true" => Node::Value(ExpressionValue::Boolean(true)),
                "false" => Node::Value(ExpressionValue::Boolean(false)),
                "not" => {
                    let problem = ExpressionError::new("`not` must be before a comparison");
                    return Err(problem.help("write `(not ...)`").at(at.clone()));
                }
                "and" | "or" => {
                    return Err(ExpressionError::new(format!("expected a value before `{word}`")).at(at.clone()));
                }
                name => Node::Name(name.to_owned(), at.clone()),
            },
            Token::Sign("-") => return self.prefix(LEVELS.len(), Node::Negative),
            Token::Sign("(") => {
                let open = at.clone();
                self.next += 1;
                self.deeper(open.clone())?;
                let mut inner = self.level(0)?;
                self.depth -= 1;
                if self.sign() != ")" {
                    return Err(ExpressionError::new("`(` has no closing `)`").at(open));
                }
                inner.at = open.start..self.tokens[self.next].1.end;
                self.next += 1;
                return Ok(inner);
            }
            Token::Sign(sign) => {
                return Err(ExpressionError::new(format!("expected a value before {}", quoted(sign))).at(at.clone()));
            }
        };
        self.next += 1;
        Ok(Expression::new(at.clone(), node))
    }
}
