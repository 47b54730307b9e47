//! Dangling names: references that a wrong name probably means are not reported a second time.

use std::collections::{HashMap, HashSet};

use super::promotion::ReferenceId;
use super::uri::parts;
use crate::check::fleet::Fleet;
use crate::diagnostic::nearest;
use crate::source::Text;

/// Names of components that do not exist that are looked at, of each scope: a file full of them means nothing by each.
const MOST_LOST: usize = 100;

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
        if lost.len() < MOST_LOST {
            lost.insert(component);
        }
    }

    /// True if one of them names a component that does not exist in this scope.
    pub(super) fn names_unknown_component(&self, scope: usize) -> bool {
        self.lost.contains_key(&scope)
    }

    /// True if one of them is probably meant to be this reference.
    pub(crate) fn means(&self, (member, name): ReferenceId<'_>, fleet: &Fleet<'_>) -> bool {
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
pub(crate) fn is_misspelt((member, name): ReferenceId<'_>, fleet: &Fleet<'_>) -> bool {
    let given = fleet.members[member].component.references.iter();
    given.into_iter().any(|given| is_meant(&given.name, (member, name), fleet))
}

/// True if a name that no reference of a component has stands for this one: it is like it, or like none.
fn is_meant(written: &str, (member, name): ReferenceId<'_>, fleet: &Fleet<'_>) -> bool {
    let names = fleet.reference_names(member).unwrap_or_default();
    !names.contains(&written) && nearest(written, names).is_none_or(|near| near == name)
}
