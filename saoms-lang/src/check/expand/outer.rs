//! What composites promote, from the inside: which services and references of those around it one of a component is.

use std::collections::HashMap;

use crate::check::classes::ClassIndex;
use crate::check::fleet::{Fleet, Kind};
use crate::check::offer::Side;
use crate::check::target::{parts, spread};
use crate::source::Text;
use crate::xml::Element;

/// Services or references of components that composites promote which implement others: by the component.
pub(super) struct Outer<'a>(HashMap<usize, Vec<Step<'a>>>);

/// One step outwards.
#[derive(Clone)]
pub(super) struct Step<'a> {
    /// Of the service or the reference of the component inside; empty where nobody knows its name.
    pub(super) name: String,
    /// The component that the composite implements.
    pub(super) owner: usize,
    /// Of its service or its reference.
    pub(super) outer: &'a str,
    /// What promotes it.
    pub(super) element: Element<'a>,
}

impl<'a> Outer<'a> {
    pub(super) fn of(side: Side, fleet: &Fleet<'a>, classes: &[ClassIndex<'_>]) -> Self {
        let mut all: HashMap<usize, Vec<Step<'a>>> = HashMap::new();
        for unit in &fleet.units {
            let Some(owner) = fleet.scopes[unit.scope].owner else { continue };
            let parts = unit.composites.iter().flat_map(|composite| {
                let services = composite.services.iter().filter(|_| side == Side::Service);
                let services = services.map(|one| {
                    (one.origin, &one.name, one.promote.as_deref().into_iter().collect::<Vec<_>>())
                });
                let references = composite.references.iter().filter(|_| side == Side::Reference);
                let references =
                    references.map(|one| (one.origin, &one.name, one.promote().iter().collect()));
                let document = &composite.document;
                services
                    .chain(references)
                    .map(move |(origin, name, promote)| (origin.element(document), name, promote))
            });
            for (element, outer, promote) in parts {
                for (member, name) in
                    promote.into_iter().flat_map(|text| inside(text, side, unit.scope, fleet, classes))
                {
                    all.entry(member).or_default().push(Step { name, owner, outer, element });
                }
            }
        }
        Self(all)
    }

    /// The steps outwards from all of a component.
    pub(super) fn of_member(&self, member: usize) -> &[Step<'a>] {
        self.0.get(&member).map_or(&[], Vec::as_slice)
    }

    /// The steps outwards from one service or reference.
    pub(super) fn steps(&self, member: usize, name: &str) -> impl Iterator<Item = &Step<'a>> {
        self.of_member(member).iter().filter(move |step| step.name == name)
    }
}

/// What a text promotes in a scope, with an empty name where nobody knows it.
pub(super) fn inside(
    text: &Text,
    side: Side,
    scope: usize,
    fleet: &Fleet<'_>,
    classes: &[ClassIndex<'_>],
) -> Vec<(usize, String)> {
    let found = spread(text, scope, fleet).filter_map(|(text, _)| {
        let (component, part) = parts(&text);
        let member = fleet.find(scope, component)?;
        let name = part.or_else(|| only(member, side, fleet, classes)).unwrap_or_default();
        Some((member, name.to_owned()))
    });
    found.collect()
}

/// The only service or reference of a component, as far as anybody knows.
pub(super) fn only<'n>(
    member: usize,
    side: Side,
    fleet: &'n Fleet<'_>,
    classes: &'n [ClassIndex<'_>],
) -> Option<&'n str> {
    let names = match (fleet.members[member].kind, side) {
        (Kind::Given | Kind::Nothing, _) => fleet.written_names(member, side),
        (_, Side::Service) => return fleet.only_service(member, classes),
        (_, Side::Reference) => fleet.reference_names(member, classes)?,
    };
    if let [only] = names[..] { Some(only) } else { None }
}
