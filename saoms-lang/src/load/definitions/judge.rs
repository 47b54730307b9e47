//! Definitions held to each other.

use std::collections::{BTreeSet, HashMap};
use std::mem::{Discriminant, discriminant};

use super::{Declared, Definitions, Map, Name, Named, Qualifier, What};
use crate::diagnostic::{Code, Diagnostic, Diagnostics, Severity, codes, nearest, quoted};
use crate::load::extension::TUSCANY;
use crate::load::vocabulary::STANDARD_INTENTS;
use crate::model::{OutsideKind, Version};
use crate::source::{Location, Text};

/// Reports names that are given twice or named and not given, and what contradicts itself.
pub(super) fn check(all: &[Definitions], diagnostics: &mut Diagnostics) {
    let known = Known::of(all, diagnostics);
    for definitions in all {
        let mut judge = Judge { known: &known, version: definitions.version, diagnostics };
        for declared in &definitions.declared {
            match &declared.what {
                What::Intent { qualifiers, requires, excludes } => {
                    judge.qualifiers(declared, qualifiers);
                    judge.itself(declared, requires, "stands for");
                    judge.itself(declared, excludes, "excludes");
                }
                What::PolicySet { provides, references, maps } => {
                    judge.itself(declared, references, "takes over");
                    judge.references(declared, provides, references);
                    judge.maps(declared, provides, maps);
                }
                _ => {}
            }
        }
        definitions.named.iter().for_each(|named| judge.is_declared(named, &definitions.target));
    }
}

/// What files declare, by name.
struct Known<'a>(HashMap<(Discriminant<What>, &'a Name), &'a Declared>);

impl<'a> Known<'a> {
    /// Reports what is declared twice (SCA Assembly 1.1, ASM10001).
    fn of(all: &'a [Definitions], diagnostics: &mut Diagnostics) -> Self {
        let mut known: HashMap<(Discriminant<What>, &'a Name), &'a Declared> = HashMap::new();
        let all = all.iter().flat_map(|file| file.declared.iter().map(|one| (file.version, one)));
        for (version, declared) in all {
            let key = (discriminant(&declared.what), &declared.name);
            let Some(first) = known.get(&key) else {
                known.insert(key, declared);
                continue;
            };
            let what = declared.what.name();
            let message = format!("the {what} {} is declared twice", quoted(&declared.written));
            let one = Diagnostic::new(&codes::DECLARATION_REPEATED, declared.written.location, message);
            let severity = if version.is_1_1() { Severity::Error } else { Severity::Warning };
            let one = one.severity(severity).label(first.written.location, "the first");
            diagnostics.push(one.help("give each its own name, or remove one of them"));
        }
        Self(known)
    }

    fn intent(&self, name: &Name) -> Option<&'a Declared> {
        let intent = What::Intent { qualifiers: Vec::new(), requires: Vec::new(), excludes: Vec::new() };
        self.0.get(&(discriminant(&intent), name)).copied()
    }

    fn policy_set(&self, name: &Name) -> Option<&'a Declared> {
        let set = What::PolicySet { provides: Vec::new(), references: Vec::new(), maps: Vec::new() };
        self.0.get(&(discriminant(&set), name)).copied()
    }

    /// The local names of what is declared of a kind in a namespace.
    fn of_namespace(&self, kind: OutsideKind, namespace: &str) -> BTreeSet<&'a str> {
        let is_meant = |one: &&&Declared| match one.what {
            What::Intent { .. } => kind == OutsideKind::Intent,
            What::PolicySet { .. } => kind == OutsideKind::PolicySet,
            _ => false,
        };
        let all = self.0.values().filter(is_meant).filter(|one| one.name.0 == namespace);
        all.map(|one| one.name.1.as_str()).collect()
    }
}

struct Judge<'a, 'd> {
    known: &'a Known<'a>,
    version: Version,
    diagnostics: &'d mut Diagnostics,
}

impl Judge<'_, '_> {
    /// Tells a contradiction. SCA 1.0 has no rule for most.
    fn report(&mut self, at: Location, message: String, also: Option<(Location, &str)>, help: &str) {
        let severity = if self.version.is_1_1() { Severity::Error } else { Severity::Warning };
        let one = Diagnostic::new(&codes::POLICIES, at, message).severity(severity).help(help);
        self.diagnostics.push(match also {
            Some((at, what)) => one.label(at, what),
            None => one,
        });
    }

