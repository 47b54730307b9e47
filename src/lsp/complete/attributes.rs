//! Attributes.

use std::ops::Range;

use lsp_types::CompletionItemKind;
use saoms_core::load::vocabulary::{Known, own_attributes};
use saoms_core::model::{SAOMS_NAMESPACE, Version};

use super::{Proposal, value};
use crate::lsp::describe;
use crate::lsp::scene::Scene;

/// The attributes that an element can still get.
pub(super) fn complete(scene: &Scene, element: usize, name: &Range<usize>) -> Vec<Proposal> {
    let file = scene.file();
    let Some(kind) = file.kinds[element] else { return Vec::new() };
    let attributes = &file.tree.elements[element].attributes;
    let here = attributes.iter().find(|one| one.name == *name);
    // One that has its value already gets another name and nothing else.
    let has_value = here.is_some_and(|one| one.value.is_some());
    let is_taken = |written: &str| {
        attributes.iter().any(|one| one.name != *name && &file.text[one.name.clone()] == written)
    };
    let version = file.tree.version(&file.text);
    let own = file.tree.prefix_of(&file.text, element, SAOMS_NAMESPACE).filter(|own| !own.is_empty());
    let own = own
        .into_iter()
        .flat_map(|own| own_attributes(kind).map(move |known| (format!("{own}:{}", known.name), known)));
    let all = kind.of(version).map(|known| (known.name.to_owned(), known)).chain(own);
    let free = all.filter(|(written, _)| !is_taken(written));
    free.map(|(written, known)| attribute(written, known, has_value, name)).collect()
}

fn attribute(written: String, known: &Known, has_value: bool, range: &Range<usize>) -> Proposal {
    let text = if has_value { written.clone() } else { format!("{written}=\"$1\"") };
    let one = Proposal::new(written, CompletionItemKind::FIELD, range)
        .detail(if known.required { "required" } else { "" })
        .doc(describe::attribute(known))
        .rank(if known.required { 1 } else { 5 });
    if has_value { one.insert(text) } else { one.snippet(text) }
}

/// The namespaces that a composite needs.
pub(super) fn namespaces(range: &Range<usize>) -> Vec<Proposal> {
    let sca = Version::ALL.map(|version| (version.namespace(), version.label()));
    let own = [(SAOMS_NAMESPACE, "what SAOMS adds to SCA")];
    let all = sca.into_iter().chain(own).enumerate();
    all.map(|(rank, (name, what))| value(name, range).detail(what).rank(rank as u8)).collect()
}
