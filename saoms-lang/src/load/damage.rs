//! Damage: where faults of the XML may hide parts of the model.

use crate::diagnostic::Diagnostics;
use crate::syntax::{Document, Element, ElementId};

/// Marks the children of the root with something damaged inside, or the whole file, in the diagnostics.
pub(super) fn add(document: &Document, diagnostics: &mut Diagnostics) {
    let root = document.root();
    if root.is_damaged() {
        return diagnostics.add_damage(root.span().in_file(document.file()), true);
    }
    for part in root.children() {
        let mut damaged = part.descendants().filter(|one| one.is_damaged()).peekable();
        if damaged.peek().is_some() {
            diagnostics.add_damage(part.span().in_file(document.file()), damaged.any(has_names));
        }
    }
}

/// True if a name that others refer to may be missing: of a property of the composite its own, of a component those in it.
fn has_names(element: Element<'_>) -> bool {
    match element.local_name() {
        "property" => {
            element.has_damaged_tag() && element.parent().is_some_and(|one| one.id() == ElementId::ROOT)
        }
        "value" | "documentation" => false,
        name => !name.contains('.'),
    }
}
