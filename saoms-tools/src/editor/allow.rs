//! Saying in a composite that what a diagnostic finds is no fault there.

use saoms_lang::load::vocabulary::{SEVERITY, SEVERITY_PARENTS};
use saoms_lang::model::SAOMS_NAMESPACE;
use saoms_lang::syntax::Element;

use super::FileEdit;
use super::scene::Scene;
use super::syntax::{Places, bytes, root};

/// Edits that allow a code in one part of a composite.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Allowance {
    /// The title of the action.
    pub(super) title: String,
    /// The edits of the file.
    pub(super) edits: Vec<FileEdit>,
}

/// The ways to allow a code at a byte of the first file: for the component, service, reference, wire or include there,
/// and for the whole composite. The reason stays empty: the checker asks for it until somebody writes it.
pub(super) fn allowances(scene: &Scene, at: usize, code: &str) -> Vec<Allowance> {
    let file = scene.file();
    let mut found = Vec::new();
    // The place of a diagnostic may be the first byte of an element.
    let mut here = file.document.innermost(at as u32 + 1).or_else(|| file.document.innermost(at as u32));
    while let Some(element) = here {
        let is_holder = file.kind(element.id()).is_some_and(|kind| SEVERITY_PARENTS.contains(&kind.name));
        let is_whole = element.parent().is_none();
        // Of the elements around it, the innermost one and the root.
        if is_holder && element.has_whole_start_tag() && (found.is_empty() || is_whole) {
            if is_set(element, code) {
                return Vec::new();
            }
            let name = element.value("name").map_or("", |at| &file.text[at]);
            let what = match element.local_name() {
                _ if is_whole => "in this composite".to_owned(),
                kind if name.is_empty() => format!("in this {kind}"),
                kind => format!("in {kind} `{name}`"),
            };
            let title = format!("Allow {code} {what}, with a reason");
            found.push(Allowance { title, edits: inserted(element, code) });
        }
        here = element.parent();
    }
    found
}

/// True if an element says something about a code already.
fn is_set(element: Element<'_>, code: &str) -> bool {
    let mut inside = element.children().filter(|child| child.local_name() == SEVERITY.name);
    inside.any(|child| child.attribute("code").is_some_and(|said| said.trimmed() == code))
}

fn inserted(element: Element<'_>, code: &str) -> Vec<FileEdit> {
    let text = element.document().text().as_str();
    let (tag, name) = (element.tag(), element.name());
    let bound = element.prefix_of(SAOMS_NAMESPACE).filter(|prefix| !prefix.is_empty());
    let prefix = bound.unwrap_or("saoms");
    let said = format!("<{prefix}:{} code=\"{code}\" level=\"allow\" reason=\"\"/>", SEVERITY.name);
    let line = text[..tag.start].rfind('\n').map_or(0, |found| found + 1);
    let before = &text[line..tag.start];
    let indent = &before[..before.len() - before.trim_start().len()];
    let newline = if text.contains("\r\n") { "\r\n" } else { "\n" };
    let own = format!("{newline}{indent}  {said}");
    let mut edits = if element.is_empty() {
        let start = text[..tag.end - 2].trim_end().len();
        vec![FileEdit::new(start..tag.end, format!(">{own}{newline}{indent}</{name}>"))]
    } else {
        vec![FileEdit::new(tag.end..tag.end, own)]
    };
    if bound.is_none()
        && let Some(root) = root(element.document())
    {
        let at = bytes(root.name_span()).end;
        edits.push(FileEdit::new(at..at, format!(" xmlns:{prefix}=\"{SAOMS_NAMESPACE}\"")));
    }
    edits
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::editor::testing::{composite, scene};

    /// The titles of what can be done at the cursor, and the text after the first of it.
    fn allow(marked: &str) -> (Vec<String>, String) {
        let (scene, at) = scene(marked, &[]);
        let file = scene.file();
        let all = allowances(&scene, at, "S4001");
        let mut text = file.text.to_string();
        let mut edits = all.first().map(|one| one.edits.clone()).unwrap_or_default();
        edits.sort_by_key(|edit| std::cmp::Reverse(edit.range.start));
        edits.into_iter().for_each(|edit| text.replace_range(edit.range, &edit.text));
        (all.into_iter().map(|one| one.title).collect(), text)
    }

    #[test]
    fn what_allows_a_code_stands_in_the_innermost_element_that_can_hold_it() {
        const SAID: &str = "<s:severity code=\"S4001\" level=\"allow\" reason=\"\"/>";
        let (titles, text) =
            allow(&composite("  <component name=\"R\">\n    <property name=\"|ID\">1</property>\n  </component>"));
        let whole = "Allow S4001 in this composite, with a reason";
        assert_eq!(titles, ["Allow S4001 in component `R`, with a reason", whole]);
        let expected =
            format!("  <component name=\"R\">\n    {SAID}\n    <property name=\"ID\">1</property>\n  </component>");
        assert_eq!(text, composite(&expected));
        let (titles, text) = allow(&composite("  <wire |source=\"a\" target=\"b\" />"));
        assert_eq!(titles, ["Allow S4001 in this wire, with a reason", whole]);
        assert_eq!(text, composite(&format!("  <wire source=\"a\" target=\"b\">\n    {SAID}\n  </wire>")));
        // Where it is said already, nothing is to be said.
        assert_eq!(allow(&composite(&format!("{SAID}<wire |/>"))).0, [""; 0]);
    }

    #[test]
    fn the_namespace_is_declared_where_it_is_not() {
        let text = "<composite xmlns=\"http://docs.oasis-open.org/ns/opencsa/sca/200912\" name=\"|f\">\r\n</composite>";
        let expected = "<composite xmlns:saoms=\"urn:saoms:1\" xmlns=\"http://docs.oasis-open.org/ns/opencsa/sca/200912\" name=\"f\">\r\n  <saoms:severity code=\"S4001\" level=\"allow\" reason=\"\"/>\r\n</composite>";
        assert_eq!(allow(text).1, expected);
    }
}
