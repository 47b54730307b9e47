//! All components of all composites as one fleet.

pub(crate) mod class_index;
pub(crate) mod property_table;

use std::collections::{BTreeMap, HashMap, HashSet};
use std::rc::Rc;

use smol_str::SmolStr;

use crate::check::fleet::class_index::ClassIndex;
use crate::check::judged::Faulty;
use crate::check::report::Report;
use crate::check::values::expression_scope::Names;
use crate::check::values::faulty_values::FaultyValues;
use crate::check::values::replica::Instance;
use crate::expression::has_expression;
use crate::limits::Budget;
use crate::model::{
    ComponentElement, ComponentType, Composite, Contribution, ReferenceElement, ServiceElement, WireElement,
};
use crate::registry::Registry;
use crate::source::{FileId, Location, Text};
use crate::syntax::ElementId;

/// The components of a fleet in document order, those of inner composites behind the component that each implements.
///
/// Several files form one fleet, as if one composite included them all: components of one file can be wired to those of
/// another, and names are unique across files.
pub(crate) struct Fleet<'a> {
    pub(crate) contribution: &'a Contribution,
    /// The scopes of component names: the first is that of the composites that were asked for.
    pub(crate) scopes: Vec<Scope>,
    pub(crate) units: Vec<Unit<'a>>,
    pub(crate) members: Vec<Member<'a>>,
    /// The classes that there are, once those of the components are resolved.
    pub(crate) registry: Option<&'a Registry>,
    /// The classes that occur, once they are resolved.
    pub(crate) classes: Vec<ClassIndex<'a>>,
    /// The replicas of each replicated component of a scope, by its name with `*` for each expression.
    pub(crate) groups: BTreeMap<(usize, String), Vec<usize>>,
    /// Components that a condition keeps away, where no other has their name: with the condition.
    pub(crate) absent: HashMap<(usize, &'a str), Location>,
    /// Wires that a condition keeps away, by the unit that they are in.
    pub(crate) absent_wires: HashSet<(usize, FileId, ElementId)>,
    /// The includes and wires with conditions, and whether any of them is there.
    pub(crate) conditional: HashMap<(FileId, ElementId), bool>,
    /// The fault of syntax or structure of a file: elements may be missing in it.
    pub(crate) misread: Option<Faulty>,
    /// The scopes of expressions in units that have any.
    pub(crate) names: Vec<Option<Rc<Names>>>,
    /// The values with a fault that is reported.
    pub(crate) faulty_values: Rc<FaultyValues>,
    /// The files of tables that are not read, since their names are expressions: each where it is written, and where
    /// the attribute is.
    pub(crate) wanted_tables: Vec<(Text, Location)>,
    /// The rest of the elements that paths of sources may look at.
    pub(crate) elements: Rc<Budget>,
}

/// Components that can be wired to each other.
#[derive(Default)]
pub(crate) struct Scope {
    /// The component that it implements; `None` for the outermost.
    pub(crate) owner: Option<usize>,
    pub(crate) units: Vec<usize>,
    /// Its components.
    pub(crate) members: Vec<usize>,
    /// The symbol table: its components by their names.
    pub(crate) by_name: HashMap<SmolStr, usize>,
    /// A fault that leaves some of it unknown.
    pub(crate) fault: Option<Faulty>,
    /// Names of components that could not be made for such a fault, with `*` for unknown parts.
    pub(crate) missing: Vec<String>,
}

/// A composite with all that it includes: one space of property, service and reference names.
pub(crate) struct Unit<'a> {
    pub(crate) scope: usize,
    /// The composite itself first.
    pub(crate) composites: Vec<&'a Composite>,
    /// True if a condition keeps it away.
    pub(crate) is_absent: bool,
    /// True if faults of texts may hide names of it.
    pub(crate) hides_names: bool,
}

impl<'a> Unit<'a> {
    /// The composite itself.
    pub(crate) fn main(&self) -> &'a Composite {
        self.composites[0]
    }

    /// The services of the composite, those of included ones behind its own.
    pub(crate) fn services(&self) -> impl Iterator<Item = &'a ServiceElement> + Clone + use<'a, '_> {
        self.composites.iter().flat_map(|composite| &composite.services)
    }

    /// The references of the composite, those of included ones behind its own.
    pub(crate) fn references(&self) -> impl Iterator<Item = &'a ReferenceElement> + Clone + use<'a, '_> {
        self.composites.iter().flat_map(|composite| &composite.references)
    }
}

/// A component with what is found out about it.
pub(crate) struct Member<'a> {
    /// The composite that it is written in.
    pub(crate) composite: &'a Composite,
    pub(crate) unit: usize,
    pub(crate) scope: usize,
    pub(crate) component: &'a ComponentElement,
    /// True if its composite asks for autowire.
    pub(crate) autowire: bool,
    pub(crate) kind: Kind,
    /// The replica that it is.
    pub(crate) instance: Option<&'a Instance>,
    /// True if it, or a component around it, is a replica.
    pub(crate) is_copy: bool,
    /// True if a condition keeps it away: it is checked as far as it can be known, and is in no fleet.
    pub(crate) is_absent: bool,
    /// True if it stands for one that a fault keeps from being made: what is known of it is checked, and nothing is
    /// said of what others would share with it.
    pub(crate) is_partial: bool,
    /// The site, with those around it; empty outside all sites.
    pub(crate) site: SmolStr,
    /// The node that runs it; empty where none is named.
    pub(crate) node: SmolStr,
    /// The name of the program that would run its outermost composite alone; empty where no other one was asked for.
    pub(crate) program: SmolStr,
    /// The fault of having the name of an earlier one.
    pub(crate) repeated: Option<Faulty>,
    /// Its path, where that is more than its name.
    pub(crate) path: Option<String>,
}

