//! All components of all composites as one fleet.

use std::collections::{BTreeMap, HashMap, HashSet};
use std::rc::Rc;

use super::classes::ClassIndex;
use super::instance::Instance;
use super::names::Names;
use crate::expression::has_expression;
use crate::model::{Component, Composite, Contribution, Reference, Service, Wire};
use crate::source::{FileId, Location};
use crate::syntax::ElementId;

/// The components of a fleet in document order, those of inner composites behind the component that each implements.
///
/// Several files form one fleet, as if one composite included them all: components of one file can be wired to those of
/// another, and names are unique across files.
pub(super) struct Fleet<'a> {
    pub(super) contribution: &'a Contribution,
    /// What components can see of each other: the first is that of the composites that were asked for.
    pub(super) scopes: Vec<Scope>,
    pub(super) units: Vec<Unit<'a>>,
    pub(super) members: Vec<Member<'a>>,
    /// The index of the component of each name of a scope.
    pub(super) by_name: HashMap<(usize, &'a str), usize>,
    /// The replicas of each replicated component of a scope, by its name with `*` for each expression.
    pub(super) groups: BTreeMap<(usize, String), Vec<usize>>,
    /// Components that a condition keeps away, where no other has their name: with the condition.
    pub(super) absent: HashMap<(usize, &'a str), Location>,
    /// Wires that a condition keeps away, by the unit that they are in.
    pub(super) absent_wires: HashSet<(usize, FileId, ElementId)>,
    /// The includes and wires with conditions, and whether any of them is there.
    pub(super) conditional: HashMap<(FileId, ElementId), bool>,
    /// What the expressions in units can name, where there are any.
    pub(super) names: Vec<Option<Rc<Names>>>,
}

/// Components that can be wired to each other.
#[derive(Default)]
pub(super) struct Scope {
    /// The component that it implements; `None` for the outermost.
    pub(super) owner: Option<usize>,
    pub(super) units: Vec<usize>,
    /// The places of its components; of 32 bits, as each component of a large fleet is here.
    pub(super) members: Vec<u32>,
    /// Whether a fault that is reported leaves some of it unknown.
    pub(super) is_faulty: bool,
    /// What components are called that could not be made for such a fault, with `*` for what is not known.
    pub(super) missing: Vec<String>,
}

/// A composite with all that it includes: one space of property, service and reference names.
pub(super) struct Unit<'a> {
    pub(super) scope: usize,
    /// The composite itself first.
    pub(super) composites: Vec<&'a Composite>,
    /// Whether a condition keeps it away.
    pub(super) is_absent: bool,
}

/// A component with what is found out about it.
pub(super) struct Member<'a> {
    /// The composite that it is written in.
    pub(super) composite: &'a Composite,
    pub(super) unit: usize,
    pub(super) scope: usize,
    pub(super) component: &'a Component,
    /// Whether its composite asks for autowire.
    pub(super) autowire: bool,
    pub(super) kind: Kind,
    /// The replica that it is.
    pub(super) instance: Option<&'a Instance>,
    /// Whether it, or a component around it, is a replica.
    pub(super) is_copy: bool,
    /// Whether a condition keeps it away: it is checked as far as it can be known, and is in no fleet.
    pub(super) is_absent: bool,
    /// Whether it stands for one that a fault keeps from being made: what is known of it is checked, and nothing is said of what others
    /// would share with it.
    pub(super) is_partial: bool,
    /// Whether it has the name of an earlier one, which is reported.
    pub(super) is_repeated: bool,
    /// Its path, where that is more than its name: a pointer of one word, as few have one.
    #[expect(clippy::box_collection, reason = "of a large fleet, a word of each component matters")]
    path: Option<Box<String>>,
}

/// What implements a component.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// Nothing that could run; that is reported.
    Nothing,
    /// The class of this place.
    Class(usize),
    /// The composite of this scope.
    Composite(usize),
    /// Something that is taken as given.
    Given,
}

impl<'a> Member<'a> {
    pub(super) fn new(composite: &'a Composite, unit: usize, scope: usize, component: &'a Component) -> Self {
        Self {
            composite,
            unit,
            scope,
            component,
            autowire: false,
            kind: Kind::Nothing,
            instance: None,
            is_copy: false,
            is_absent: false,
            is_partial: false,
            is_repeated: false,
            path: None,
        }
    }

    /// The name that tells it from all others of the fleet: the names of the components around it, and its own.
    pub(super) fn path(&self) -> &str {
        self.path.as_deref().map_or(&self.component.name, String::as_str)
    }

