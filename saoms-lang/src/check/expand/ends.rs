//! Where references lead when composites inside each other are one.

use std::collections::HashSet;

use super::Expanding;
use super::outer::inside;
use crate::check::fleet::Kind;
use crate::check::multiplicity::keeps_own;
use crate::check::offer::Side;
use crate::check::target::{is_address, parts, spread};
use crate::diagnostic::{Diagnostic, codes, quoted};
use crate::model::{Interface, Reference};
use crate::source::Text;

impl<'a> Expanding<'_, 'a> {
    /// The targets of a reference of a component, each once; those that components around it give it included. An empty name stands for a
    /// reference whose name nobody knows.
    pub(super) fn ends(&self, place: (usize, &str)) -> Vec<String> {
        let mut all = self.all_ends(place);
        let mut seen = HashSet::new();
        all.retain(|end| seen.insert(end.clone()));
        all
    }

    fn all_ends(&self, (member, name): (usize, &str)) -> Vec<String> {
        let own = self.member(member);
        let reference = own.component.reference(name);
        let wires = self.wires.get(&member).into_iter().flatten().filter(|wire| wire.name == name);
        let is_replaced = wires.clone().any(|wire| wire.is_replacing);
        let interface = reference.and_then(Reference::interface);
        let mut ends = Vec::new();
        let mut is_said = false;
        if let Some(reference) = reference {
            let bindings = reference.bindings().iter().filter(|one| one.is_sca && one.kind == "sca");
            for text in reference.targets.iter().chain(bindings.filter_map(|one| one.uri.as_ref())) {
                is_said = true;
                if !is_replaced {
                    ends.extend(self.leads(text, (own.scope, Some(member)), interface));
                }
            }
        }
        for wire in wires {
            is_said = true;
            ends.extend(self.leads(wire.target, (wire.scope, Some(member)), interface));
        }
        if let Some(inner) = self.fleet.inner(member).filter(|_| !is_said) {
            let declared = inner.references().find(|one| one.name == name);
            for text in declared.map_or(&[][..], |declared| &declared.targets) {
                ends.extend(self.leads(text, (own.scope, Some(member)), interface));
            }
        }
        let steps = self.references.steps(member, name);
        let around: Vec<String> = steps.flat_map(|step| self.all_ends((step.owner, step.outer))).collect();
        if !around.is_empty() && !ends.is_empty() && !keeps_own(self.fleet, (member, name), reference) {
            return around;
        }
        ends.extend(around);
        ends
    }

    /// What a target comes to.
    pub(super) fn leads(
        &self,
        text: &Text,
        (scope, own): (usize, Option<usize>),
        interface: Option<&Interface>,
    ) -> Vec<String> {
        let others =
            spread(text, scope, self.fleet).filter(|(_, replica)| replica.is_none() || *replica != own);
        others.map(|(one, _)| self.lead(&one, scope, interface)).collect()
    }

    fn lead(&self, text: &Text, scope: usize, interface: Option<&Interface>) -> String {
        let mut steps = text.split('/');
        let (component, mut part, mut binding) =
            (steps.next().unwrap_or_default(), steps.next(), steps.next());
        let known = self.fleet.find(scope, component).filter(|_| !is_address(text));
        let Some(mut member) = known else { return text.to_string() };
        while let Kind::Composite(scope) = self.member(member).kind {
            let services = || self.fleet.inner(member).into_iter().flat_map(|inner| inner.services());
            let fits = |one: &&crate::model::Service| {
                let said = |one: Option<&Interface>| one?.interface.clone().map(|name| name.value);
                said(interface).is_some() && said(one.interface()) == said(interface)
            };
            let service = match part {
                Some(name) => services().find(|one| one.name == *name),
                None if services().nth(1).is_none() => services().next(),
                None => services().find(fits),
            };
            let promote = service.and_then(|service| Some((service, service.promote.as_ref()?)));
            let next = promote.and_then(|(service, promote)| {
                let (component, inner) = parts(promote);
                Some((service, self.fleet.find(scope, component)?, inner))
            });
            let Some((service, next, inner)) = next else {
                let component = &self.member(member).component.name;
                let message =
                    format!("which service of component {} is meant is not known", quoted(component));
                let one = Diagnostic::new(&codes::TARGET_AMBIGUOUS, text.location, message);
                self.faults
                    .borrow_mut()
                    .push(one.help("its composite has several: write `component/service`"));
                return text.to_string();
            };
            // A binding without a name has that of its service.
            binding = binding.and_then(|name| if name == service.name.as_str() { inner } else { Some(name) });
            (member, part) = (next, inner);
        }
        let mut uri = self.names[member].clone();
        for name in [part, binding.filter(|_| part.is_some())].into_iter().flatten() {
            uri.push('/');
            uri.push_str(name);
        }
        uri
    }

    /// What the composite promotes by a text, of components that are there.
    pub(super) fn promotes(&self, text: &Text, side: Side, scope: usize) -> Vec<String> {
        let has_part = text.contains('/');
        let mut all = Vec::new();
        for (member, name) in inside(text, side, scope, self.fleet, self.classes) {
            let Kind::Composite(scope) = self.member(member).kind else {
                // What is not named needs no name.
                let is_named = has_part && !name.is_empty();
                all.push(if is_named {
                    format!("{}/{name}", self.names[member])
                } else {
                    self.names[member].clone()
                });
                continue;
            };
            let Some(inner) = self.fleet.inner(member) else { continue };
            match side {
                Side::Service => {
                    let found = inner.services().filter(|one| one.name == *name);
                    let promoted = found.filter_map(|one| one.promote.as_deref());
                    all.extend(promoted.flat_map(|text| self.promotes(text, side, scope)));
                }
                Side::Reference => {
                    let found = inner.references().filter(|one| one.name == *name);
                    all.extend(
                        found.flat_map(Reference::promote).flat_map(|text| self.promotes(text, side, scope)),
                    );
                }
            }
        }
        all
    }
}
