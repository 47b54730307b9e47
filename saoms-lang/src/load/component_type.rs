//! Component types: the files beside implementations.

use std::sync::Arc;

use super::children::{Family, is_defined};
use super::root::of_another_kind;
use super::vocabulary::{COMPONENT_REFERENCE, COMPONENT_SERVICE, COMPONENT_TYPE, COMPOSITE_PROPERTY};
use super::{Loader, push_faults};
use crate::diagnostic::Diagnostics;
use crate::model::{ComponentType, Origin, Version};
use crate::source::{FileId, Sources};
use crate::syntax::{self, Parse};

/// Makes the model of a component type that was read before. `None` when its root is no `componentType` of SCA, or when
/// the text is no well-formed XML: what can be read is judged, and what is missing may be there.
pub fn load_component_type(file: FileId, sources: &Sources, diagnostics: &mut Diagnostics) -> Option<ComponentType> {
    let Parse { document, faults } = syntax::parse(file, sources.get(file).text());
    let document = Arc::new(document);
    let root = document.root();
    let version = Version::from_namespace(root.namespace());
    let Some(version) = version.filter(|_| root.local_name() == COMPONENT_TYPE.name) else {
        let help = "a file of this name describes the implementation of the same name";
        of_another_kind(root, COMPONENT_TYPE.name, help, faults, diagnostics);
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
    loader.children(root, &COMPONENT_TYPE, |loader, child, family, name| {
        match (family, name) {
            (Family::Sca, "service") => made.services.push(loader.service(child, &COMPONENT_SERVICE)),
            (Family::Sca, "reference") => made.references.push(loader.reference(child, &COMPONENT_REFERENCE)),
            (Family::Sca, "property") => made.properties.push(loader.property(child, &COMPOSITE_PROPERTY)),
            // What else a component type can say is for the containers of other languages.
            (Family::Sca, name) => return name.starts_with("implementation.") && is_defined(child),
            _ => return false,
        }
        true
    });
    let is_whole = faults.is_empty();
    push_faults(faults, sources, diagnostics);
    is_whole.then_some(made)
}
