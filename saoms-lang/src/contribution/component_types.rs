//! The files of component types beside implementations.

use std::path::{Path, PathBuf};

use crate::model::{ComponentElement, Composite, ImplementationKind};

/// The ending of their names.
const ENDING: &str = "componentType";

/// The files that may describe the implementation of a component, the likeliest first, as paths in the contribution.
pub(super) fn paths(component: &ComponentElement, composite: &Composite) -> Vec<PathBuf> {
    let Some(implementation) = &component.implementation else { return Vec::new() };
    let attribute = |name| {
        let element = implementation.origin.element(&composite.document);
        element.attribute(name).map(|attribute| attribute.trimmed().as_str().to_owned())
    };
    let named = match &implementation.kind {
        ImplementationKind::Java { class } | ImplementationKind::Rust { class, .. } => {
            class.iter().map(|class| class.replace('.', "/")).collect()
        }
        // It declares itself.
        ImplementationKind::Composite { .. } | ImplementationKind::Python(_) => Vec::new(),
        ImplementationKind::Other { kind, .. } => {
            let names: &[&str] = match kind.as_str() {
                "script" | "python" => &["script"],
                "osgi" => &["bundle", "bundleSymbolicName"],
                "xquery" | "spring" | "widget" => &["location"],
                _ => &[],
            };
            let mut named: Vec<String> = names.iter().filter_map(|name| attribute(name)).collect();
            // A bundle with several versions has one description for each: `CustomerV2`.
            let version = attribute("bundleVersion").and_then(|version| Some(version.split('.').next()?.to_owned()));
            if let (Some(bundle), Some(version)) = (attribute("bundle"), version) {
                named.push(format!("{bundle}V{version}"));
            }
            named
        }
    };
    let is_plain = |name: &String| {
        !name.is_empty() && Path::new(name).components().all(|part| matches!(part, std::path::Component::Normal(_)))
    };
    let of_script = |name: String| {
        let path = PathBuf::from(&name);
        let has_ending = matches!(implementation.kind, ImplementationKind::Other { .. }) && name.contains('/')
            || path.extension().is_some_and(|ending| ending.len() <= 6 && !name.contains('/'));
        if has_ending { path.with_extension(ENDING) } else { PathBuf::from(format!("{name}.{ENDING}")) }
    };
    named.into_iter().filter(is_plain).map(of_script).collect()
}
