//! All components of all composites as one fleet.

use std::collections::HashMap;

use super::classes::ClassIndex;
use super::report::Report;
use crate::diagnostic::{Diagnostic, codes, quoted};
use crate::model::{Component, Composite, Part};

/// The components of all files in order.
///
/// Several files form one fleet, as if one composite included them all: components of one file can be wired to those of
/// another, and names are unique across files.
pub(super) struct Fleet<'a> {
    pub(super) composites: &'a [Composite],
    pub(super) members: Vec<Member<'a>>,
    by_name: HashMap<&'a str, usize>,
}

/// A component with what is found out about it.
pub(super) struct Member<'a> {
    /// The place of its composite.
    pub(super) composite: usize,
    pub(super) component: &'a Component,
    /// `None` when it has no class that could run; that is reported.
    pub(super) class: Option<usize>,
}

impl<'a> Fleet<'a> {
    /// Collects the components and checks that names are unique.
    pub(super) fn of(composites: &'a [Composite], report: &mut Report<'_>) -> Self {
        let count = composites.iter().map(|composite| composite.components.len()).sum();
        let mut fleet =
            Self { composites, members: Vec::with_capacity(count), by_name: HashMap::with_capacity(count) };
        let mut names: HashMap<(&str, &str), &Composite> = HashMap::new();
        for (place, composite) in composites.iter().enumerate() {
            let namespace = composite.target_namespace.as_ref().map_or("", |namespace| namespace.as_str());
            let name = composite.name.as_str();
            match names.get(&(namespace, name)) {
                Some(first) if !name.is_empty() => {
                    let message = format!("there are two composites {} in one namespace", quoted(name));
                    report.push(
                        Diagnostic::new(&codes::COMPOSITE_REPEATED, composite.name.location, message)
                            .label(first.name.location, "the first")
                            .help("give each its own name; was one file given twice?"),
                    );
                }
                _ => _ = names.insert((namespace, name), composite),
            }
            for include in &composite.includes {
                let message = "`include` is not supported yet";
                report.push(
                    Diagnostic::new(&codes::NOT_SUPPORTED_YET, include.tag(), message).help(
                        "name the included file on the command line, too: several files form one fleet",
                    ),
                );
            }
            for component in &composite.components {
                fleet.add(place, component, report);
            }
        }
        fleet
    }

    fn add(&mut self, composite: usize, component: &'a Component, report: &mut Report<'_>) {
        let name = component.name.as_str();
        let index = self.members.len();
        self.members.push(Member { composite, component, class: None });
        if name.is_empty() {
            return;
        }
        match self.by_name.get(name) {
            None => _ = self.by_name.insert(name, index),
            Some(&first) => {
                let message = format!("there are two components {}", quoted(name));
                report.push(
                    Diagnostic::new(&codes::COMPONENT_REPEATED, component.name.location, message)
                        .label(self.members[first].component.name.location, "the first")
                        .help("give each its own name"),
                );
            }
        }
    }

    /// The place of the component of this name.
    pub(super) fn find(&self, name: &str) -> Option<usize> {
        self.by_name.get(name).copied()
    }

    /// The names of all components, in order.
    pub(super) fn names(&self) -> impl Iterator<Item = &'a str> + Clone {
        self.members.iter().map(|member| member.component.name.as_str())
    }

    /// The composite of a member.
    pub(super) fn composite_of(&self, member: &Member<'a>) -> &'a Composite {
        &self.composites[member.composite]
    }

    /// The class of a member.
    pub(super) fn class_of<'c, 'r>(
        &self,
        member: usize,
        classes: &'c [ClassIndex<'r>],
    ) -> Option<&'c ClassIndex<'r>> {
        Some(&classes[self.members[member].class?])
    }
}
