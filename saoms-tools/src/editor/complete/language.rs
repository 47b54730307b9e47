//! Texts in properties whose language a crate of components knows.

use std::ops::Range;

use saoms_api::extension::{self, PropertyLanguage, PropertyText};
use saoms_lang::expression::{ExpressionValue, render};
use saoms_lang::syntax::ElementId;

use super::{Proposal, ProposalKind};
use crate::editor::scene::Scene;
use crate::editor::scene::outline::Component;
use crate::editor::syntax::Places;

/// The language of the text in a property of a component of a file.
pub(super) fn of_property(scene: &Scene, file: usize, property: ElementId) -> Option<&'static PropertyLanguage> {
    let of = &scene.files[file];
    let name = &of.text[of.element(property).value("name")?];
    let component = scene.component_in(file, property)?;
    PropertyLanguage::linked().find(|language| language.property == name && is_a(scene, component, language.class))
}

fn is_a(scene: &Scene, component: &Component, class: &str) -> bool {
    let declaration = scene.class(component).map(|class| class.declaration());
    declaration.is_some_and(|one| one.name == class || one.extends.iter().any(|other| other == class))
}

/// The completions of a language at a byte of the scene's file; `range` is the text of the property, which belongs to a
/// composite.
pub(super) fn complete(
    language: &PropertyLanguage,
    scene: &Scene,
    composite: usize,
    range: Range<usize>,
    at: usize,
) -> Vec<Proposal> {
    let text = &scene.file().text[range.clone()];
    let components = |class: &str| components(scene, composite, class);
    let found = (language.complete)(&PropertyText { text, at: at - range.start, components: &components });
    found.into_iter().map(|one| shifted(one, range.start)).collect()
}

/// The completion of a text that begins at a byte of the file.
fn shifted(completion: extension::Completion, start: usize) -> Proposal {
    let extension::Completion { label, kind, detail, rank, snippet, range } = completion;
    let kind = match kind {
        extension::CompletionKind::Keyword => ProposalKind::Keyword,
        extension::CompletionKind::Value => ProposalKind::Value,
        extension::CompletionKind::Component => ProposalKind::Variable,
    };
    let range = start + range.start..start + range.end;
    let completion = Proposal::new(label, kind, &range).detail(detail).rank(rank);
    match snippet {
        Some(snippet) => completion.snippet(snippet),
        None => completion,
    }
}

/// The names of the components of a class in a composite; of replicas, the name of the first.
fn components(scene: &Scene, composite: usize, class: &str) -> Vec<String> {
    let components = scene.components_of(composite).filter(|(_, one)| is_a(scene, one, class));
    let first = |name: &str| render(name, &mut |_| Ok(ExpressionValue::Integer(1))).ok();
    components.filter_map(|(_, one)| first(&one.name.text)).collect()
}
