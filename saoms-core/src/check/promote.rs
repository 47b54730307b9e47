//! What composites promote.

use std::collections::{HashMap, HashSet};

use super::classes::ClassIndex;
use super::fleet::Fleet;
use super::report::{Report, list};
use super::target::Uri;
use crate::diagnostic::{Diagnostic, codes, quoted};
use crate::model::Part;
use crate::source::{Location, Text};

/// What is promoted, as (place of the component, place in its class).
#[derive(Default)]
pub(super) struct Promoted {
    pub(super) references: HashSet<(usize, usize)>,
}

/// Whether services or references are meant.
#[derive(Clone, Copy, PartialEq)]
enum Side {
    Service,
    Reference,
}

impl Side {
    const fn name(self) -> &'static str {
        match self {
            Self::Service => "service",
            Self::Reference => "reference",
        }
    }

    const fn rule(self) -> &'static str {
        match self {
            Self::Service => "ASM60004",
            Self::Reference => "ASM60007",
        }
    }
}

/// Checks that what composites promote exists, and that their services and references have names of their own.
pub(super) fn check(fleet: &Fleet<'_>, classes: &[ClassIndex<'_>], report: &mut Report<'_>) -> Promoted {
    let mut promoted = Promoted::default();
    for composite in fleet.composites {
        let services = composite.services.iter().map(|service| &service.name);
        repeated(services, Side::Service, "ASM60003", report);
        let references = composite.references.iter().map(|reference| &reference.name);
        repeated(references, Side::Reference, "ASM60006", report);
        for promote in composite.services.iter().filter_map(|service| service.promote.as_ref()) {
            find(promote, Side::Service, fleet, classes, report);
        }
        for reference in &composite.references {
            let found = reference
                .promote()
                .iter()
                .filter_map(|promote| find(promote, Side::Reference, fleet, classes, report));
            let found: Vec<_> = found.collect();
            if !found.is_empty() {
                let message = format!(
                    "reference {} of the composite is wired to nothing: calls through it fail",
                    quoted(&reference.name)
                );
                let at = if reference.name.is_empty() { reference.tag() } else { reference.name.location };
                let one = Diagnostic::new(&codes::PROMOTED_UNWIRED, at, message);
                report.push(
                    one.help("the composite runs by itself, and nothing around it can wire its references"),
                );
            }
            promoted.references.extend(found);
        }
    }
    promoted
}

fn repeated<'a>(
    names: impl Iterator<Item = &'a Text>,
    side: Side,
    rule: &'static str,
    report: &mut Report<'_>,
) {
    let mut seen: HashMap<&str, Location> = HashMap::new();
    for name in names.filter(|name| !name.is_empty()) {
        if let Some(first) = seen.get(name.as_str()) {
            let message = format!("the composite has two {}s {}", side.name(), quoted(name));
            let one = Diagnostic::new(&codes::COMPOSITE_PART_REPEATED, name.location, message);
            report.push(one.rule(rule).label(*first, "the first").help("give each its own name"));
        } else {
            seen.insert(name, name.location);
        }
    }
}

/// What a URI promotes. Faults are reported.
fn find(
    text: &Text,
    side: Side,
    fleet: &Fleet<'_>,
    classes: &[ClassIndex<'_>],
    report: &mut Report<'_>,
) -> Option<(usize, usize)> {
    let uri = Uri::of(text, 2, report)?;
    let member = uri.member(text, fleet, report)?;
    let class = fleet.class_of(member, classes)?;
    let names: Vec<&str> = match side {
        Side::Service => class.services.iter().map(|service| service.name.as_str()).collect(),
        Side::Reference => class.references.iter().map(|reference| reference.name.as_str()).collect(),
    };
    let (what, component) = (side.name(), quoted(uri.component));
    let (at, message, wanted) = match (&uri.part, &names[..]) {
        (Some((name, at)), _) => match names.iter().position(|known| known == name) {
            Some(place) => return Some((member, place)),
            None => {
                let at = report.part(text, at.clone());
                (at, format!("component {component} has no {what} {}", quoted(name)), *name)
            }
        },
        (None, [_]) => return Some((member, 0)),
        (None, []) => (text.location, format!("component {component} has no {what}s to promote"), ""),
        (None, _) => {
            (text.location, format!("component {component} has several {what}s: say which is promoted"), "")
        }
    };
    let one = match wanted {
        "" if names.is_empty() => Diagnostic::new(&codes::UNKNOWN_PROMOTED, at, message),
        "" => Diagnostic::new(&codes::UNKNOWN_PROMOTED, at, message)
            .help(format!("write `{text}/` and one of {}", list(names))),
        name => {
            let known = (&*format!("its {what}s are"), names.iter().copied());
            report.unknown(&codes::UNKNOWN_PROMOTED, at, message, name, known)
        }
    };
    report.push(one.rule(side.rule()));
    None
}
