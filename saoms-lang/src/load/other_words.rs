//! Names of attributes in other languages, and in other elements.

use crate::syntax::{Attribute, Element};

/// True if others call an attribute of such an element by this name: their files name a class or another file in their
/// own words.
pub(super) fn is_word_for(written: &str, known: &str, element: Element<'_>) -> bool {
    match (element.local_name(), known) {
        ("include" | "implementation.composite", "name") => {
            matches!(written, "file" | "href" | "src" | "ref" | "location" | "composite" | "class")
        }
        ("component" | "composite", "name") => written == "id",
        ("implementation.java" | "implementation.rust", "class") => matches!(written, "name" | "type"),
        // In a component it may be the property that is called so, but where another attribute gives the value.
        ("property", "name") => {
            let is_of_composite = element.parent().is_some_and(|around| around.parent().is_none());
            matches!(written, "id" | "key") && (is_of_composite || element.attribute("value").is_some())
        }
        ("property", "file") => matches!(written, "src" | "href" | "path"),
        ("service", "promote") => written == "target",
        ("property", "value") => matches!(written, "val" | "default"),
        ("wire", "source") => matches!(written, "from" | "src"),
        ("wire", "target") => matches!(written, "to" | "dest" | "destination"),
        ("reference", "target") => matches!(written, "to" | "value" | "ref" | "component" | "href" | "promote"),
        ("deployable", "composite") => matches!(written, "name" | "file" | "ref"),
        _ => false,
    }
}

/// True if an attribute of a component means the class that its implementation names.
pub(super) fn is_class_beside_implementation(element: Element<'_>, attribute: Attribute<'_>) -> bool {
    let is_class = ["class", "clas", "classname", "cls"].contains(&attribute.name().to_ascii_lowercase().as_str());
    let mut children = element.children();
    is_class
        && element.local_name() == "component"
        && children.any(|one| one.local_name().starts_with("implementation."))
}
