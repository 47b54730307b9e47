//! What other files of a contribution declare that composites name: types and elements in schemas, interfaces in WSDL, intents and policy sets in
//! `definitions.xml` (SCA Assembly 1.1, 10.2 and 10.4).
//!
//! Such a file may be elsewhere, or come with the program that runs the composite. So a name is held only against files that declare others of its
//! namespace: those beside the composite, and those of a contribution that is described as such.

use std::collections::{BTreeSet, HashMap, HashSet};
use std::fs;
use std::path::{Path, PathBuf};
use std::rc::Rc;
use std::sync::Arc;

use super::definitions;
use super::intents::{self, Excluded};
use super::shelf::{Shelf, is_of_definitions};
use super::vocabulary::XML_SCHEMA;
use crate::diagnostic::{Diagnostic, Diagnostics, codes, nearest, quoted};
use crate::model::{Composite, OutsideKind, OutsideName, Version};
use crate::source::{FileId, OpenTexts, Sources, identity};
use crate::xml::{self, Element, escaped};

/// Files that are looked at, and the bytes of the largest: where there is more, nothing is held against them.
const MOST_FILES: usize = 300;
const LARGEST: u64 = 4_000_000;
/// Names that are shown in place of one that is not there.
const SHOWN: usize = 10;

const WSDL: [&str; 2] = ["http://schemas.xmlsoap.org/wsdl/", "http://www.w3.org/ns/wsdl"];

/// What the files around composites declare, looked at once each.
#[derive(Default)]
pub(super) struct Declared {
    /// By the folder of the composite.
    known: HashMap<PathBuf, Rc<Names>>,
    /// By the files that declare them: those of a contribution are the same for all its folders.
    of_files: HashMap<Rc<[PathBuf]>, Rc<Names>>,
    /// The files of definitions that were checked.
    checked: HashSet<PathBuf>,
}

/// Names by what they are of and their namespace.
#[derive(Default)]
struct Names {
    all: HashMap<(OutsideKind, String), BTreeSet<String>>,
    /// Namespaces of which more is elsewhere.
    open: HashSet<(OutsideKind, String)>,
    excluded: Excluded,
}

impl Declared {
    /// Checks files of definitions that belong together, those that were not checked before. Whether there was one.
    pub(super) fn definitions(
        &mut self,
        files: &[PathBuf],
        max_size: u64,
        sources: &mut Sources,
        diagnostics: &mut Diagnostics,
    ) -> bool {
        let new = files.iter().filter(|path| is_of_definitions(path) && self.checked.insert(identity(path)));
        let new: Vec<PathBuf> = new.cloned().collect();
        definitions::check(&new, max_size, sources, diagnostics)
    }

    /// Reports names of a composite in `folder` that are not among those of their namespace, and what is wrong with the definitions that are there.
    pub(super) fn check(
        &mut self,
        composite: &Composite,
        (folder, max_size): (&Path, u64),
        shelf: &mut Shelf,
        sources: &mut Sources,
        diagnostics: &mut Diagnostics,
    ) {
        if composite.outside.is_empty() {
            return;
        }
        if !self.known.contains_key(folder) {
            let files = shelf.declaring(folder);
            self.definitions(&files, max_size, sources, diagnostics);
            let open = sources.open();
            let made = self.of_files.entry(files);
            let made = made.or_insert_with_key(|files| Rc::new(Names::of(files, open).unwrap_or_default()));
            let made = Rc::clone(made);
            self.known.insert(folder.to_owned(), made);
        }
        let names = &self.known[folder];
        if composite.outside.iter().any(|one| one.kind == OutsideKind::Intent) {
            let declared =
                |namespace: &str| names.all.get(&(OutsideKind::Intent, namespace.to_owned())).cloned();
            intents::misspelt(composite, declared, diagnostics);
            names.excluded.check(composite, diagnostics);
        }
        for one in composite.outside.iter().filter(|_| !names.all.is_empty()) {
            let Some((namespace, kind, local)) = meant(one, composite) else { continue };
            let key = (kind, namespace);
            let Some(all) = names.all.get(&key).filter(|_| !names.open.contains(&key)) else { continue };
            // A qualified intent, as `confidentiality.message`, is one of its kind.
            let is_known = |name: &str| all.contains(name);
            if is_known(&local) || local.split_once('.').is_some_and(|(base, _)| is_known(base)) {
                continue;
            }
            if let Some(one) = unknown(one, &key, &local, all) {
                diagnostics.push(one);
            }
        }
    }
}

