//! Rule: a wire stays within a node.

use super::place;
use crate::check::fleet::Fleet;
use crate::check::report::Report;
use crate::check::wiring::Wiring;
use crate::diagnostic::{Diagnostic, codes, quoted};

/// Reports wires between components of different nodes: a call does not leave its program.
pub(super) fn check(fleet: &Fleet<'_>, wiring: &Wiring, report: &mut Report<'_>) {
    for (caller, references) in wiring.iter().enumerate() {
        let (member, Some(class)) = (&fleet.members[caller], fleet.class_of(caller)) else { continue };
        report.about(member);
        for (declared, targets) in class.references.iter().zip(references) {
            let providers = targets.iter().flatten().map(|provider| &fleet.members[provider.member]);
            let mut apart = providers
                .filter(|other| other.node != member.node && !other.node.is_empty() && !member.node.is_empty());
            let Some(other) = apart.next() else { continue };
            let written = member.component.reference(&declared.name);
            let at = written.map_or(member.component.name.location, |one| one.name.location);
            let message = format!(
                "{} is in node {}, and its reference {} leads to {} in node {}: calls stay within a program",
                quoted(member.path()),
                quoted(&member.node),
                quoted(&declared.name),
                quoted(other.path()),
                quoted(&other.node)
            );
            let one = Diagnostic::new(&codes::WIRE_BETWEEN_NODES, at, message);
            let one = one.label(place(fleet, other), "the node of its target");
            report.push(
                one.help("put both into one node: components of different nodes exchange messages of topics alone"),
            );
        }
    }
    report.about_all();
}
