//! The intents that composites require: those of SCA by their names, and those that exclude each other (SCA Assembly 1.1, 5.2 and 5.4; SCA Policy 1.1).

use std::collections::{BTreeSet, HashMap, HashSet};

use super::vocabulary::STANDARD_INTENTS;
use crate::diagnostic::{Diagnostic, Diagnostics, Severity, codes, nearest, quoted};
use crate::model::{Composite, OutsideKind, Version};
use crate::source::{Location, Text};
use crate::xml::Element;

/// The intents of SCA that exclude each other (SCA Policy 1.1, 9 and 10).
const EXCLUDED: &[(&str, &str)] = &[
    ("managedTransaction", "noManagedTransaction"),
    ("transactedOneWay", "immediateOneWay"),
    ("propagatesTransaction", "suspendsTransaction"),
    ("propagatesTransaction", "asyncInvocation"),
    ("SOAP.v1_1", "SOAP.v1_2"),
];

/// A name in a namespace.
pub(super) type Name = (String, String);

/// Which intents exclude which, by files of definitions.
#[derive(Default)]
pub(super) struct Excluded(HashSet<(Name, Name)>);

/// An intent that something requires.
struct Required<'a> {
    name: Name,
    written: &'a Text,
}

impl Excluded {
    /// Adds what an `intent` of this name says.
    pub(super) fn add(&mut self, name: &Name, intent: Element<'_>) {
        let Some(excludes) = intent.attribute("excludes") else { return };
        let names =
            excludes.words().filter_map(|word| resolve(&word, intent)).map(|other| (name.clone(), other));
        self.0.extend(names);
    }

    /// Whether one of these intents excludes the other; a qualified one is of its kind.
    fn holds(&self, one: &Name, other: &Name) -> bool {
        let forms = |(namespace, local): &Name| {
            let base = local.split_once('.').map(|(base, _)| (namespace.clone(), base.to_owned()));
            [Some((namespace.clone(), local.clone())), base].into_iter().flatten().collect::<Vec<Name>>()
        };
        let (ones, others) = (forms(one), forms(other));
        ones.iter().flat_map(|one| others.iter().map(move |other| (one, other))).any(|(one, other)| {
            let are_of_sca = [one, other].iter().all(|name| Version::from_namespace(&name.0).is_some());
            let is_pair = |(a, b): &(&str, &str)| {
                (*a, *b) == (one.1.as_str(), other.1.as_str())
                    || (*b, *a) == (one.1.as_str(), other.1.as_str())
            };
            are_of_sca && EXCLUDED.iter().any(is_pair)
                || self.0.contains(&(one.clone(), other.clone()))
                || self.0.contains(&(other.clone(), one.clone()))
        })
    }

