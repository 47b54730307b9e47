//! Names of attributes in other languages, and in other elements.

use crate::diagnostic::quoted;
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
        ("reference", "target") => {
            matches!(written, "to" | "value" | "ref" | "component" | "href" | "promote" | "service" | "source")
        }
        ("deployable", "composite") => matches!(written, "name" | "file" | "ref"),
        _ => false,
    }
}

/// True if an attribute of a component means the class that its implementation names.
pub(super) fn is_class_beside_implementation(element: Element<'_>, attribute: Attribute<'_>) -> bool {
    is_class(element, attribute) && element.children().any(is_implementation)
}

/// True if an attribute of a component without an implementation names a class.
pub(super) fn is_class_without_implementation(element: Element<'_>, attribute: Attribute<'_>) -> bool {
    is_class(element, attribute) && !element.children().any(is_implementation)
}

fn is_class(element: Element<'_>, attribute: Attribute<'_>) -> bool {
    let name = attribute.name().to_ascii_lowercase();
    element.local_name() == "component" && ["class", "clas", "classname", "cls"].contains(&name.as_str())
}

fn is_implementation(child: Element<'_>) -> bool {
    child.local_name().starts_with("implementation.")
}

/// True if an attribute of a component seems to name its class.
pub(super) fn is_class_of_component(attribute: Attribute<'_>) -> bool {
    matches!(attribute.name(), "class" | "type" | "implementation") && attribute.value().contains('.')
}

/// Help for an attribute that seems to be meant for one that the element has.
pub(super) fn given_already(name: &str) -> String {
    format!("{} is given already: remove one of the two", quoted(name))
}
