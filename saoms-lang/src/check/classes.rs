//! The class of each component.

mod in_python;

use std::collections::{HashMap, HashSet};
use std::path::Path;

use crate::check::fleet::{Fleet, Kind, class_index::ClassIndex};
use crate::check::options::Options;
use crate::check::report::{Report, list};
use crate::diagnostic::{Diagnostic, Severity, codes, nearest_few, quoted};
use crate::expression::has_expression;
use crate::limits::OFFERED_NAMES;
use crate::model::{ComponentElement, Contribution, ImplementationKind, LibraryLink, Part};
use crate::registry::Registry;
use crate::source::{FileId, Sources, Text};

/// Finds the class of every component.
pub(crate) fn resolve<'a>(fleet: &mut Fleet<'a>, registry: &'a Registry, options: &Options, report: &mut Report<'_>) {
    fleet.registry = Some(registry);
    let contribution = fleet.contribution;
    let mut known: HashMap<&str, Option<usize>> = HashMap::new();
    // What is near an unknown name, which a whole fleet may have.
    let mut near: HashMap<&str, Vec<&str>> = HashMap::new();
    for place in 0..fleet.members.len() {
        let component = fleet.members[place].component;
        // What is not there may come with a plugin where its condition is true.
        let assumes = options.assume_classes || fleet.members[place].is_absent;
        report.about(&fleet.members[place]);
        let Some(class) = runnable(component, assumes, report) else {
            // A composite that is faulty, or missing, was seen to when the fleet was unfolded.
            let kind = component.implementation.as_ref().map(|implementation| &implementation.kind);
            if assumes && !matches!(kind, Some(ImplementationKind::Composite { .. })) {
                fleet.members[place].kind = Kind::Given;
            }
            continue;
        };
        // An expression that is still there has a fault, which is reported.
        if fleet.members[place].instance.is_some_and(|one| one.partial.is_some()) && has_expression(class) {
            continue;
        }
        if !is_in_library(component, class, contribution, registry, assumes, report) {
            if assumes {
                fleet.members[place].kind = Kind::Given;
            }
            continue;
        }
        let found = *known.entry(class).or_insert_with(|| {
            fleet.classes.push(ClassIndex::new(registry.get(class)?));
            Some(fleet.classes.len() - 1)
        });
        fleet.members[place].kind = match found {
            Some(index) => Kind::Class(index),
            None if assumes => Kind::Given,
            None => {
                if !report.skip(&codes::UNKNOWN_CLASS, Severity::Error, class.location) {
                    let near = near.entry(class).or_insert_with(|| registry.nearest(class));
                    let fitting: Vec<&str> =
                        near.iter().copied().filter(|near| fits(component, near, registry)).collect();
                    let near = if fitting.is_empty() { &*near } else { &fitting };
                    let composites = contribution.composites().iter();
                    let local = class.rsplit(':').next().unwrap_or(class);
                    // The name of a class has no colon.
                    let is_name = class.contains(':') || composites.clone().any(|one| one.name == *local);
                    let composite = Some(class.as_str()).filter(|_| is_name && !class.contains("::"));
                    report.push(unknown(class, near, composite, registry));
                }
                continue;
            }
        };
    }
    report.about_all();
    if !options.assume_classes {
        without_implementation(fleet, report);
    }
}

/// Makes errors of what the loader reports as a warning in files of SCA 1.0: components without an implementation.
fn without_implementation(fleet: &Fleet<'_>, report: &mut Report<'_>) {
    let lacking = fleet.members.iter().filter(|member| !member.is_absent && member.component.implementation.is_none());
    let files: HashSet<FileId> = lacking.map(|member| member.component.origin.file()).collect();
    if !files.is_empty() {
        report.diagnostics().adjust(0, |one| {
            let is_meant = one.code == &codes::MISSING_IMPLEMENTATION && files.contains(&one.location.file);
            if is_meant && one.severity == Severity::Warning {
                one.severity = Severity::Error;
                one.help.push("SCA 1.0 allows a component without an implementation, but it cannot run".to_owned());
            }
        });
    }
}

/// The name of the class of a component that names one.
fn runnable<'a>(component: &'a ComponentElement, assume_classes: bool, report: &mut Report<'_>) -> Option<&'a Text> {
    const SUPPORTED: &str = "name the class of the component: `implementation.java class=\"...\"`, `implementation.rust class=\"...\"` or \
        `implementation.python module=\"...\" class=\"...\"`";
    let implementation = component.implementation.as_ref()?;
    match &implementation.kind {
        ImplementationKind::Java { class } | ImplementationKind::Rust { class, .. } => class.as_ref(),
        ImplementationKind::Python(class) => class.name.as_ref(),
        // Unfolded already.
        ImplementationKind::Composite { .. } => None,
        ImplementationKind::Other { .. } if assume_classes => None,
        ImplementationKind::Other { kind, is_sca } => {
            let element = quoted(&format!("implementation.{kind}"));
            let is_of_sca = *is_sca || !["java", "rust", "python", "composite"].contains(&kind.as_str());
            let (message, help) = match is_of_sca {
                true => (format!("this program cannot run {element}"), SUPPORTED),
                false => (
                    format!("this program cannot run {element} of another namespace"),
                    "to use the element of SCA, write it with the prefix of the elements around it, or without a \
                    prefix if they have none",
                ),
            };
            // What it lacks does not matter then.
            report.withdraw(&codes::MISSING_ATTRIBUTE, implementation.tag());
            let one = Diagnostic::new(&codes::IMPLEMENTATION_UNSUPPORTED, implementation.tag(), message);
            report.push(one.help(help));
            None
        }
    }
}

