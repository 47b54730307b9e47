//! Which class each component is of.

use std::collections::HashMap;
use std::sync::Arc;

use super::fleet::{Fleet, Kind};
use super::report::{Report, escaped, list, replacing};
use super::slots::Slots;
use crate::diagnostic::{Diagnostic, codes, quoted};
use crate::model::{Component, ImplementationKind, Part};
use crate::registry::{
    Class, LoopDeclaration, ReferenceDeclaration, Registry, ServiceDeclaration, TopicDeclaration,
};
use crate::source::Text;

/// A class of the fleet, with its declaration at hand; where components of it have loops, together with these.
pub(super) struct ClassIndex<'r> {
    pub(super) class: &'r Arc<Class>,
    pub(super) slots: Slots<'r>,
    /// What it offers, what the host serves for it included.
    pub(super) services: Vec<&'r ServiceDeclaration>,
    /// Those of its loops included, like its topics.
    pub(super) references: Vec<&'r ReferenceDeclaration>,
    pub(super) publishes: Vec<&'r TopicDeclaration>,
    pub(super) subscribes: Vec<&'r TopicDeclaration>,
}

impl<'r> ClassIndex<'r> {
    fn new(class: &'r Arc<Class>) -> Self {
        let declaration = class.declaration();
        let services = declaration.offers().collect();
        Self {
            class,
            slots: Slots::of_class(class),
            services,
            references: declaration.references.iter().collect(),
            publishes: declaration.publishes.iter().collect(),
            subscribes: declaration.subscribes.iter().collect(),
        }
    }

    /// The same together with what these loops use.
    pub(super) fn with(&self, loops: impl Iterator<Item = &'r LoopDeclaration>) -> Self {
        let mut all = Self::new(self.class);
        for one in loops {
            // A topic that is declared twice in the same way is one; where two differ, both stay to be compared.
            all.publishes.extend(one.publishes.iter().filter(|topic| !self.publishes.contains(topic)));
            all.subscribes.extend(one.subscribes.iter().filter(|topic| !self.subscribes.contains(topic)));
            for reference in &one.references {
                if all.references.iter().all(|known| known.name != reference.name) {
                    all.references.push(reference);
                }
            }
        }
        all
    }

    /// Whether the topics it declares are any.
    pub(super) fn has_topics(&self) -> bool {
        !self.publishes.is_empty() || !self.subscribes.is_empty()
    }
}

/// Finds the class of every component; the classes that occur.
pub(super) fn resolve<'r>(
    fleet: &mut Fleet<'_>,
    registry: &'r Registry,
    assume_classes: bool,
    report: &mut Report<'_>,
) -> Vec<ClassIndex<'r>> {
    let mut classes = Vec::new();
    let mut known: HashMap<&str, usize> = HashMap::new();
    // What is near an unknown name, which a whole fleet may have.
    let mut near: HashMap<&str, Vec<&str>> = HashMap::new();
    for place in 0..fleet.members.len() {
        let component = fleet.members[place].component;
        let Some(class) = runnable(component, assume_classes, report) else {
            if assume_classes && fleet.members[place].kind == Kind::Nothing {
                fleet.members[place].kind = given(component);
            }
            continue;
        };
        let index = match known.get(class.as_str()) {
            Some(&index) => index,
            None => match registry.get(class) {
                Some(found) => {
                    classes.push(ClassIndex::new(found));
                    known.insert(class, classes.len() - 1);
                    classes.len() - 1
                }
                None if assume_classes => {
                    fleet.members[place].kind = Kind::Given;
                    continue;
                }
                None => {
                    let near = near.entry(class).or_insert_with(|| registry.nearest(class));
                    report.push(unknown(class, near, registry));
                    continue;
                }
            },
        };
        fleet.members[place].kind = Kind::Class(index);
    }
    classes
}

/// The name of the class of a component that names one.
fn runnable<'a>(component: &'a Component, assume_classes: bool, report: &mut Report<'_>) -> Option<&'a Text> {
    const SUPPORTED: &str = "components are implemented by a class: `implementation.java class=\"...\"` or `implementation.rust class=\"...\"`";
    let Some(implementation) = &component.implementation else {
        if assume_classes {
            return None;
        }
        // Reported by the loader, for SCA 1.0 as a warning.
        let why = "SCA 1.0 allows a component without an implementation, but it cannot run";
        report.escalate(&codes::MISSING_IMPLEMENTATION, component.origin.file(), why);
        return None;
    };
    match &implementation.kind {
        ImplementationKind::Java { class } => class.as_ref(),
        ImplementationKind::Rust { class, library } => {
            if let Some(library) = library
                && !assume_classes
            {
                let message = "classes from plugins are not supported yet: `library` names one";
                report.push(
                    Diagnostic::new(&codes::NOT_SUPPORTED_YET, library.location, message)
                        .help("leave `library` out where the class is linked into the program"),
                );
                return None;
            }
            class.as_ref()
        }
        // Unfolded already.
        ImplementationKind::Composite { .. } => None,
        ImplementationKind::Other { .. } if assume_classes => None,
        ImplementationKind::Other { kind, .. } => {
            let message = format!("{} cannot run here", quoted(&format!("implementation.{kind}")));
            let one = Diagnostic::new(&codes::IMPLEMENTATION_UNSUPPORTED, implementation.tag(), message);
            report.push(one.help(SUPPORTED));
            None
        }
    }
}

/// What a component without a class is when that is taken as given.
fn given(component: &Component) -> Kind {
    match component.implementation.as_ref().map(|implementation| &implementation.kind) {
        // A composite that is faulty, or missing: seen to when the fleet was unfolded.
        Some(ImplementationKind::Composite { .. }) => Kind::Nothing,
        _ => Kind::Given,
    }
}

fn unknown(class: &Text, near: &[&str], registry: &Registry) -> Diagnostic {
    const SHOWN: usize = 6;
    let message = format!("there is no class {}", quoted(class));
    let mut one = Diagnostic::new(&codes::UNKNOWN_CLASS, class.location, message).at("not registered");
    for meant in near {
        one = one.suggest(replacing(class, meant), class.location, escaped(meant));
    }
    let looked = match registry.len() {
        0 => "no class is linked into this program".to_owned(),
        1..=SHOWN => format!(
            "the classes linked into this program are {}",
            list(registry.iter().map(|class| class.name()))
        ),
        count => format!(
            "looked among the {count} classes linked into this program; `saoms components` lists them"
        ),
    };
    one.help(looked)
}