    /// Whether it is there in a run, rather than the composite that it is.
    pub(super) fn runs(&self) -> bool {
        !matches!(self.kind, Kind::Composite(_))
    }

    /// Whether a table that is not known may give it other values.
    pub(super) fn has_open_values(&self) -> bool {
        self.instance.and_then(|instance| instance.partial).is_some_and(|partial| partial.has_table)
    }

    /// Whether it may give other properties than those that are known: a table is not, or what one of them is called.
    pub(super) fn may_give_others(&self) -> bool {
        let Some(partial) = self.instance.and_then(|instance| instance.partial) else { return false };
        partial.has_table || self.component.properties.iter().any(|one| has_expression(&one.name))
    }

    pub(super) fn set_path(&mut self, path: String) {
        self.path = Some(Box::new(path));
    }
}

impl<'a> Unit<'a> {
    /// The composite itself.
    pub(super) fn main(&self) -> &'a Composite {
        self.composites[0]
    }

    /// The services of the composite, those of included ones behind its own.
    pub(super) fn services(&self) -> impl Iterator<Item = &'a Service> + use<'a, '_> {
        self.composites.iter().flat_map(|composite| &composite.services)
    }

    /// The references of the composite, those of included ones behind its own.
    pub(super) fn references(&self) -> impl Iterator<Item = &'a Reference> + use<'a, '_> {
        self.composites.iter().flat_map(|composite| &composite.references)
    }
}

impl<'a> Fleet<'a> {
    /// The component of this name in a scope.
    pub(super) fn find(&self, scope: usize, name: &str) -> Option<usize> {
        self.by_name.get(&(scope, name)).copied()
    }

    /// Whether this may be the name of a component that a fault, which is reported, kept from being made.
    pub(super) fn is_missing(&self, scope: usize, name: &str) -> bool {
        self.scopes[scope].missing.iter().any(|pattern| is_like(name, pattern))
    }

    /// Whether an include of a scope leads nowhere, which is reported: what stands there may wire anything.
    pub(super) fn lacks_include(&self, scope: usize) -> bool {
        self.scopes[scope].missing.iter().any(|pattern| pattern == "*")
    }

    /// The replicas that a name such as `Robot*` stands for.
    pub(super) fn group(&self, scope: usize, name: &str) -> Option<&[usize]> {
        if !name.contains('*') || self.find(scope, name).is_some() {
            return None;
        }
        self.groups.get(&(scope, name.to_owned())).map(Vec::as_slice)
    }

    /// The names of all groups of replicas of a scope, in order.
    pub(super) fn group_names(&self, scope: usize) -> impl Iterator<Item = &str> + Clone {
        let from = self.groups.range((scope, String::new())..);
        from.map(|((of, name), _)| (*of, name.as_str()))
            .take_while(move |(of, _)| *of == scope)
            .map(|(_, name)| name)
    }

    /// Whether a condition keeps a wire away.
    pub(super) fn is_absent_wire(&self, unit: usize, wire: &Wire) -> bool {
        !self.absent_wires.is_empty()
            && self.absent_wires.contains(&(unit, wire.origin.file(), wire.origin.element))
    }

    /// The names of all components of a scope, in order.
    pub(super) fn names(&self, scope: usize) -> impl Iterator<Item = &'a str> + Clone {
        let all = self.scopes[scope].members.iter().map(|member| &self.members[*member as usize]);
        all.filter(|member| !member.is_partial).map(|member| member.component.name.as_str())
    }

    /// The one unit of the composite that implements a component.
    pub(super) fn inner(&self, member: usize) -> Option<&Unit<'a>> {
        match self.members[member].kind {
            Kind::Composite(scope) => Some(&self.units[*self.scopes[scope].units.first()?]),
            _ => None,
        }
    }

    /// The class of a member.
    pub(super) fn class_of<'c, 'r>(
        &self,
        member: usize,
        classes: &'c [ClassIndex<'r>],
    ) -> Option<&'c ClassIndex<'r>> {
        match self.members[member].kind {
            Kind::Class(class) => Some(&classes[class]),
            _ => None,
        }
    }
}

/// Whether a name is like a pattern, in which `*` stands for anything.
pub(super) fn is_like(name: &str, pattern: &str) -> bool {
    let (Some((first, rest)), mut left) = (pattern.split_once('*'), name) else { return name == pattern };
    let Some(behind) = left.strip_prefix(first) else { return false };
    left = behind;
    let mut parts = rest.split('*').peekable();
    while let Some(part) = parts.next() {
        if parts.peek().is_none() {
            return left.ends_with(part);
        }
        let Some(place) = left.find(part) else { return false };
        left = &left[place + part.len()..];
    }
    true
}
