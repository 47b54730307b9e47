//! Damage: where faults of the XML may hide parts of the model.

use crate::diagnostic::{Diagnostics, HiddenNames};
use crate::syntax::{Attribute, Document, Element, ElementId};

/// Marks the children of the root with something damaged inside, or the whole file, in the diagnostics.
pub(super) fn add(document: &Document, diagnostics: &mut Diagnostics) {
    let root = document.root();
    if root.is_damaged() {
        return diagnostics.add_damage(root.span().in_file(document.file()), HiddenNames::ALL);
    }
    for part in root.children() {
        let mut damaged = part.descendants().filter(|one| one.is_damaged()).peekable();
        if damaged.peek().is_some() {
            let others = damaged.any(has_names);
            let hidden = HiddenNames { composites: false, components: others && may_hide_component(part), others };
            diagnostics.add_damage(part.span().in_file(document.file()), hidden);
        }
    }
}

/// True if a name that others refer to may be missing: of a property of the composite its own, of a component those in
/// it.
fn has_names(element: Element<'_>) -> bool {
    match element.local_name() {
        "property" => element.has_damaged_tag() && element.parent().is_some_and(|one| one.id() == ElementId::ROOT),
        "value" | "documentation" => false,
        // Only its own name is in doubt, which is no other one.
        "component" if !element.has_damaged_content() && names(element).nth(1).is_some() => false,
        name => !name.contains('.'),
    }
}

/// True if a child of the root with something damaged inside may be, or hold, a component with an unknown name.
fn may_hide_component(part: Element<'_>) -> bool {
    let is_known = match part.local_name() {
        "component" => has_readable_name(part),
        "property" | "service" | "reference" | "wire" => true,
        _ => false,
    };
    let is_component = |one: Element<'_>| one.is_unnamed() || one.local_name() == "component";
    !is_known || part.is_unnamed() || part.descendants().skip(1).any(is_component)
}

/// True if the names of a component are read as they were meant, whatever else is wrong with the tag: they end with
/// their quotes.
fn has_readable_name(component: Element<'_>) -> bool {
    let text = component.document().text();
    let ends = |name: Attribute<'_>| {
        let behind = &text[name.span().end as usize..];
        name.is_closed() && behind.starts_with([' ', '\t', '\r', '\n', '/', '>'])
    };
    component.attribute("name").is_some() && names(component).all(ends)
}

/// All that it gives as its name.
fn names(element: Element<'_>) -> impl Iterator<Item = Attribute<'_>> {
    element.written_attributes().filter(|one| one.name() == "name")
}
