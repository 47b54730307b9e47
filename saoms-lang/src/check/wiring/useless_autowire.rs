//! References that may do without a target, and for which autowire finds nothing.

use std::collections::{HashMap, HashSet};

use super::Wires;
use crate::check::contracts::offer::{Offer, ReferenceId};
use crate::check::report::Report;
use crate::diagnostic::{Diagnostic, Severity, codes, quoted};
use crate::limits::LISTED_NAMES;
use crate::registry::ReferenceDeclaration;
use crate::source::Location;

/// What is known of the places of `autowire`.
#[derive(Default)]
pub(super) struct UselessAutowire {
    /// Those that are reported.
    told: HashSet<Location>,
    /// The scopes that were looked at, and whether autowire finds nothing for any reference there.
    scopes: HashMap<usize, bool>,
}

impl Wires<'_, '_> {
    /// Warns that autowire finds nothing for a reference that may do without: once for each place where it is written,
    /// and of a whole composite only where it finds nothing for any reference.
    pub(super) fn autowired_to_nothing(
        &self,
        (member, name): ReferenceId<'_>,
        declared: &ReferenceDeclaration,
        report: &mut Report<'_>,
    ) {
        let own = &self.fleet.members[member];
        let said = own.component.reference(name).and_then(|reference| reference.autowire).or(own.component.autowire);
        let Some(at) = said.or(own.composite.autowire).map(|said| said.location) else { return };
        let mut known = self.useless.borrow_mut();
        let is_useless =
            said.is_some() || *known.scopes.entry(own.scope).or_insert_with(|| self.finds_nothing_in(own.scope));
        if !is_useless || !known.told.insert(at) {
            return;
        }
        let message = format!(
            "autowire finds no service with the interface {} for reference {} of component {}",
            quoted(&declared.interface.name),
            quoted(name),
            quoted(&own.component.name)
        );
        let offers = self.fleet.scopes[own.scope].members.iter().filter(|one| **one != member).flat_map(|&offering| {
            let name = &self.fleet.members[offering].component.name;
            let interfaces = self.interfaces(offering).into_iter().flatten();
            interfaces.map(move |interface| format!("{} ({interface})", quoted(name))).collect::<Vec<_>>()
        });
        let offers: Vec<String> = offers.take(LISTED_NAMES).collect();
        let there = match offers.is_empty() {
            true => "no component beside it has a service".to_owned(),
            false => format!("the services beside it are those of {}", offers.join(", ")),
        };
        let one = Diagnostic::new(&codes::UNWIRED, at, message).severity(Severity::Warning).rule("ASM60028");
        let one = one.help(there).help("remove `autowire`, or add a component with that service");
        report.about_fleet(|report| report.push(one));
    }

    /// The interfaces of the services of a component; `None` for one that is not known.
    fn interfaces(&self, member: usize) -> Vec<Option<&str>> {
        let offers = self.fleet.offers(member).into_iter();
        let interface = |offer| match offer {
            Offer::Service(provider) => Some(self.fleet.interface_of(provider).map(|one| one.name.as_str())),
            Offer::Open => Some(None),
            Offer::Missing => None,
        };
        offers.filter_map(|(_, offer)| interface(offer)).collect()
    }

    /// True if no component in a scope has a service that another one has a reference for.
    fn finds_nothing_in(&self, scope: usize) -> bool {
        let members = &self.fleet.scopes[scope].members;
        // The only component that offers each interface; `None` where there are several.
        let mut offered: HashMap<&str, Option<usize>> = HashMap::new();
        for &member in members {
            for interface in self.interfaces(member) {
                let Some(interface) = interface else { return false };
                let only = offered.entry(interface).or_insert(Some(member));
                *only = only.filter(|only| *only == member);
            }
        }
        !members.iter().any(|member| {
            let references = self.fleet.class_of(*member).map(|class| &class.references);
            let offers = references.into_iter().flatten().filter_map(|one| offered.get(one.interface.name.as_str()));
            offers.into_iter().any(|only| only.is_none_or(|only| only != *member))
        })
    }
}
