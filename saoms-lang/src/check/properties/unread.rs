//! Expressions in values of components without a count, where nobody reads them.

use super::Giver;
use crate::check::report::Report;
use crate::check::values::raw::{Piece, Raw};
use crate::diagnostic::{Code, Diagnostic, codes, quoted};
use crate::expression::{INDEX, names};
use crate::source::{Location, Text};

/// Reports expressions in a value that is taken as it is written, where they name what expressions can name. Whether
/// there are any.
pub(crate) fn check(found: &Raw<'_>, giver: &Giver<'_, '_>, report: &mut Report<'_>) -> bool {
    let member = giver.member;
    if member.instance.is_some() || member.is_partial {
        return false;
    }
    let is_known = |name: &String| {
        name == INDEX || member.composite.properties.iter().any(|property| property.name.as_str() == name)
    };
    let texts = found.0.iter().filter_map(|piece| match piece {
        Piece::Text(text) => Some(&**text),
        Piece::Elements(..) | Piece::Whole(..) => None,
    });
    let unread: Vec<&Text> = texts.filter(|text| names(text).iter().any(is_known)).collect();
    for text in &unread {
        report.push(diagnostic(&codes::EXPRESSION_UNREAD, text.trim(), text.location));
    }
    !unread.is_empty()
}

/// The fault of a value with an expression that stands for itself.
pub(crate) fn diagnostic(code: &'static Code, text: &str, at: Location) -> Diagnostic {
    let message = format!("`${{...}}` in {} is not evaluated: the component has no `saoms:count`", quoted(text));
    let one = Diagnostic::new(code, at, message);
    let inside = text.strip_prefix("${").and_then(|rest| rest.strip_suffix('}')).map(str::trim);
    match inside.filter(|name| *name != INDEX && crate::expression::is_name(name)) {
        Some(name) => one.help(format!("write `source=\"${name}\"` for the value of the property {}", quoted(name))),
        None => one.help("give the component a `saoms:count`, or write the value itself"),
    }
}
