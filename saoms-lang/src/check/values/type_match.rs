//! Types of two properties of which one gives the other its values.

use super::simple_type::SimpleType;
use super::type_name::{is_misspelt, local};
use super::value_type::Typed;
use crate::check::report::Report;
use crate::diagnostic::{Diagnostic, codes, quoted};
use crate::load::vocabulary::XML_SCHEMA;
use crate::source::{Location, Text};

/// The relation of another property to the one at hand.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Match {
    /// Its declaration.
    Declaration,
    /// The source of its value, which is written here.
    Source(Location),
}

/// The type of a property, or the element that it holds.
fn type_or_element<'t>(typed: &Typed<'t>) -> Option<(&'t Text, bool)> {
    let of = typed.property.r#type().map(|of| (of, true));
    of.or_else(|| Some((typed.property.element()?, false))).filter(|(of, _)| !of.is_empty())
}

/// Reports two properties that cannot have one type: neither the same, nor one that restricts the other.
pub(crate) fn check(own: Typed<'_>, other: Typed<'_>, how: Match, report: &mut Report<'_>) {
    let Some((here, is_type)) = type_or_element(&own) else { return };
    // Whether an element is of a type is in the schemas of users.
    let Some((there, _)) = type_or_element(&other).filter(|(_, of_other)| *of_other == is_type) else {
        return;
    };
    let (mine, others) = (own.namespace(here), other.namespace(there));
    let is_of_schema = |namespace: &Option<String>| namespace.as_deref() == Some(XML_SCHEMA);
    let is_same = match (&mine, &others) {
        (one, another) if is_of_schema(one) && is_of_schema(another) => is_comparable(here, there),
        // What types of users are made of is in their schemas.
        (Some(one), Some(another)) if one != another => is_of_schema(&mine) || is_of_schema(&others),
        _ => local(here) == local(there),
    };
    // A slip in the name of one is reported by itself.
    let is_slip = [(here, &mine), (there, &others)]
        .iter()
        .any(|(of, namespace)| is_of_schema(namespace) && is_misspelt(of));
    if is_same || is_slip {
        return;
    }
    let what = if is_type { "type" } else { "element" };
    let (at, whose, help, rule) = match how {
        Match::Declaration => {
            let help = format!("leave `{what}` out: that of the declaration holds");
            (here.location, "where it is declared", help, "ASM50036")
        }
        Match::Source(at) => (at, "where its value comes from", format!("give both one {what}"), "ASM50038"),
    };
    let message = format!(
        "the property {} is of the {what} {}, and of {} {whose}",
        quoted(&own.property.name),
        quoted(here),
        quoted(there)
    );
    let mut one = Diagnostic::new(&codes::VALUE_TYPE, at, message).rule(rule);
    if at != here.location {
        one = one.label(here.location, format!("its {what}"));
    }
    report.push(one.label(there.location, whose).help(help));
}

/// True if a value can be of both types, as far as these are known.
fn is_comparable(here: &str, there: &str) -> bool {
    let [Some(here), Some(there)] = [here, there].map(|of| SimpleType::find(local(of))) else { return true };
    here.derives_from(there) || there.derives_from(here)
}