/// True if the class is in the library that is to have it, where one is named.
fn is_in_library(
    component: &ComponentElement,
    class: &Text,
    contribution: &Contribution,
    registry: &Registry,
    assume_classes: bool,
    report: &mut Report<'_>,
) -> bool {
    let Some(implementation) = &component.implementation else { return true };
    let library = match &implementation.kind {
        ImplementationKind::Rust { library: Some(library), .. } => library,
        ImplementationKind::Python(python) => {
            let (Some(module), Some(class)) = (&python.module, &python.class) else { return true };
            let link = contribution.library(implementation.origin);
            return in_python::is_declared((module, class), link, assume_classes, report);
        }
        _ => return true,
    };
    let wrong = |message: String| Diagnostic::new(&codes::LIBRARY, library.location, message);
    let found = match contribution.library(implementation.origin) {
        Some(LibraryLink::To(path)) => {
            let has = registry.get(class);
            if has.is_some_and(|has| has.origin() == Some(path)) {
                return true;
            }
            let file = quoted(&path.display().to_string());
            let mut one = wrong(format!("the library {file} has no class {}", quoted(class)));
            let own: Vec<&str> = registry.of(path).collect();
            for meant in nearest_few(class, own.iter().copied(), OFFERED_NAMES) {
                one = one.replace(class, class.location, meant);
            }
            one = one.help(match own.len() {
                0 => "it has no component class".to_owned(),
                _ => format!("its classes are {}", list(own.into_iter())),
            });
            match has.map(|has| has.origin()) {
                None => one,
                Some(None) => one.help("remove `library`: the class is part of this program"),
                Some(Some(other)) => one.help(format!("the class is in {}", quoted(&other.display().to_string()))),
            }
        }
        Some(LibraryLink::Faulty(message)) => wrong(message.clone()),
        Some(LibraryLink::Outside(path)) => {
            let message = "this library is outside the folder of the composite, and is not read";
            Diagnostic::new(&codes::FILE_OUTSIDE, library.location, message).help(format!(
                "name {} or its folder with `--plugin`, or allow it with `--allow-outside`",
                quoted(&path.display().to_string())
            ))
        }
        Some(LibraryLink::Missing(looked)) => {
            let one = wrong(format!("there is no library {}", quoted(library)));
            let is_own = registry.get(class).is_some_and(|has| has.origin().is_none());
            let one = if is_own { one.help("remove `library`: the class is part of this program") } else { one };
            let looked: Vec<String> = looked.iter().map(|path| path.display().to_string()).collect();
            one.help(format!("looked for {}", list(looked.iter().map(String::as_str)))).help(
                "write the path of the library from the folder of the composite, or name its folder with `--plugin`",
            )
        }
        Some(LibraryLink::Undeclared(_)) | None => {
            wrong(format!("the library {} was not searched for", quoted(library)))
        }
    };
    if !assume_classes {
        report.push(found);
    }
    false
}

/// The library that a component's composite names for its class, as the first composite would name it.
pub(crate) fn library(component: &ComponentElement, contribution: &Contribution, sources: &Sources) -> Option<String> {
    let implementation = component.implementation.as_ref()?;
    if matches!(implementation.kind, ImplementationKind::Python(_)) {
        return None;
    }
    let Some(LibraryLink::To(path)) = contribution.library(implementation.origin) else { return None };
    let first = contribution.asked_for().first()?;
    let folder = Path::new(sources.get(first.file()).path()).parent().unwrap_or(Path::new(""));
    let from_there = path.strip_prefix(folder).map(Path::to_owned).ok();
    let path = from_there.or_else(|| std::path::absolute(path).ok()).unwrap_or_else(|| path.clone());
    Some(path.display().to_string())
}

/// True if a class has all properties and references that a component gives.
fn fits(component: &ComponentElement, class: &str, registry: &Registry) -> bool {
    let Some(class) = registry.get(class).map(ClassIndex::new) else { return false };
    let has = |name: &str| class.references.iter().any(|one| one.name == name);
    component.properties.iter().all(|one| class.table.place(&one.name).is_some())
        && component.references.iter().all(|one| has(&one.name))
}

fn unknown(class: &Text, near: &[&str], composite: Option<&str>, registry: &Registry) -> Diagnostic {
    let message = format!("there is no class {}", quoted(class));
    let mut one = Diagnostic::new(&codes::UNKNOWN_CLASS, class.location, message).at("not registered");
    for meant in near {
        one = one.replace(class, class.location, meant);
    }
    if registry.get_loop(class).is_some() {
        let inside = format!("`<saoms:loop name=\"...\" class=\"{class}\"/>`");
        return one.help(format!("it is a loop: write {inside} in a component that has loops"));
    }
    if let Some(name) = composite {
        let meant = format!("<implementation.composite name=\"{name}\"/>");
        return one.help(format!("it is a composite: write {}", quoted(&meant)));
    }
    one.help(registered(("class", "classes"), registry.iter().map(|class| class.name())))
}

/// Help with what is registered of a kind: `one` of it, or `several`.
pub(crate) fn registered<'r>((one, several): (&str, &str), all: impl ExactSizeIterator<Item = &'r str>) -> String {
    const SHOWN: usize = 6;
    match all.len() {
        0 => format!("no {one} is linked into this program"),
        1..=SHOWN => format!("the {several} linked into this program are {}", list(all)),
        count => format!(
            "`saoms components` lists the {count} {several} of this program and its plugins; `--plugin PATH` adds the \
            {several} of a plugin"
        ),
    }
}
