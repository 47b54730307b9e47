//! References that need a target and have none. Those that a wrong name elsewhere probably means are not reported a
//! second time.

use std::collections::{HashMap, HashSet};

use super::Wires;
use super::promotion::has_address;
use crate::check::contracts::multiplicity::of_class;
use crate::check::contracts::offer::{ReferenceId, parts};
use crate::check::fleet::Fleet;
use crate::check::report::Report;
use crate::diagnostic::{Diagnostic, Severity, codes, nearest, quoted};
use crate::limits::DANGLING_NAMES;
use crate::model::{Multiplicity, ReferenceElement};
use crate::registry::ReferenceDeclaration;
use crate::source::Text;

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
                return fleet.misread.is_some();
            }
            is_required |= fleet.given_multiplicity(place).is_some_and(Multiplicity::is_required);
            let reference = fleet.members[place.0].component.reference(place.1);
            let is_wired_elsewhere = |reference: &ReferenceElement| {
                reference.wired_by_impl.is_some_and(|wired| wired.value) || has_address(&reference.contract().bindings)
            };
            if reference.is_some_and(is_wired_elsewhere) {
                return fleet.misread.is_some();
            }
            is_autowired |= self.is_autowired(place, reference);
            match self.promoted.to.get(&place).and_then(|outer| outer.first()) {
                Some(outer) => (place, is_promoted) = (*outer, true),
                None => break,
            }
        }
        let (member, name) = place;
        let own = &fleet.members[member];
        let reference = own.component.reference(name);
        let empty = reference.filter(|reference| reference.targets.is_empty());
        let empty = empty.map(|reference| reference.origin.element(&own.composite.document));
        // A name that stands twice, a target that stands where none can, and names that lead nowhere are reported.
        let dangling = [&self.dangling, &self.promoted.dangling];
        if empty.is_some_and(|element| element.has_text())
            || fleet.lacks_include(own.scope)
            || own.repeated.is_some()
            || dangling.iter().any(|one| one.means(place, fleet))
            || is_misspelt(place, fleet)
            || is_sought(place, fleet)
        {
            return true;
        }
        // A wire or a promotion of a component that does not exist may be meant for this one.
        let is_unknown = fleet.misread.is_some() || dangling.iter().any(|one| one.lost.contains_key(&own.scope));
        if !is_required {
            if is_autowired && !is_promoted && !is_unknown {
                self.autowired_to_nothing(place, declared, report);
            }
            return is_unknown;
        }
        let (interface, component) = (&declared.interface.name, &own.component.name);
        let message =
            format!("reference {} of component {} is not wired to a service", quoted(name), quoted(component));
        let is_1_1 = own.composite.version.is_1_1();
        // One that is there and empty was reported by the loader.
        if let Some(target) = empty.and_then(|element| element.attribute("target")) {
            report.withdraw(&codes::ATTRIBUTE_VALUE, target.location());
        }
        let help = format!(
            "give it a target with the interface {}: `<reference name=\"{name}\" target=\"...\"/>`",
            quoted(interface)
        );
        let one =
            Diagnostic::new(&codes::UNWIRED, reference.map_or(component.location, |one| one.name.location), message)
                .severity(if is_1_1 { Severity::Error } else { Severity::Warning })
                .help(help);
        let one = match (is_autowired, is_promoted) {
            (true, _) => one.rule("ASM60028").help("autowire finds no service with this interface"),
            (false, true) => one.rule("ASM60033"),
            (false, false) => one.rule("ASM50040"),
        };
        report.push(if is_1_1 { one } else { one.help("without a target, calls through it fail") });
        is_1_1 || is_unknown
    }
}

/// True if the component around gives its composite a reference of this name, which that does not promote, as is
/// reported.
fn is_sought((member, name): ReferenceId<'_>, fleet: &Fleet<'_>) -> bool {
    let Some(owner) = fleet.scopes[fleet.members[member].scope].owner else { return false };
    let promoted = || fleet.reference_names(owner).unwrap_or_default().contains(&name);
    fleet.members[owner].component.reference(name).is_some() && !promoted()
}

/// The sources of wires and what references promote, where they lead nowhere, which is reported.
#[derive(Default)]
pub(crate) struct DanglingNames<'f> {
    /// The names behind components that exist; `None` where any of their references may be meant.
    of_members: HashMap<usize, HashSet<Option<&'f str>>>,
    /// The components that do not exist, by the scopes where they are named.
    lost: HashMap<usize, HashSet<&'f str>>,
    /// The scopes in which one is not written at all.
    unsaid: HashSet<usize>,
}

impl<'f> DanglingNames<'f> {
    /// Adds what stands in a scope; `None` for one that is not written.
    pub(crate) fn add(&mut self, scope: usize, text: Option<&'f Text>, fleet: &Fleet<'_>) {
        let Some(text) = text else {
            self.unsaid.insert(scope);
            return;
        };
        let (component, part) = parts(text);
        if let Some(member) = fleet.find(scope, component) {
            self.of_members.entry(member).or_default().insert(part);
            return;
        }
        let lost = self.lost.entry(scope).or_default();
        if lost.len() < DANGLING_NAMES {
            lost.insert(component);
        }
    }

    /// True if one of them is probably meant to be this reference.
    fn means(&self, (member, name): ReferenceId<'_>, fleet: &Fleet<'_>) -> bool {
        let scope = fleet.members[member].scope;
        let own = fleet.members[member].component.name.as_str();
        let is_like = |lost: &&str| nearest(lost, [own]).is_some() || lost.starts_with(own);
        let is_part = |part: &Option<&str>| part.is_none_or(|part| is_meant(part, (member, name), fleet));
        self.unsaid.contains(&scope)
            || self.of_members.get(&member).is_some_and(|parts| parts.iter().any(is_part))
            || self.lost.get(&scope).is_some_and(|lost| lost.iter().any(is_like))
    }
}

/// True if a component says something about this reference under a name that is wrong.
fn is_misspelt((member, name): ReferenceId<'_>, fleet: &Fleet<'_>) -> bool {
    let given = fleet.members[member].component.references.iter();
    given.into_iter().any(|given| is_meant(&given.name, (member, name), fleet))
}

/// True if a name that no reference of a component has stands for this one: it is like it, or like none.
fn is_meant(written: &str, (member, name): ReferenceId<'_>, fleet: &Fleet<'_>) -> bool {
    let names = fleet.reference_names(member).unwrap_or_default();
    !names.contains(&written) && nearest(written, names).is_none_or(|near| near == name)
}
