//! The fault of a text that a property does not take, and what it probably means.

use saoms_api::host::declaration::{PropertyKind, parse_scalar};
use saoms_api::host::meant_duration;

use super::conversion::Target;
use crate::check::report::replacing;
use crate::check::unfolding::replica_plan::as_index;
use crate::check::values::replica::COUNTERS;
use crate::diagnostic::{Code, Diagnostic, codes, meant_boolean, nearest, quoted};
use crate::expression::{INDEX, has_expression, is_name, names, parse};
use crate::registry::PropertyDeclaration;
use crate::source::Text;
use crate::syntax::escaped;

/// A text that is not what the declaration asks for, as its rule says it.
pub(crate) fn diagnostic(text: &Text, target: Target<'_>, message: &str, has_index: bool) -> Diagnostic {
    let declaration = target.declaration;
    // The rule repeats all of the text, however long.
    let rest = message.strip_prefix(&format!("`{}`", text.trim()));
    let said = rest.map_or_else(|| message.to_owned(), |rest| format!("{}{rest}", quoted(text.trim())));
    let code = code(text, declaration, rest.unwrap_or_default());
    let one = Diagnostic::new(code, text.location, format!("property {}: {said}", target.quoted()));
    if let Some(meant) = meant(text.trim(), declaration) {
        return one.suggest(replacing(text, &meant), text.location, escaped(&meant));
    }
    // Minutes or milliseconds.
    let number = text.trim().strip_suffix('m').filter(|_| declaration.kind == PropertyKind::Duration);
    let units = number.into_iter().flat_map(|number| ["min", "ms"].map(|unit| format!("{number}{unit}")));
    let one = units
        .filter(|meant| declaration.check(meant.as_str()).is_ok())
        .fold(one, |one, meant| one.suggest(replacing(text, &meant), text.location, meant));
    let is_counter = text.trim() == INDEX || has_index && COUNTERS.contains(&text.trim());
    let by_index = match has_expression(text) {
        _ if is_counter => Some(format!("${{{INDEX}}}")),
        true => None,
        false => as_index(text.trim()).or_else(|| has_index.then(|| as_expression(text.trim()))?),
    };
    if let Some(meant) = by_index.filter(|meant| meant != text.trim()) {
        return match has_index {
            true => one.suggest(replacing(text, &meant), text.location, escaped(&meant)),
            false => one.help(format!("{} is only for replicas: give the component a `saoms:count`", quoted(&meant))),
        };
    }
    let inside = |before, behind| text.trim().strip_prefix(before)?.strip_suffix(behind);
    let (one, name) = match has_expression(text) {
        true => (
            one.help(match has_index {
                true => "`${...}` is evaluated only in the element of the component: tables and other files have no expressions",
                false => "`${...}` is evaluated only in components with a `saoms:count`",
            }),
            inside("${", "}").filter(|name| name.trim() != INDEX),
        ),
        false => (one, inside("$(arg ", ")").or_else(|| inside("$", ""))),
    };
    match name.map(str::trim).filter(|name| is_name(name)) {
        Some(name) => {
            let property = quoted(name);
            one.help(format!("write `source=\"${name}\"` for the value of the property {property} of the composite"))
        }
        None => one,
    }
}

/// A text that is an expression with the index, as it is written in a text: in other brackets, or in none.
fn as_expression(text: &str) -> Option<String> {
    let inside = text.strip_prefix('{').and_then(|rest| rest.strip_suffix('}'));
    let plain = text.strip_prefix('$').unwrap_or(inside.unwrap_or(text));
    let written = format!("${{{plain}}}");
    (parse(plain).is_ok() && names(&written).iter().any(|name| name == INDEX)).then_some(written)
}

fn code(text: &Text, declaration: &PropertyDeclaration, said: &str) -> &'static Code {
    if text.trim().is_empty() {
        return &codes::VALUE_EMPTY;
    }
    let beyond = [" is out of range", " is negative"].into_iter().any(|what| said.starts_with(what));
    match parse_scalar(declaration.kind, &text.value) {
        _ if beyond => &codes::VALUE_RANGE,
        Some(_) => &codes::VALUE_NOT_ALLOWED,
        None => &codes::VALUE_TYPE,
    }
}

/// The probable meaning of a wrong text: of one spelt alike, of yes or no, of a decimal comma, of a unit.
fn meant(text: &str, declaration: &PropertyDeclaration) -> Option<String> {
    if text.is_empty() {
        return None;
    }
    let allowed = declaration.allowed.iter().map(String::as_str);
    if let Some(near) = nearest(text, allowed) {
        return Some(near.to_owned());
    }
    let quotes = ['\'', '"', '`'];
    let inside = quotes.iter().find_map(|quote| text.strip_prefix(*quote)?.strip_suffix(*quote)).map(str::trim);
    if let Some(inside) = inside.filter(|inside| declaration.check(*inside).is_ok()) {
        return Some(inside.to_owned());
    }
    let lower = text.to_ascii_lowercase();
    let said = match (declaration.kind, lower.as_str()) {
        (PropertyKind::Boolean, _) => meant_boolean(text).unwrap_or_default().to_owned(),
        (PropertyKind::Integer | PropertyKind::Float, _) => {
            let unit = declaration.unit.as_deref().unwrap_or_default();
            let text = text.strip_suffix(unit).unwrap_or(text).trim();
            let is_whole = declaration.kind == PropertyKind::Integer;
            let text = text.strip_suffix(".0").filter(|_| is_whole).unwrap_or(text);
            without_unit(text).unwrap_or(text).replace(',', ".")
        }
        (PropertyKind::Duration, _) => meant_duration(text)?,
        _ => lower,
    };
    (said != text && declaration.check(said.as_str()).is_ok()).then_some(said)
}

/// A number without the unit that people write behind numbers of its kind.
fn without_unit(text: &str) -> Option<&str> {
    const UNITS: [&str; 9] = ["%", "percent", "m", "cm", "mm", "ms", "s", "block", "blocks"];
    let number = text.trim_end_matches(|c: char| !c.is_ascii_digit());
    let unit = text[number.len()..].trim();
    UNITS.iter().any(|known| known.eq_ignore_ascii_case(unit)).then_some(number)
}
