//! The tokens of an expression's text.

use std::ops::Range;

use super::{ExpressionError, ExpressionFault};
use crate::diagnostic::quoted;
use crate::limits::EXPRESSION_TOKENS;

/// A token.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Token {
    Integer(i64),
    Text(String),
    /// A name, or one of the words `and`, `or`, `not`, `true` and `false`.
    Word(String),
    Sign(&'static str),
}

/// A token with its bytes.
pub(super) type Placed = (Token, Range<usize>);

/// The signs, the longer ones first.
const SIGNS: [&str; 13] = ["==", "!=", "<=", ">=", "<", ">", "+", "-", "*", "/", "%", "(", ")"];

/// Signs that others use: what they are here; the longer ones first.
const OTHERS: [(&str, &str); 6] = [("&&", "and"), ("||", "or"), ("=<", "<="), ("=>", ">="), ("=", "=="), ("!", "not ")];

/// The words that are no names.
const RESERVED: [&str; 5] = ["and", "or", "not", "true", "false"];

fn is_first(c: char) -> bool {
    c.is_alphabetic() || c == '_'
}

fn is_part(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

/// True if a name can stand in an expression.
pub fn is_name(name: &str) -> bool {
    name.starts_with(is_first) && name.chars().all(is_part) && !RESERVED.contains(&name)
}

/// The bytes of each name in what is to be an expression, whether it can be read or not.
pub fn words(text: &str) -> Vec<Range<usize>> {
    let mut all = Vec::new();
    let mut at = 0;
    while let Some(first) = text[at..].chars().next() {
        let rest = &text[at..];
        let length = match first {
            ':' => break,
            '\'' | '"' => rest[1..].find(first).map_or(rest.len(), |length| length + 2),
            _ if is_first(first) => rest.find(|c| !is_part(c)).unwrap_or(rest.len()),
            _ => first.len_utf8(),
        };
        if is_name(&rest[..length]) {
            all.push(at..at + length);
        }
        at += length;
    }
    all
}

/// The tokens of `text[start..]` with their bytes, up to its end or to a `:`; and where that is.
pub(super) fn tokens(text: &str, start: usize) -> Result<(Vec<Placed>, usize), ExpressionFault> {
    let mut all: Vec<Placed> = Vec::new();
    let mut at = start;
    while let Some(first) = text[at..].chars().next() {
        let rest = &text[at..];
        if first.is_whitespace() {
            at += first.len_utf8();
            continue;
        }
        if first == ':' {
            break;
        }
        let (token, length) = if first.is_ascii_digit() {
            number(rest, at)?
        } else if is_first(first) {
            let length = rest.find(|c| !is_part(c)).unwrap_or(rest.len());
            (Token::Word(rest[..length].to_owned()), length)
        } else if first == '\'' || first == '"' {
            let Some(length) = rest[1..].find(first) else {
                return Err(ExpressionError::new("this text has no closing `'`")
                    .help("write a text between two `'`")
                    .at(at..text.len()));
            };
            (Token::Text(rest[1..=length].to_owned()), length + 2)
        } else if let Some(sign) = SIGNS.into_iter().find(|sign| rest.starts_with(sign)) {
            if let ("(", Some((Token::Word(word), at))) = (sign, all.last())
                && is_name(word)
            {
                let problem = ExpressionError::new(format!("there is no function {}", quoted(word)));
                return Err(problem
                    .help("expressions have operators and parentheses, and no functions")
                    .at(at.clone()));
            }
            (Token::Sign(sign), sign.len())
        } else {
            return Err(odd(rest, first, at));
        };
        if all.len() == EXPRESSION_TOKENS {
            let message = format!("an expression with more than {EXPRESSION_TOKENS} operators, names and numbers");
            return Err(ExpressionError::new(message).at(at..at + length));
        }
        all.push((token, at..at + length));
        at += length;
    }
    Ok((all, at))
}

fn number(rest: &str, at: usize) -> Result<(Token, usize), ExpressionFault> {
    let length = rest.find(|c: char| !c.is_ascii_digit()).unwrap_or(rest.len());
    let behind = &rest[length..];
    if let Some(digits) = behind.strip_prefix('.') {
        let all = length + 1 + digits.find(|c: char| !c.is_ascii_digit()).unwrap_or(digits.len());
        let message = format!("{} is not a whole number", quoted(&rest[..all]));
        return Err(ExpressionError::new(message).help("use a whole number").at(at..at + all));
    }
    match rest[..length].parse() {
        Ok(number) => Ok((Token::Integer(number), length)),
        Err(_) => Err(ExpressionError::new(format!("{} is too large", quoted(&rest[..length]))).at(at..at + length)),
    }
}

fn odd(rest: &str, first: char, at: usize) -> ExpressionFault {
    if let Some((written, meant)) = OTHERS.into_iter().find(|(written, _)| rest.starts_with(written)) {
        let problem = ExpressionError::new(format!("there is no {}", quoted(written))).instead(meant);
        return problem.at(at..at + written.len());
    }
    if let Some(inside) = rest.strip_prefix("${").and_then(|rest| rest.split_once('}')).map(|(inside, _)| inside) {
        let problem = ExpressionError::new("write the expression here without `${` and `}`").instead(inside.trim());
        return problem.at(at..at + inside.len() + 3);
    }
    if first == '$' {
        let problem = ExpressionError::new("write the property's name without `$` in an expression").instead("");
        return problem.at(at..at + 1);
    }
    let shown = quoted(first.encode_utf8(&mut [0; 4]));
    ExpressionError::new(format!("unexpected {shown}")).at(at..at + first.len_utf8())
}
