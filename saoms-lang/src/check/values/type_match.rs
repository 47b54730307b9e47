//! Types of two properties of which one gives the other its values.

use super::value_type::Typed;
use crate::check::report::Report;
use crate::diagnostic::{Diagnostic, codes, quoted};
use crate::source::Location;

/// The relation of another property to the one at hand.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Match {
    /// Its declaration.
    Declaration,
    /// The source of its value, which is written here.
    Source(Location),
}

/// Reports two properties of simple types of XML Schema of which neither holds the values of the other. What other
/// types and elements are made of is in the schemas of users.
pub(crate) fn check(own: Typed<'_>, other: Typed<'_>, how: Match, report: &mut Report<'_>) {
    let (Some((here, mine)), Some((there, others))) = (own.simple_type(), other.simple_type()) else {
        return;
    };
    if mine.is_within(others) || others.is_within(mine) {
        return;
    }
    let (at, whose, help, rule) = match how {
        Match::Declaration => {
            let help = "leave `type` out: that of the declaration holds";
            (here.location, "where it is declared", help, "ASM50036")
        }
        Match::Source(at) => (at, "where its value comes from", "give both one type", "ASM50038"),
    };
    let message = format!(
        "the property {} is of the type {}, and of {} {whose}",
        quoted(&own.property.name),
        quoted(here),
        quoted(there)
    );
    let mut one = Diagnostic::new(&codes::VALUE_TYPE, at, message).rule(rule);
    if at != here.location {
        one = one.label(here.location, "its type");
    }
    report.push(one.label(there.location, whose).help(help));
}
