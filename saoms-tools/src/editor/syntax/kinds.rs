//! The kinds of elements, by their names and parents.

use saoms_lang::load::vocabulary::{COMPOSITE, CONTRIBUTION, Kind, LOOP, OWN_ELEMENTS, SEVERITY};
use saoms_lang::model::{SAOMS_NAMESPACE, Version};
use saoms_lang::syntax::{Document, Element};

/// The version of SCA that the root is of; 1.1 while it says none.
pub(crate) fn version(document: &Document) -> Version {
    Version::from_namespace(document.root().namespace()).unwrap_or(Version::Oasis200912)
}

/// The kind of each element.
pub(crate) fn kinds(document: &Document) -> Vec<Option<&'static Kind>> {
    let mut kinds: Vec<Option<&'static Kind>> = Vec::new();
    for element in document.elements() {
        kinds.push(match element.parent() {
            Some(parent) => kinds[parent.id().0 as usize].and_then(|parent| kind_in(parent, element)),
            None => [&COMPOSITE, &CONTRIBUTION].into_iter().find(|kind| element.local_name() == kind.name),
        });
    }
    kinds
}

/// The kind of an element in a parent of a kind. While the namespace is missing, names with the namespace or the prefix
/// of the root are of SCA.
fn kind_in(parent: &'static Kind, element: Element<'_>) -> Option<&'static Kind> {
    let (name, namespace) = (element.local_name(), element.namespace());
    if namespace == SAOMS_NAMESPACE {
        return match name {
            _ if name == LOOP.name => Some(&LOOP),
            _ if name == SEVERITY.name => Some(&SEVERITY),
            _ => parent.child(name).filter(|_| OWN_ELEMENTS.contains(&name)),
        };
    }
    let root = element.document().root();
    let is_of_root = namespace == root.namespace() || element.prefix() == root.prefix();
    let is_of_sca = is_of_root || Version::from_namespace(namespace).is_some();
    is_of_sca.then(|| parent.child(name))?
}
