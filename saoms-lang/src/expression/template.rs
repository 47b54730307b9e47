//! Texts with expressions in them: `Robot${index:03}`.

use std::ops::Range;

use super::evaluate;
use super::parse::parse_from;
use super::{Expression, ExpressionError, ExpressionFault, Lookup};
use crate::limits::NUMBER_DIGITS;

enum Piece<'t> {
    Literal(&'t str),
    /// An expression and the digits that its number has at least.
    Expression(Expression, usize),
}

/// True if a text has an expression, or something that could be meant as one.
pub fn has_expression(text: &str) -> bool {
    // Few texts have a `$`, and looking for one byte takes a tenth of the time.
    memchr::memchr(b'$', text.as_bytes()).is_some() && text.contains("${")
}

/// A text with its expressions replaced by their values. `$${` is written for a plain `${`.
///
/// # Errors
/// Every expression without a value.
pub fn render(text: &str, lookup: &mut Lookup<'_>) -> Result<String, Vec<ExpressionFault>> {
    let mut out = String::with_capacity(text.len());
    let mut faults = Vec::new();
    for piece in pieces(text) {
        match piece {
            Ok(Piece::Literal(literal)) => out.push_str(literal),
            Ok(Piece::Expression(expression, digits)) => match evaluate::text(&expression, digits, lookup) {
                Ok(value) => out.push_str(&value),
                Err(fault) => faults.push(fault),
            },
            Err(fault) => faults.push(fault),
        }
    }
    if faults.is_empty() { Ok(out) } else { Err(faults) }
}

/// A text with `*` for each of its expressions: what a group of replicas is called.
pub fn pattern(text: &str) -> String {
    let piece = |piece| match piece {
        Ok(Piece::Literal(literal)) => literal.to_owned(),
        Ok(Piece::Expression(..)) | Err(_) => "*".to_owned(),
    };
    pieces(text).map(piece).collect()
}

/// The names in the expressions of a text, as far as these can be read.
pub fn names(text: &str) -> Vec<String> {
    let expressions = pieces(text).filter_map(|piece| match piece {
        Ok(Piece::Expression(expression, _)) => Some(expression),
        _ => None,
    });
    expressions.flat_map(|one| one.names().into_iter().map(|(name, _)| name.to_owned()).collect::<Vec<_>>()).collect()
}

/// The bytes inside each `${` and `}` of a text. One that is not closed goes up to the end.
pub fn inside(text: &str) -> Vec<Range<usize>> {
    let mut all = Vec::new();
    let mut at = 0;
    while let Some(found) = text[at..].find("${") {
        let start = at + found + 2;
        if text[at..at + found].ends_with('$') {
            at = start;
            continue;
        }
        let end = end_of(&text[start..]).map_or(text.len(), |length| start + length);
        all.push(start..end);
        at = end;
    }
    all
}

fn pieces(text: &str) -> impl Iterator<Item = Result<Piece<'_>, ExpressionFault>> {
    let mut at = 0;
    std::iter::from_fn(move || {
        let rest = text.get(at..).filter(|rest| !rest.is_empty())?;
        if rest.starts_with("$${") {
            at += 3;
            return Some(Ok(Piece::Literal("${")));
        }
        if !rest.starts_with("${") {
            let next = rest.find("${").unwrap_or(rest.len());
            // The `$` of a `$${` belongs to that.
            let is_escaped = next < rest.len() && rest[..next].ends_with('$');
            let end = at + next - usize::from(is_escaped);
            let literal = &text[at..end];
            at = end;
            return Some(Ok(Piece::Literal(literal)));
        }
        let start = at;
        let Some(length) = end_of(&text[start + 2..]) else {
            at = text.len();
            let problem = ExpressionError::new("`${` has no closing `}`");
            return Some(Err(problem.help("write `${...}`, or `$${` for `${` itself").at(start..text.len())));
        };
        let end = start + 2 + length;
        at = end + 1;
        Some(expression(text, start + 2..end))
    })
}

/// The place of the `}` that ends the expression; those in texts do not count.
fn end_of(inside: &str) -> Option<usize> {
    let mut quote = None;
    inside.char_indices().find_map(|(at, character)| {
        match (quote, character) {
            (None, '}') => return Some(at),
            (None, '\'' | '"') => quote = Some(character),
            (Some(open), _) if open == character => quote = None,
            _ => {}
        }
        None
    })
}

fn expression(text: &str, inside: Range<usize>) -> Result<Piece<'_>, ExpressionFault> {
    let upto = &text[..inside.end];
    let (expression, end) = parse_from(upto, inside.start)?;
    if end == inside.end {
        return Ok(Piece::Expression(expression, 0));
    }
    let width = &upto[end + 1..];
    let digits = width.strip_prefix('0').and_then(|digits| digits.parse().ok());
    match digits {
        Some(digits @ 1..=NUMBER_DIGITS) => Ok(Piece::Expression(expression, digits)),
        _ => {
            let problem = ExpressionError::new("expected the number of digits after `:`, with a `0` before it");
            // As in other languages: `%02d`, `02d`, `2`.
            let plain = width.trim_start_matches('%').trim_end_matches('d').trim_start_matches('0');
            let is_meant = plain.parse().is_ok_and(|digits: usize| (1..=NUMBER_DIGITS).contains(&digits));
            let problem = if is_meant { problem.instead(format!("0{plain}")) } else { problem };
            Err(problem.help("as in `${index:03}`, which turns 7 into 007").at(end + 1..inside.end.max(end + 1)))
        }
    }
}
