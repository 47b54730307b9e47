//! All components of all composites as one fleet.

use std::collections::HashMap;

use super::classes::ClassIndex;
use crate::model::{Component, Composite, Contribution, Reference, Service};

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
    pub(super) by_name: HashMap<(usize, &'a str), usize>,
}

/// Components that can be wired to each other.
#[derive(Default)]
pub(super) struct Scope {
    /// The component that it implements; `None` for the outermost.
    pub(super) owner: Option<usize>,
    pub(super) units: Vec<usize>,
    pub(super) members: Vec<usize>,
}

/// A composite with all that it includes: one space of property, service and reference names.
pub(super) struct Unit<'a> {
    pub(super) scope: usize,
    /// The composite itself first.
    pub(super) composites: Vec<&'a Composite>,
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
    /// Its path, where that is more than its name.
    path: Option<Box<str>>,
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
        Self { composite, unit, scope, component, autowire: false, kind: Kind::Nothing, path: None }
    }

    /// The name that tells it from all others of the fleet: the names of the components around it, and its own.
    pub(super) fn path(&self) -> &str {
        self.path.as_deref().unwrap_or(&self.component.name)
    }

    pub(super) fn set_path(&mut self, path: String) {
        self.path = Some(path.into());
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
        let by_name: &HashMap<(usize, &str), usize> = &self.by_name;
        by_name.get(&(scope, name)).copied()
    }

    /// The names of all components of a scope, in order.
    pub(super) fn names(&self, scope: usize) -> impl Iterator<Item = &'a str> + Clone {
        self.scopes[scope].members.iter().map(|member| self.members[*member].component.name.as_str())
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
