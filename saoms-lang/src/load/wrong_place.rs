//! Elements in a form or a place that other languages have: wrappers around a list, properties that are elements of
//! their own, and parts of a component that are inside another part of it.

use super::Loader;
use super::children::is_known;
use super::vocabulary::{self, COMPONENT, COMPOSITE, Kind};
use crate::diagnostic::{Diagnostic, Edit, HiddenNames, codes, quoted};
use crate::source::Span;
use crate::syntax::Element;

impl Loader<'_> {
    /// Reports a wrapper around elements that belong in the element around it, such as `<properties>`. True if it is
    /// one: what is in it counts then.
    pub(super) fn is_wrapper(&mut self, element: Element<'_>, parent: &'static Kind) -> bool {
        let name = element.local_name();
        let is_of_list = |known: &str| {
            name == format!("{known}s") || known.strip_suffix('y').is_some_and(|stem| name == format!("{stem}ies"))
        };
        let is_plural = vocabulary::children(parent).any(is_of_list);
        let is_part = |child: Element<'_>| vocabulary::children(parent).any(|known| known == child.local_name());
        if !is_plural
            || element.attributes().next().is_some()
            || element.children().next().is_none()
            || !element.children().all(is_part)
        {
            return false;
        }
        let message = format!("{} has no element {}", self.version.label(), quoted(name));
        let one = Diagnostic::new(&codes::UNKNOWN_ELEMENT, element.name_location(), message);
        let file = element.document().file();
        let tags = [Some(element.start_tag_span()), element.end_tag_span()];
        let edits = tags.into_iter().flatten();
        let edits = edits.map(|tag| Edit { location: tag.in_file(file), replacement: String::new() }).collect();
        let description = format!("remove its start tag and end tag: its content belongs in {}", quoted(parent.name));
        self.report(one.suggest_edits(description, edits));
        true
    }

    /// Notes that components may be missing, since an element that brings them is not read, as is reported.
    pub(super) fn hide_components(&mut self, element: Element<'_>) {
        let hidden = HiddenNames { composites: false, components: true, others: true };
        self.diagnostics.add_damage(element.span().in_file(element.document().file()), hidden);
    }
}

/// The place of an element that is inside another one: outside of it, where that can be.
pub(super) fn belongs_outside(name: &str, parent: &Kind) -> Option<String> {
    let holds = |kind: &'static Kind| vocabulary::children(kind).any(|known| known == name);
    let around = match parent.name {
        inner if inner.starts_with("implementation.") && holds(&COMPONENT) => "component",
        "component" if holds(&COMPOSITE) => "composite",
        _ => return None,
    };
    Some(format!("move it out of {}: it belongs in the {around}", quoted(parent.name)))
}

/// An element in a component that is to be a property of its name, with what makes it one.
pub(super) fn as_property(one: Diagnostic, element: Element<'_>) -> Diagnostic {
    let (name, document) = (element.local_name(), element.document());
    let is_plain = element.attributes().next().is_none() && element.children().next().is_none();
    let (Some(text), Some(end), true) = (element.trimmed_text(), element.end_tag_span(), is_plain && !is_known(name))
    else {
        return one;
    };
    let prefix = element.prefix().map(|prefix| format!("{prefix}:")).unwrap_or_default();
    let (file, start) = (document.file(), element.start_tag_span());
    let edit = |span: Span, replacement: String| Edit { location: span.in_file(file), replacement };
    let edits =
        vec![edit(start, format!("<{prefix}property name=\"{name}\">")), edit(end, format!("</{prefix}property>"))];
    let written = format!("<{prefix}property name=\"{name}\">{}</{prefix}property>", text.value);
    one.suggest_edits(format!("write it as a property: {}", quoted(&written)), edits)
}

/// True if an element of a component gives its property of this name in another form, which is reported: as an element,
/// inside the implementation, or as a tag without its `<`.
pub(crate) fn is_given_otherwise(component: Element<'_>, name: &str) -> bool {
    let is_property = |one: Element<'_>| {
        let is_named = one.attribute("name").is_some_and(|given| given.value().trim() == name);
        is_named && matches!(one.local_name(), "property" | "reference" | "service")
    };
    let is_inside = |child: Element<'_>| {
        let is_part = !matches!(child.local_name(), "property" | "service" | "reference" | "loop");
        is_part && child.descendants().skip(1).any(is_property)
    };
    let is_it =
        |child: Element<'_>| child.local_name() == name || child.local_name() != "property" && is_property(child);
    let in_text = || {
        let text = component.text_span().map(|span| component.document().piece(span)).unwrap_or_default();
        [format!("name=\"{name}\""), format!("name='{name}'")].iter().any(|written| text.contains(written))
    };
    component.children().any(|child| is_it(child) || is_inside(child)) || in_text()
}

/// A text between elements that is a tag without its `<`, with what mends it.
pub(super) fn as_tag(one: Diagnostic, element: Element<'_>, span: Span, kinds: &[&str]) -> Option<Diagnostic> {
    let text = element.document().piece(span);
    let name =
        kinds.iter().find(|kind| text.strip_prefix(**kind).is_some_and(|rest| rest.starts_with([' ', '\t', '\n'])))?;
    let is_tag = text.trim_end().ends_with("/>") && text.contains('=') && !text.contains('<');
    let place = Span::empty(span.start).in_file(element.document().file());
    is_tag.then(|| one.suggest(format!("insert `<` before {}", quoted(name)), place, "<"))
}
