//! Component types: the files beside implementations.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::Loader;
use super::children::{Family, meant_name};
use super::root::of_another_kind;
use super::vocabulary::{self, COMPONENT_REFERENCE, COMPONENT_SERVICE, COMPONENT_TYPE, COMPOSITE_PROPERTY};
use crate::diagnostic::Diagnostics;
use crate::model::{Component, ComponentType, Composite, ImplementationKind, Origin, Version};
use crate::source::{FileId, Sources};
use crate::xml;

/// The ending of their names.
const ENDING: &str = "componentType";

/// Entries of a folder beyond which it is not looked through.
const MOST_ENTRIES: usize = 10_000;

/// Whether a folder may hold component types. Most hold none, or are not there: then nobody has to ask for one by each name.
pub(super) fn any_in(folder: &Path) -> bool {
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let Ok(entries) = folder.read_dir() else { return folder.is_dir() };
    let has_ending = |name: &Path| name.extension().is_some_and(|ending| ending == ENDING);
    let mut seen = 0;
    let found = entries.take(MOST_ENTRIES).any(|entry| {
        seen += 1;
        entry.is_ok_and(|entry| has_ending(Path::new(&entry.file_name())))
    });
    found || seen == MOST_ENTRIES
}

/// Makes the model of a component type that was read before. `None` when the text is no well-formed XML with a `componentType` of SCA as its
/// root.
pub fn load_component_type(
    file: FileId,
    sources: &Sources,
    diagnostics: &mut Diagnostics,
) -> Option<ComponentType> {
    let xml::Parsed { document, fault, .. } = xml::parse(file, sources.get(file).text());
    if let Some(fault) = fault {
        diagnostics.push(fault);
        return None;
    }
    let document = Arc::new(document?);
    let root = document.root();
    let version = Version::from_namespace(root.namespace());
    let Some(version) = version.filter(|_| root.local_name() == ENDING) else {
        let help = "a file of this name describes the implementation of the same name";
        diagnostics.push(of_another_kind(root, ENDING, help));
        return None;
    };
    let mut loader = Loader::new(version, root.namespace(), diagnostics);
    let mut made = ComponentType {
        origin: Origin::of(root),
        document: Arc::clone(&document),
        version,
        services: Vec::new(),
        references: Vec::new(),
        properties: Vec::new(),
    };
    loader.check_attributes(root, &COMPONENT_TYPE);
    loader.no_text(root);
    for child in root.children() {
        let family = loader.family(child);
        match (family, meant_name(child)) {
            (Family::Sca, "service") => made.services.push(loader.service(child, &COMPONENT_SERVICE)),
            (Family::Sca, "reference") => made.references.push(loader.reference(child, &COMPONENT_REFERENCE)),
            (Family::Sca, "property") => made.properties.push(loader.property(child, &COMPOSITE_PROPERTY)),
            (Family::Sca, "requires" | "policySetAttachment" | "documentation" | "extensions") => {
                loader.beside(child);
            }
            // What else a component type can say is for the containers of other languages.
            (Family::Sca, name) if vocabulary::children(&COMPONENT_TYPE).any(|known| known == name) => {}
            (Family::Sca | Family::Own, _) => _ = loader.unexpected(child, &COMPONENT_TYPE, family),
            _ => {}
        }
    }
    Some(made)
}

/// The files that may describe the implementation of a component, the likeliest first, as paths in the contribution.
pub(super) fn paths(component: &Component, composite: &Composite) -> Vec<PathBuf> {
    let Some(implementation) = &component.implementation else { return Vec::new() };
    let attribute = |name| {
        let element = implementation.origin.element(&composite.document);
        element.attribute(name).map(|attribute| attribute.trimmed().as_str().to_owned())
    };
    let named = match &implementation.kind {
        ImplementationKind::Java { class } | ImplementationKind::Rust { class, .. } => {
            class.iter().map(|class| class.replace('.', "/")).collect()
        }
        ImplementationKind::Composite { .. } => Vec::new(),
        ImplementationKind::Other { kind, .. } => {
            let names: &[&str] = match kind.as_str() {
                "script" | "python" => &["script"],
                "osgi" => &["bundle", "bundleSymbolicName"],
                "xquery" | "spring" | "widget" => &["location"],
                _ => &[],
            };
            let mut named: Vec<String> = names.iter().filter_map(|name| attribute(name)).collect();
            // A bundle of which there are several versions has one description for each: `CustomerV2`.
            let version =
                attribute("bundleVersion").and_then(|version| Some(version.split('.').next()?.to_owned()));
            if let (Some(bundle), Some(version)) = (attribute("bundle"), version) {
                named.push(format!("{bundle}V{version}"));
            }
            named
        }
    };
    let is_plain = |name: &String| {
        !name.is_empty()
            && Path::new(name).components().all(|part| matches!(part, std::path::Component::Normal(_)))
    };
    let of_script = |name: String| {
        let path = PathBuf::from(&name);
        let has_ending = matches!(implementation.kind, ImplementationKind::Other { .. })
            && name.contains('/')
            || path.extension().is_some_and(|ending| ending.len() <= 6 && !name.contains('/'));
        if has_ending { path.with_extension(ENDING) } else { PathBuf::from(format!("{name}.{ENDING}")) }
    };
    named.into_iter().filter(is_plain).map(of_script).collect()
}