/// The namespace, the kind and the local part of a name; `None` where they are not said, or of SCA and XML Schema themselves.
fn meant(one: &OutsideName, composite: &Composite) -> Option<(String, OutsideKind, String)> {
    if one.kind == OutsideKind::Wsdl {
        let (namespace, fragment) = one.name.split_once("#wsdl.")?;
        let (what, rest) = fragment.split_once('(')?;
        let local = rest.strip_suffix(')')?;
        let kind = match &*what.to_ascii_lowercase() {
            "interface" | "porttype" => OutsideKind::Wsdl,
            "binding" => OutsideKind::WsdlBinding,
            "service" => OutsideKind::WsdlService,
            "port" | "endpoint" => OutsideKind::WsdlPort,
            _ => return None,
        };
        return Some((namespace.to_owned(), kind, local.to_owned()));
    }
    let (prefix, local) = one.name.split_once(':')?;
    let namespace = composite.document.element(one.element).resolve_prefix(prefix)?;
    let is_own = Version::from_namespace(&namespace).is_some() || namespace == XML_SCHEMA;
    (!is_own).then(|| (namespace.into_owned(), one.kind, local.to_owned()))
}

/// What to say of a name; nothing of an intent or a policy set like no other: it may come with the program that runs the composite.
fn unknown(
    one: &OutsideName,
    (kind, namespace): &(OutsideKind, String),
    local: &str,
    all: &BTreeSet<String>,
) -> Option<Diagnostic> {
    let near = nearest(local, all.iter().map(String::as_str));
    if near.is_none() && matches!(kind, OutsideKind::Intent | OutsideKind::PolicySet) {
        return None;
    }
    let message = format!(
        "the contribution declares no {} {} in the namespace {}",
        kind.name(),
        quoted(local),
        quoted(namespace)
    );
    let diagnostic = Diagnostic::new(&codes::UNKNOWN_DECLARATION, one.name.location, message);
    Some(match near {
        Some(near) => {
            let whole = match kind {
                OutsideKind::Intent | OutsideKind::PolicySet | OutsideKind::Type | OutsideKind::Element => {
                    let prefix = one.name.strip_suffix(local).unwrap_or_default();
                    format!("{prefix}{near}")
                }
                _ => one.name.replace(&format!("({local})"), &format!("({near})")),
            };
            let what = format!("replace {} with {}", quoted(local), quoted(near));
            diagnostic.suggest(what, one.name.location, escaped(&whole))
        }
        None => {
            let shown: Vec<String> = all.iter().take(SHOWN).map(|name| quoted(name)).collect();
            let more =
                if all.len() > SHOWN { format!(" and {} more", all.len() - SHOWN) } else { String::new() };
            diagnostic.help(format!("it declares {}{more}", shown.join(", ")))
        }
    })
}

impl Names {
    /// What files declare; `None` where one of them cannot be read, and nobody knows what it would declare.
    fn of(files: &[PathBuf], open: &OpenTexts) -> Option<Self> {
        if files.len() > MOST_FILES {
            return None;
        }
        let mut names = Self::default();
        for path in files {
            let text = match open.get(path) {
                Some(text) => text.to_string(),
                None => {
                    let about = fs::metadata(path).ok()?;
                    (about.is_file() && about.len() <= LARGEST).then_some(())?;
                    fs::read_to_string(path).ok()?
                }
            };
            let parsed = xml::parse(FileId(0), &Arc::new(text));
            let document = parsed.document.filter(|_| parsed.fault.is_none())?;
            names.add(document.root());
        }
        Some(names)
    }