    /// The qualifiers of an intent: each has its own name, and of several one is the default (SCA Policy 1.1, 3.1).
    fn qualifiers(&mut self, declared: &Declared, qualifiers: &[Qualifier]) {
        self.repeated(qualifiers.iter().map(|one| &one.name), "the intent", &declared.written);
        let mut defaults = qualifiers.iter().filter(|one| one.is_default);
        match (defaults.next(), defaults.next()) {
            (Some(first), Some(second)) => {
                let message = format!("the intent {} has two default qualifiers", quoted(&declared.written));
                let also = Some((first.name.location, "the first"));
                self.report(
                    second.name.location,
                    message,
                    also,
                    "one of its qualifiers is meant where none is said",
                );
            }
            (None, _) if qualifiers.len() > 1 => {
                let message =
                    format!("no qualifier of the intent {} is the default", quoted(&declared.written));
                self.report(
                    declared.written.location,
                    message,
                    None,
                    "write `default=\"true\"` in one of them",
                );
            }
            _ => {}
        }
    }

    fn repeated<'t>(&mut self, names: impl Iterator<Item = &'t Text>, whose: &str, of: &Text) {
        let mut seen: HashMap<&str, Location> = HashMap::new();
        for name in names {
            match seen.get(name.as_str()) {
                Some(first) => {
                    let message = format!("{whose} {} has the qualifier {} twice", quoted(of), quoted(name));
                    self.report(name.location, message, Some((*first, "the first")), "remove one of them");
                }
                None => _ = seen.insert(name, name.location),
            }
        }
    }

    /// What names itself.
    fn itself(&mut self, declared: &Declared, named: &[Named], does: &str) {
        for one in named.iter().filter(|one| one.name.as_ref() == Some(&declared.name)) {
            let what = declared.what.name();
            let message = format!("the {what} {} {does} itself", quoted(&declared.written));
            self.report(one.written.location, message, None, "remove it");
        }
    }

    /// A policy set provides what those provide that it takes over (SCA Policy 1.1, 3.6).
    fn references(&mut self, declared: &Declared, provides: &[Named], references: &[Named]) {
        for reference in references {
            let found = reference.name.as_ref().and_then(|name| self.known.policy_set(name));
            let Some(What::PolicySet { provides: theirs, .. }) = found.map(|one| &one.what) else { continue };
            let own = |one: &Named| provides.iter().any(|own| own.name == one.name);
            let Some(lacking) = theirs.iter().find(|one| one.name.is_some() && !own(one)) else { continue };
            let message = format!(
                "the policy set {} takes over {}, and does not provide {}, as that does",
                quoted(&declared.written),
                quoted(&reference.written),
                quoted(&lacking.written)
            );
            let also = Some((lacking.written.location, "what that provides"));
            self.report(reference.written.location, message, also, "name it in `provides`");
        }
    }

    /// The maps of a policy set: each is for another intent that the set provides, and for all qualifiers of it (SCA Policy 1.1, 3.4).
    fn maps(&mut self, declared: &Declared, provides: &[Named], maps: &[Map]) {
        let mut seen: HashMap<&Name, Location> = HashMap::new();
        for map in maps {
            self.default(map);
            let Some(intent) = &map.provides else { continue };
            self.repeated(map.qualifiers.iter(), "the map of", &intent.written);
            let Some(name) = &intent.name else { continue };
            if let Some(first) = seen.insert(name, intent.written.location) {
                let message = format!(
                    "the policy set {} maps {} twice",
                    quoted(&declared.written),
                    quoted(&intent.written)
                );
                self.report(
                    intent.written.location,
                    message,
                    Some((first, "the first")),
                    "put all qualifiers into one map",
                );
            }
            if !provides.iter().any(|one| one.name.as_ref() == Some(name)) {
                let message = format!(
                    "the policy set {} maps {}, and does not provide it",
                    quoted(&declared.written),
                    quoted(&intent.written)
                );
                let names = provides.iter().map(|one| one.written.as_str());
                let help = match nearest(&intent.written, names) {
                    Some(near) => format!("it provides {}", quoted(near)),
                    None => "name the intent in its `provides`".to_owned(),
                };
                self.report(intent.written.location, message, None, &help);
            }
            self.mapped(map, intent, name);
        }
    }

    fn default(&mut self, map: &Map) {
        let Some(default) = &map.default else { return };
        if map.qualifiers.is_empty() || map.qualifiers.iter().any(|one| one.as_str() == default.as_str()) {
            return;
        }
        let message = format!("the map has no qualifier {}", quoted(default));
        let names: Vec<String> = map.qualifiers.iter().map(|one| quoted(one)).collect();
        self.report(default.location, message, None, &format!("it has {}", names.join(", ")));
    }

    /// Qualifiers in a map that are not those of the intent, where that says which it has.
    fn mapped(&mut self, map: &Map, intent: &Named, name: &Name) {
        let found = self.known.intent(name);
        let Some(What::Intent { qualifiers, .. }) = found.map(|one| &one.what) else { return };
        if qualifiers.is_empty() {
            return;
        }
        let names = || qualifiers.iter().map(|one| one.name.as_str());
        for own in map.qualifiers.iter().filter(|own| names().all(|name| name != own.as_str())) {
            let message = format!("the intent {} has no qualifier {}", quoted(&intent.written), quoted(own));
            let all: Vec<String> = names().map(quoted).collect();
            self.report(own.location, message, None, &format!("it has {}", all.join(", ")));
        }
        let is_mapped = |name: &&str| map.qualifiers.iter().any(|one| one.as_str() == *name);
        if let Some(lacking) = names().find(|name| !is_mapped(name)) {
            let message =
                format!("the map of {} lacks its qualifier {}", quoted(&intent.written), quoted(lacking));
            self.report(intent.written.location, message, None, "a map has all qualifiers of its intent");
        }
    }

    /// Warns of a name that nothing declares: near one that is there, or of the namespace of the file itself.
    fn is_declared(&mut self, named: &Named, target: &str) {
        let Some((namespace, local)) = &named.name else { return };
        let mut all = self.known.of_namespace(named.kind, namespace);
        let is_of_sca = Version::from_namespace(namespace).is_some();
        if is_of_sca && named.kind == OutsideKind::Intent {
            all.extend(STANDARD_INTENTS);
        }
        let (base, qualifier) =
            local.split_once('.').map_or((local.as_str(), None), |(base, rest)| (base, Some(rest)));
        if all.contains(local.as_str()) || all.contains(base) && qualifier.is_none() {
            return;
        }
        if all.contains(base) {
            let found = self.known.intent(&(namespace.clone(), base.to_owned())).map(|one| &one.what);
            let Some((What::Intent { qualifiers, .. }, rest)) = found.zip(qualifier) else { return };
            if qualifiers.is_empty() || qualifiers.iter().any(|one| one.name.as_str() == rest) {
                return;
            }
            let names: Vec<String> = qualifiers.iter().map(|one| quoted(&one.name)).collect();
            let message = format!("the intent {} has no qualifier {}", quoted(base), quoted(rest));
            let one = Diagnostic::new(UNKNOWN, named.written.location, message);
            return self.diagnostics.push(one.help(format!("it has {}", names.join(", "))));
        }
        let near = nearest(local, all.iter().copied());
        // What else a namespace has may be elsewhere, unless it is that of the file, which declares others; Tuscany comes with more.
        let is_own = namespace == target && !all.is_empty() && !TUSCANY.contains(&target);
        if near.is_none() && (is_of_sca || !is_own) {
            return;
        }
        let message = format!(
            "the contribution declares no {} {} in the namespace {}",
            named.kind.name(),
            quoted(local),
            quoted(namespace)
        );
        let one = Diagnostic::new(UNKNOWN, named.written.location, message);
        self.diagnostics.push(match near {
            Some(near) => {
                let prefix = named.written.strip_suffix(local.as_str()).unwrap_or_default();
                let what = format!("replace {} with {}", quoted(local), quoted(near));
                one.suggest(what, named.written.location, format!("{prefix}{near}"))
            }
            None => one.help("declare it, or let the files that declare it be in the contribution"),
        });
    }
}

const UNKNOWN: &Code = &codes::UNKNOWN_DECLARATION;
