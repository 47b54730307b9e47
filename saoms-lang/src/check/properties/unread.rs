//! Expressions in values of components without a count, and names of properties in texts, where nobody reads them.

use super::Giver;
use crate::check::report::Report;
use crate::check::values::raw::{Piece, Raw};
use crate::diagnostic::{Code, Diagnostic, codes, quoted};
use crate::expression::{INDEX, is_name, names};
use crate::source::{Location, Text};

/// Reports expressions in a value that is taken as it is written, where they name what expressions can name, and texts
/// that are the source of a property. Whether there are any.
pub(crate) fn check(found: &Raw<'_>, giver: &Giver<'_, '_>, report: &mut Report<'_>) -> bool {
    let member = giver.member;
    if member.is_partial {
        return false;
    }
    let is_property = |name: &str| member.composite.properties.iter().any(|property| property.name.as_str() == name);
    let is_known = |name: &String| name == INDEX || is_property(name);
    let is_replica = member.instance.is_some();
    let is_unread = |text: &Text| match source(text) {
        // What an expression made of it is meant as it is.
        Some(name) => is_property(name) && (!is_replica || report.written(text.location).trim() == text.trim()),
        None => !is_replica && names(text).iter().any(is_known),
    };
    let texts = found.0.iter().filter_map(|piece| match piece {
        Piece::Text(text) => Some(&**text),
        Piece::Elements(..) | Piece::Whole(..) => None,
    });
    let unread: Vec<&Text> = texts.filter(|text| is_unread(text)).collect();
    for text in &unread {
        report.push(diagnostic(&codes::EXPRESSION_UNREAD, text.trim(), text.location));
    }
    !unread.is_empty()
}

/// The name of the property whose value a text takes that is the source of a property.
pub(crate) fn source(text: &str) -> Option<&str> {
    text.trim().strip_prefix('$').filter(|name| is_name(name))
}

/// The fault of a value with an expression, or of a source, that stands for itself.
pub(crate) fn diagnostic(code: &'static Code, text: &str, at: Location) -> Diagnostic {
    if let Some(name) = source(text) {
        let text = quoted(text.trim());
        let message = format!("{text} is a text here, not the value of the property {}", quoted(name));
        return Diagnostic::new(code, at, message).help(format!("write `source=\"${name}\"` to take that value"));
    }
    let message = format!("`${{...}}` in {} is not evaluated: the component has no `saoms:count`", quoted(text));
    let one = Diagnostic::new(code, at, message);
    let inside = text.strip_prefix("${").and_then(|rest| rest.strip_suffix('}')).map(str::trim);
    match inside.filter(|name| *name != INDEX && is_name(name)) {
        Some(name) => one.help(format!("write `source=\"${name}\"` for the value of the property {}", quoted(name))),
        None => one.help("give the component a `saoms:count`, or write the value itself"),
    }
}