    fn add(&mut self, root: Element<'_>) {
        let target =
            root.attribute("targetNamespace").map_or_else(String::new, |one| one.trimmed().to_string());
        let (namespace, name) = (root.namespace(), root.local_name());
        if namespace == XML_SCHEMA && name == "schema" {
            self.schema(root, &target);
        } else if WSDL.contains(&namespace) {
            self.wsdl(root, &target);
        } else if definitions::is_of_policies(root) {
            self.definitions(root, &target);
        }
    }

    fn insert(&mut self, kind: OutsideKind, target: &str, name: String) {
        self.all.entry((kind, target.to_owned())).or_default().insert(name);
    }

    /// The names of the children of this name.
    fn children(&mut self, root: Element<'_>, child: &str, kind: OutsideKind, target: &str) {
        for one in root.children().filter(|one| one.local_name() == child) {
            if let Some(name) = one.attribute("name") {
                let name = name.trimmed();
                // Some write their own prefix before it.
                self.insert(kind, target, name.rsplit(':').next().unwrap_or(&name).to_owned());
            }
        }
    }

    fn schema(&mut self, root: Element<'_>, target: &str) {
        for (child, kind) in [
            ("complexType", OutsideKind::Type),
            ("simpleType", OutsideKind::Type),
            ("element", OutsideKind::Element),
        ] {
            self.children(root, child, kind, target);
        }
        if root.children().any(|one| matches!(one.local_name(), "include" | "redefine" | "override")) {
            self.open.extend([OutsideKind::Type, OutsideKind::Element].map(|kind| (kind, target.to_owned())));
        }
    }

    fn wsdl(&mut self, root: Element<'_>, target: &str) {
        for (child, kind) in [
            ("portType", OutsideKind::Wsdl),
            ("interface", OutsideKind::Wsdl),
            ("binding", OutsideKind::WsdlBinding),
            ("service", OutsideKind::WsdlService),
        ] {
            self.children(root, child, kind, target);
        }
        for service in root.children().filter(|one| one.local_name() == "service") {
            let Some(name) = service.attribute("name").map(|one| one.trimmed()) else { continue };
            for port in service.children().filter(|one| matches!(one.local_name(), "port" | "endpoint")) {
                if let Some(port) = port.attribute("name") {
                    self.insert(OutsideKind::WsdlPort, target, format!("{name}/{}", port.trimmed().as_str()));
                }
            }
        }
        let is_of_target = |one: &Element<'_>| {
            let of = one.attribute("namespace").map(|of| of.trimmed());
            one.local_name() == "include"
                || one.local_name() == "import" && of.is_none_or(|of| of.as_str() == target)
        };
        if root.children().any(|one| is_of_target(&one)) {
            self.open.extend(OutsideKind::OF_WSDL.map(|kind| (kind, target.to_owned())));
        }
        for schema in
            root.descendants().filter(|one| one.namespace() == XML_SCHEMA && one.local_name() == "schema")
        {
            let target =
                schema.attribute("targetNamespace").map_or_else(String::new, |one| one.trimmed().to_string());
            self.schema(schema, &target);
        }
    }

    fn definitions(&mut self, root: Element<'_>, target: &str) {
        self.children(root, "intent", OutsideKind::Intent, target);
        self.children(root, "policySet", OutsideKind::PolicySet, target);
        for intent in root.children().filter(|one| one.local_name() == "intent") {
            if let Some(name) = intent.attribute("name").map(|one| one.trimmed()) {
                let local = name.rsplit(':').next().unwrap_or(&name).to_owned();
                self.excluded.add(&(target.to_owned(), local), intent);
            }
        }
    }
}
