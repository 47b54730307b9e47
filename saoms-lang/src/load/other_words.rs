//! Names of attributes in other languages, and in other elements.

use crate::diagnostic::{Diagnostic, Edit, quoted};
use crate::source::Span;
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

/// Help for an attribute that may be meant as a property of a component, or as a reference to another one.
pub(super) fn as_property(one: Diagnostic, element: Element<'_>, attribute: Attribute<'_>) -> Diagnostic {
    let (text, file) = (element.document().text(), element.document().file());
    let (start, end) = match element.local_name() {
        // However an empty one is written, there is nothing to do for it first.
        "component" if element.children().next().is_some() => (element.span().start, element.start_tag_span().end),
        "implementation.java" | "implementation.rust" => (element.span().start, element.span().end),
        _ => return one,
    };
    let line = text[..start as usize].rfind('\n').map_or(0, |at| at + 1);
    let indent = Some(&text[line..start as usize]).filter(|indent| indent.trim().is_empty());
    let deeper = if element.local_name() == "component" { "  " } else { "" };
    let gap = indent.map(|indent| format!("\n{indent}{deeper}")).unwrap_or_default();
    let prefix = element.prefix().map(|prefix| format!("{prefix}:")).unwrap_or_default();
    let (name, value) = (attribute.name(), attribute.raw_value());
    let target = attribute.trimmed();
    let target = target.split('/').next().unwrap_or_default();
    let is_named = |one: Element<'_>| one.attribute("name").is_some_and(|name| name.value().trim() == target);
    let is_reference = element.parent().is_some_and(|around| around.children().any(is_named));
    let has_class = || element.children().any(|child| child.local_name().starts_with("implementation."));
    let is_class = is_class_of_component(attribute) && !has_class();
    let (what, written) = match is_reference {
        _ if is_class => ("an implementation", format!("<{prefix}implementation.rust class=\"{value}\"/>")),
        true => ("a reference", format!("<{prefix}reference name=\"{name}\" target=\"{value}\"/>")),
        false => ("a property", format!("<{prefix}property name=\"{name}\">{value}</{prefix}property>")),
    };
    let before = text[..attribute.name_span().start as usize].trim_end().len() as u32;
    let whole = Span::new(before, attribute.value_span().end + 1).in_file(file);
    let remove = Edit { location: whole, replacement: String::new() };
    if let Some(given) = element.children().find(|child| child.local_name() == "property" && has_name(*child, name)) {
        let text = given.attribute("value").map(Attribute::trimmed).or_else(|| given.trimmed_text());
        return match text.is_some_and(|text| text.value == attribute.trimmed().value) {
            true => one.suggest_edits("remove it: the component has this property", vec![remove]),
            false => one.label(given.name_location(), "the property").help("keep one of the two, as a property"),
        };
    }
    let edits = vec![remove, Edit { location: Span::empty(end).in_file(file), replacement: format!("{gap}{written}") }];
    one.suggest_edits(format!("write it as {what}: {}", quoted(&written)), edits)
}

/// True if an element has this name.
fn has_name(element: Element<'_>, name: &str) -> bool {
    element.attribute("name").is_some_and(|given| given.value().trim() == name)
}