/// The implementation of a component.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// Nothing that could run; that is reported.
    Nothing,
    /// The class of this place.
    Class(usize),
    /// The composite of this scope.
    Composite(usize),
    /// Something that is taken as given.
    Given,
}

/// A side of a wire.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Side {
    Service,
    Reference,
}

impl Side {
    /// As people say it.
    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::Service => "service",
            Self::Reference => "reference",
        }
    }

    /// The rule of SCA that says that what is promoted has to be there.
    pub(crate) const fn rule(self) -> &'static str {
        match self {
            Self::Service => "ASM60004",
            Self::Reference => "ASM60007",
        }
    }
}

impl Member<'_> {
    /// The name that tells it from all others of the fleet: the names of the components around it, and its own.
    pub(crate) fn path(&self) -> &str {
        self.path.as_deref().unwrap_or(&self.component.name)
    }

    /// True if it is there in a run, rather than the composite that it is.
    pub(crate) fn runs(&self) -> bool {
        !matches!(self.kind, Kind::Composite(_))
    }

    /// True if a table that is not known may give it other values.
    pub(crate) fn lacks_table(&self) -> bool {
        self.instance.and_then(|instance| instance.partial).is_some_and(|partial| partial.has_table)
    }

    /// True if it may give other properties than those that are known: a table is not, or what one of them is called.
    pub(crate) fn may_give_others(&self) -> bool {
        let Some(partial) = self.instance.and_then(|instance| instance.partial) else { return false };
        partial.has_table || self.component.properties.iter().any(|one| has_expression(&one.name))
    }
}

impl Report<'_> {
    /// Lets what follows be about this component.
    pub(crate) fn about(&mut self, member: &Member<'_>) {
        match member.is_copy {
            true => self.about_replica(member.path(), member.instance.map(|instance| instance.index)),
            false => self.about_all(),
        }
    }
}

impl<'a> Fleet<'a> {
    /// The component type beside the implementation of a component.
    pub(crate) fn component_type(&self, member: usize) -> Option<&'a ComponentType> {
        if !self.contribution.describes_any() {
            return None;
        }
        let implementation = self.members[member].component.implementation.as_ref()?;
        self.contribution.component_type(implementation.origin)
    }

    /// The component of this name in a scope.
    pub(crate) fn find(&self, scope: usize, name: &str) -> Option<usize> {
        self.scopes[scope].by_name.get(name).copied()
    }

    /// True if this may be the name of a component that a fault, which is reported, kept from being made.
    pub(crate) fn is_missing(&self, scope: usize, name: &str) -> bool {
        self.scopes[scope].missing.iter().any(|pattern| is_like(name, pattern))
    }

    /// True if an include of a scope leads nowhere, which is reported: what stands there may wire anything.
    pub(crate) fn lacks_include(&self, scope: usize) -> bool {
        self.scopes[scope].missing.iter().any(|pattern| pattern == "*")
    }

    /// The replicas that a name such as `Robot*` stands for.
    pub(crate) fn group(&self, scope: usize, name: &str) -> Option<&[usize]> {
        if !name.contains('*') || self.find(scope, name).is_some() {
            return None;
        }
        self.groups.get(&(scope, name.to_owned())).map(Vec::as_slice)
    }

    /// The names of all groups of replicas of a scope, in order.
    pub(crate) fn group_names(&self, scope: usize) -> impl Iterator<Item = &str> + Clone {
        let from = self.groups.range((scope, String::new())..);
        from.map(|((of, name), _)| (*of, name.as_str())).take_while(move |(of, _)| *of == scope).map(|(_, name)| name)
    }

    /// True if a condition keeps a wire away.
    pub(crate) fn is_absent_wire(&self, unit: usize, wire: &WireElement) -> bool {
        !self.absent_wires.is_empty() && self.absent_wires.contains(&(unit, wire.origin.file(), wire.origin.element))
    }

    /// The names of all components of a scope, in order.
    pub(crate) fn names(&self, scope: usize) -> impl Iterator<Item = &'a str> + Clone {
        let all = self.scopes[scope].members.iter().map(|member| &self.members[*member]);
        all.filter(|member| !member.is_partial).map(|member| member.component.name.as_str())
    }

    /// The one unit of the composite that implements a component.
    pub(crate) fn inner(&self, member: usize) -> Option<&Unit<'a>> {
        match self.members[member].kind {
            Kind::Composite(scope) => Some(&self.units[*self.scopes[scope].units.first()?]),
            _ => None,
        }
    }

    /// The class of a member.
    pub(crate) fn class_of(&self, member: usize) -> Option<&ClassIndex<'a>> {
        match self.members[member].kind {
            Kind::Class(class) => Some(&self.classes[class]),
            _ => None,
        }
    }
}

/// True if a name is like a pattern, in which `*` stands for anything.
pub(crate) fn is_like(name: &str, pattern: &str) -> bool {
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
