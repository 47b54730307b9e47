//! From the text of an XPath to tokens.

use std::ops::Range;

use crate::check::path::Fault;
use crate::diagnostic::quoted;

/// A token.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Token {
    Number(f64),
    Literal(String),
    /// `$name`
    Variable(String),
    /// A name, with its prefix.
    Name(String),
    /// An operator that is written as a name, or with signs.
    Operator(&'static str),
    /// Any other sign; `*` where it stands for a name.
    Sign(&'static str),
}

/// A token with its bytes.
pub(super) type Placed = (Token, Range<usize>);

/// The signs, the longer ones first.
const SIGNS: [&str; 12] = ["::", "..", "//", "(", ")", "[", "]", "@", ",", ".", "/", "*"];
const OPERATORS: [&str; 9] = ["!=", "<=", ">=", "=", "<", ">", "|", "+", "-"];
const WORDS: [&str; 4] = ["and", "or", "div", "mod"];

fn is_first(letter: char) -> bool {
    letter.is_alphabetic() || letter == '_'
}

fn is_inner(letter: char) -> bool {
    letter.is_alphanumeric() || matches!(letter, '_' | '-' | '.' | '\u{b7}')
}

/// The length of the name without a prefix that a text starts with.
fn name(text: &str) -> usize {
    if !text.starts_with(is_first) {
        return 0;
    }
    text.find(|letter| !is_inner(letter)).unwrap_or(text.len())
}

/// The length of a name, with its prefix; `*` can stand behind that.
fn qualified(text: &str) -> usize {
    let first = name(text);
    let Some(rest) = text[first..].strip_prefix(':').filter(|rest| first > 0 && !rest.starts_with(':'))
    else {
        return first;
    };
    match name(rest) {
        0 if rest.starts_with('*') => first + 2,
        0 => first,
        second => first + 1 + second,
    }
}

/// Whether what follows this token is an operator, where it could be a name as well (XPath 1.0, 3.7).
fn ends_operand(last: Option<&Placed>) -> bool {
    match last.map(|(token, _)| token) {
        None | Some(Token::Operator(_)) => false,
        Some(Token::Sign(sign)) => matches!(*sign, ")" | "]" | "." | ".." | "*"),
        Some(_) => true,
    }
}

/// The tokens of a text.
pub(super) fn tokens(text: &str) -> Result<Vec<Placed>, Fault> {
    let mut all: Vec<Placed> = Vec::new();
    let mut at = 0;
    while let Some(first) = text[at..].chars().next() {
        let rest = &text[at..];
        if first.is_whitespace() {
            at += first.len_utf8();
            continue;
        }
        if let Some(fault) = in_braces(rest, at) {
            return Err(fault);
        }
        let (token, length) = token(rest, first, ends_operand(all.last()))
            .map_err(|message| Fault::unknown(at..at + first.len_utf8(), message))?;
        all.push((token, at..at + length));
        at += length;
    }
    Ok(all)
}

/// A property whose name stands in braces, as where texts are made of others.
fn in_braces(rest: &str, at: usize) -> Option<Fault> {
    let (inside, _) = rest.strip_prefix("${")?.split_once('}')?;
    let name = inside.trim();
    let is_name = name.starts_with(is_first) && qualified(name) == name.len();
    let written = &rest[..inside.len() + 3];
    let fault = Fault::unknown(at..at + written.len(), "names of properties stand without braces here");
    Some(Fault { instead: Some((written.to_owned(), format!("${name}"))), ..fault }).filter(|_| is_name)
}

fn token(rest: &str, first: char, is_behind_operand: bool) -> Result<(Token, usize), String> {
    if matches!(first, '\'' | '"') {
        let end = rest[1..].find(first).ok_or_else(|| format!("the text after {first} is not closed"))?;
        return Ok((Token::Literal(rest[1..=end].to_owned()), end + 2));
    }
    if first.is_ascii_digit() || first == '.' && rest[1..].starts_with(|next: char| next.is_ascii_digit()) {
        let is_part = |letter: char| letter.is_ascii_digit() || letter == '.';
        let digits = &rest[..rest.find(|letter| !is_part(letter)).unwrap_or(rest.len())];
        let number = digits.parse().map_err(|_| format!("{} is no number", quoted(digits)))?;
        return Ok((Token::Number(number), digits.len()));
    }
    if first == '$' {
        let length = qualified(&rest[1..]);
        return match length {
            0 => Err("behind `$` stands the name of a property".to_owned()),
            _ => Ok((Token::Variable(rest[1..=length].to_owned()), length + 1)),
        };
    }
    if is_first(first) {
        let plain = &rest[..name(rest)];
        if let Some(word) = WORDS.into_iter().find(|word| is_behind_operand && *word == plain) {
            return Ok((Token::Operator(word), word.len()));
        }
        let length = qualified(rest);
        return Ok((Token::Name(rest[..length].to_owned()), length));
    }
    if first == '*' && is_behind_operand {
        return Ok((Token::Operator("*"), 1));
    }
    if let Some(sign) = OPERATORS.into_iter().find(|sign| rest.starts_with(sign)) {
        return Ok((Token::Operator(sign), sign.len()));
    }
    match SIGNS.into_iter().find(|sign| rest.starts_with(sign)) {
        Some(sign) => Ok((Token::Sign(sign), sign.len())),
        None => Err(format!("{} means nothing here", quoted(first.encode_utf8(&mut [0; 4])))),
    }
}