    /// The first two of these of which one excludes the other.
    fn pair<'r, 'a>(&self, all: &'r [Required<'a>]) -> Option<(&'r Required<'a>, &'r Required<'a>)> {
        all.iter().enumerate().find_map(|(place, second)| {
            let first = all[..place].iter().find(|first| self.holds(&first.name, &second.name))?;
            Some((first, second))
        })
    }

    /// Reports intents that are required together and exclude each other: in one place, or by a reference or service of the composite and by what it
    /// promotes.
    pub(super) fn check(&self, composite: &Composite, diagnostics: &mut Diagnostics) {
        let document = &composite.document;
        let mut together: HashMap<_, Vec<Required<'_>>> = HashMap::new();
        for one in composite.outside.iter().filter(|one| one.kind == OutsideKind::Intent) {
            let at = document.element(one.element);
            let Some(name) = resolve(&one.name, at) else { continue };
            // What an element of this name lists is for the one around it.
            let of = if at.local_name() == "requires" { at.parent().unwrap_or(at) } else { at };
            together.entry(of.id()).or_default().push(Required { name, written: &one.name });
        }
        for all in together.values() {
            if let Some((first, second)) = self.pair(all) {
                let why = format!("{} excludes {}", quoted(second.written), quoted(first.written));
                report(second.written.location, why, first, ("ASM60010", composite.version), diagnostics);
            }
        }
        let promoting = composite.services.iter().filter_map(|one| {
            let promote = one.promote.as_deref().map(std::slice::from_ref)?;
            Some((one.policy().requires(), one.origin, promote, true))
        });
        let references = composite.references.iter();
        let references = references.map(|one| (one.policy().requires(), one.origin, one.promote(), false));
        for (requires, origin, promote, is_service) in promoting.chain(references) {
            let own = required(requires, origin.element(document));
            for end in promote {
                let Some((component, name)) = end.split_once('/') else { continue };
                let mut all = composite.components.iter();
                let Some(component) = all.find(|one| one.name.as_str() == component) else { continue };
                let theirs = if is_service {
                    let found = component.services.iter().find(|one| one.name.as_str() == name);
                    found.map(|one| required(one.policy().requires(), one.origin.element(document)))
                } else {
                    let found = component.references.iter().find(|one| one.name.as_str() == name);
                    found.map(|one| required(one.policy().requires(), one.origin.element(document)))
                };
                let theirs = theirs.unwrap_or_default();
                let both = own.iter().flat_map(|own| theirs.iter().map(move |their| (own, their)));
                if let Some((own, their)) =
                    both.into_iter().find(|(own, their)| self.holds(&own.name, &their.name))
                {
                    let why = format!(
                        "{} excludes {}, which {} requires",
                        quoted(own.written),
                        quoted(their.written),
                        quoted(end)
                    );
                    report(own.written.location, why, their, ("ASM60009", composite.version), diagnostics);
                }
            }
        }
    }
}

fn required<'a>(requires: &'a [Text], at: Element<'_>) -> Vec<Required<'a>> {
    requires.iter().filter_map(|written| Some(Required { name: resolve(written, at)?, written })).collect()
}

fn report(
    at: Location,
    why: String,
    other: &Required<'_>,
    (rule, version): (&'static str, Version),
    diagnostics: &mut Diagnostics,
) {
    let severity = if version.is_1_1() { Severity::Error } else { Severity::Warning };
    let one = Diagnostic::new(&codes::INTENTS_EXCLUDED, at, why).severity(severity).rule(rule);
    diagnostics.push(one.label(other.written.location, "the other one").help("remove one of them"));
}

/// Warns of a name in the namespace of SCA that is nearly that of one of its intents, unless a file declares it.
pub(super) fn misspelt(
    composite: &Composite,
    declared: impl Fn(&str) -> Option<BTreeSet<String>>,
    diagnostics: &mut Diagnostics,
) {
    for one in composite.outside.iter().filter(|one| one.kind == OutsideKind::Intent) {
        let at = composite.document.element(one.element);
        let Some((namespace, local)) = resolve(&one.name, at) else { continue };
        if Version::from_namespace(&namespace).is_none() {
            continue;
        }
        let base = local.split_once('.').map_or(local.as_str(), |(base, _)| base);
        let is_declared = declared(&namespace).is_some_and(|all| all.contains(&local) || all.contains(base));
        if STANDARD_INTENTS.contains(&base) || is_declared {
            continue;
        }
        if let Some(near) = nearest(base, STANDARD_INTENTS.iter().copied()) {
            let whole = one.name.replacen(base, near, 1);
            let message = format!("SCA has no intent {}", quoted(base));
            let diagnostic = Diagnostic::new(&codes::UNKNOWN_DECLARATION, one.name.location, message);
            let what = format!("replace {} with {}", quoted(base), quoted(near));
            diagnostics.push(diagnostic.suggest(what, one.name.location, whole));
        }
    }
}

/// What a QName means; `None` where its prefix is bound to nothing.
fn resolve(written: &str, at: Element<'_>) -> Option<Name> {
    let (prefix, local) = written.split_once(':').unwrap_or(("", written));
    let namespace = at.resolve_prefix(prefix);
    let namespace = if prefix.is_empty() { namespace.unwrap_or_default() } else { namespace? };
    Some((namespace.into_owned(), local.to_owned()))
}
