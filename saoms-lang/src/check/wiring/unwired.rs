//! References that need a target and have none.

use super::Wires;
use super::dangling_names;
use super::promotion::ReferenceId;
use crate::check::report::Report;
use crate::check::rules::multiplicity::of_class;
use crate::diagnostic::{Diagnostic, Severity, codes, quoted};
use crate::registry::ReferenceDeclaration;

impl Wires<'_, '_> {
    /// Reports a required reference without a target: an error in SCA 1.1. In 1.0 files it is common, as in those of
    /// the manual. True if it is an error, or a fault that is reported keeps its target from being known.
    ///
    /// If composites promote it, the outermost component lacks the target.
    pub(super) fn unwired(
        &self,
        place: ReferenceId<'_>,
        declared: &ReferenceDeclaration,
        report: &mut Report<'_>,
    ) -> bool {
        let fleet = self.fleet;
        let mut place = place;
        let mut is_autowired = false;
        let mut is_promoted = false;
        let mut is_required = of_class(declared).is_required();
        loop {
            if self.promoted.outermost.contains_key(&place) {
                return fleet.is_misread;
            }
            is_required |= fleet.given_multiplicity(place).is_some_and(|given| given.value.is_required());
            let reference = fleet.members[place.0].component.reference(place.1);
            let is_wired_elsewhere = reference.is_some_and(|reference| {
                reference.wired_by_impl().is_some_and(|wired| wired.value)
                    || reference.bindings().iter().any(|binding| !(binding.is_sca && binding.kind == "sca"))
            });
            if is_wired_elsewhere {
                return fleet.is_misread;
            }
            is_autowired |= self.is_autowired(place, reference);
            match self.promoted.to.get(&place).and_then(|outer| outer.first()) {
                Some(outer) => (place, is_promoted) = (*outer, true),
                None => break,
            }
        }
        let (member, name) = place;
        let reference = fleet.members[member].component.reference(name);
        // A name that stands twice, a target that stands where none can, and names that lead nowhere are reported.
        let is_text = reference.is_some_and(|reference| {
            let element = reference.origin.element(&fleet.members[member].composite.document);
            reference.targets.is_empty() && element.has_text()
        });
        let dangling = [&self.dangling, &self.promoted.dangling];
        if is_text
            || fleet.lacks_include(fleet.members[member].scope)
            || fleet.members[member].is_repeated
            || dangling.iter().any(|one| one.means(place, fleet))
            || dangling_names::is_misspelt(place, fleet)
        {
            return true;
        }
        // A wire or a promotion of a component that does not exist may be meant for this one.
        let is_unknown =
            fleet.is_misread || dangling.iter().any(|one| one.names_unknown_component(fleet.members[member].scope));
        if !is_required {
            return is_unknown;
        }
        let (interface, component) = (&declared.interface.name, &fleet.members[member].component.name);
        let place = reference.map(|reference| reference.name.location);
        let message = format!("reference {} of component {} leads to no service", quoted(name), quoted(component));
        let is_1_1 = fleet.members[member].composite.version.is_1_1();
        // One that is there and empty is told already.
        if let Some(empty) = reference.and_then(|one| {
            let element = one.origin.element(&fleet.members[member].composite.document);
            element.attribute("target").filter(|_| one.targets.is_empty())
        }) {
            report.withdraw(&codes::ATTRIBUTE_VALUE, empty.location());
        }
        let help = format!(
            "give it a target with the interface {}: `<reference name=\"{name}\" target=\"...\"/>`",
            quoted(interface)
        );
        let one = Diagnostic::new(&codes::UNWIRED, place.unwrap_or(component.location), message)
            .severity(if is_1_1 { Severity::Error } else { Severity::Warning })
            .help(help);
        let one = match (is_autowired, is_promoted) {
            (true, _) => one.rule("ASM60028").help("autowire finds no service with this interface"),
            (false, true) => one.rule("ASM60033"),
            (false, false) => one.rule("ASM50040"),
        };
        report.push(if is_1_1 { one } else { one.help("calls through it fail") });
        is_1_1 || is_unknown
    }
}
