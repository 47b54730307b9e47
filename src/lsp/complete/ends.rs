//! Ends of wires: `component` and `component/part`.

use std::ops::Range;

use lsp_types::CompletionItemKind;

use super::{Proposal, names};
use crate::lsp::outline::{Component, Implementation};
use crate::lsp::scene::Scene;
use crate::lsp::symbol::group;

/// What can stand at a place of a target, a source or a promotion.
pub(super) fn complete(
    scene: &Scene,
    element: usize,
    attribute: &str,
    value: Range<usize>,
    at: usize,
) -> Vec<Proposal> {
    let file = scene.file();
    let text = &*file.text;
    let word = word(text, value, at);
    let in_reference = file.tree.local(text, element) == "reference";
    let wants_references = attribute == "source" || (attribute == "promote" && in_reference);
    if let Some(slash) = text[word.start..at].find('/') {
        let (name, start) = (&text[word.start..word.start + slash], word.start + slash + 1);
        // What stands behind a second slash is a binding, which nobody declares.
        if text[start..at].contains('/') {
            return Vec::new();
        }
        let end = text[at..word.end].find('/').map_or(word.end, |found| at + found);
        // Replicas have the parts of what they are replicas of.
        let (file, name) = scene.named(0, name);
        let Some(of) = scene.component(file, &name) else { return Vec::new() };
        return match wants_references {
            true => names::references_of(scene, of, &(start..end)),
            false => names::services_of(scene, of, &(start..end)),
        };
    }
    let end = text[at..word.end].find('/').map_or(word.end, |found| at + found);
    let interface = if wants_references { None } else { interface(scene, element, attribute) };
    let own = scene.component_around(element).map(|component| &component.name);
    let mut all = Vec::new();
    for of @ (_, component) in scene.components() {
        if component.name.text.is_empty() {
            continue;
        }
        // A component that calls itself is a mistake.
        let is_own = own == Some(&component.name) && of.0 == 0;
        let fits = interface.as_ref().is_none_or(|wanted| offers(scene, component, wanted));
        let rank = match (is_own, fits) {
            (true, _) => 9,
            (_, false) => 8,
            (_, true) => 4,
        };
        let shown = match &component.implementation {
            Some(Implementation::Class(name) | Implementation::Composite(name)) => name.text.as_str(),
            None => "",
        };
        if let Some(all_of_them) = group(&component.name.text) {
            let one = Proposal::new(all_of_them, CompletionItemKind::VARIABLE, &(word.start..end));
            // A replica that names its own group means the others.
            all.push(one.detail(format!("all replicas: {shown}")).rank(if fits { 4 } else { 8 }));
        }
        let one = Proposal::new(&component.name.text, CompletionItemKind::VARIABLE, &(word.start..end));
        all.push(one.detail(shown).rank(rank));
    }
    all
}

/// The word of a list that a byte touches.
fn word(text: &str, value: Range<usize>, at: usize) -> Range<usize> {
    let before = &text[value.start..at];
    let start = before.rfind(char::is_whitespace).map_or(value.start, |found| {
        let width = before[found..].chars().next().map_or(1, char::len_utf8);
        value.start + found + width
    });
    let end = text[at..value.end].find(char::is_whitespace).map_or(value.end, |found| at + found);
    start..end
}

/// The interface that a reference, or the source of a wire, asks for.
fn interface(scene: &Scene, element: usize, attribute: &str) -> Option<String> {
    let file = scene.file();
    let (component, reference) = match (file.tree.local(&file.text, element), attribute) {
        ("reference", "target") => {
            let name = &file.text[file.tree.value(&file.text, element, "name")?];
            (scene.component_around(element)?, name.to_owned())
        }
        ("wire", "target") => {
            let source = &file.text[file.tree.value(&file.text, element, "source")?];
            let (component, reference) = source.split_once('/')?;
            let (file, component) = scene.named(0, component);
            (scene.component(file, &component)?.1, reference.to_owned())
        }
        _ => return None,
    };
    let declared = &scene.class(component)?.declaration().references;
    declared.iter().find(|one| one.name == reference).map(|one| one.interface.name.clone())
}

/// Whether a component has a service with this interface, as far as can be known.
fn offers(scene: &Scene, component: &Component, interface: &str) -> bool {
    match scene.class(component) {
        Some(class) => class.declaration().offers().any(|one| one.interface.name == interface),
        None => true,
    }
}
