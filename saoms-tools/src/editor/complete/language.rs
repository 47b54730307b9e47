//! Texts in properties whose language a crate of components knows.

use std::collections::{HashSet, VecDeque};
use std::ops::Range;

use saoms_api::extension::{self, Explanation, PropertyLanguage, PropertyText};
use saoms_lang::expression::{ExpressionValue, render};
use saoms_lang::syntax::ElementId;

use super::{Proposal, ProposalKind};
use crate::editor::scene::Scene;
use crate::editor::scene::outline::Component;
use crate::editor::syntax::Places;

/// A language in a property, and the file of the composite whose components a text in it is about.
#[derive(Clone)]
pub(in crate::editor) struct Language {
    language: &'static PropertyLanguage,
    /// The words of the language whose events the class plays itself.
    plays: Vec<String>,
    composite: usize,
}

/// The most properties of composites that a text is followed through.
const MOST: usize = 1000;

/// The language of the text in a property of a component of a file.
pub(in crate::editor) fn of_property(scene: &Scene, file: usize, property: ElementId) -> Option<Language> {
    match taken_by(scene, file, property)? {
        Taker::Class(language, plays) => Some(Language { language, plays, composite: file }),
        Taker::Composite(inner, name) => of_parameter(scene, inner, name),
    }
}

/// The language of the values of a property of a component, as columns of its table hold them.
pub(super) fn of_column<'s>(
    scene: &'s Scene,
    (file, component): (usize, &Component),
    name: &'s str,
) -> Option<Language> {
    match taker(scene, file, component, name)? {
        Taker::Class(language, plays) => Some(Language { language, plays, composite: file }),
        Taker::Composite(inner, name) => of_parameter(scene, inner, name),
    }
}

/// The language of the text in a property of the composite that a file is part of: that of the first property of a
/// class that takes the whole text, also through composites inside.
pub(super) fn of_parameter<'s>(scene: &'s Scene, file: usize, name: &'s str) -> Option<Language> {
    let mut waiting = VecDeque::from([(scene.declaring(file, name)?, name)]);
    let mut seen: HashSet<(usize, &str)> = waiting.iter().copied().collect();
    while let Some((file, name)) = waiting.pop_front() {
        for &place in scene.unit_of(file) {
            let of = &scene.files[place];
            for source in of.outline.sources.iter().filter(|source| source.text == name) {
                // A path leads to a part of the value.
                let written = of.element(source.element).value("source");
                if written.is_none_or(|at| at.start + 1 != source.at.start || at.end != source.at.end) {
                    continue;
                }
                match taken_by(scene, place, source.element) {
                    Some(Taker::Class(language, plays)) => {
                        return Some(Language { language, plays, composite: place });
                    }
                    Some(Taker::Composite(inner, name)) => {
                        let next = (scene.declaring(inner, name)?, name);
                        if seen.len() < MOST && seen.insert(next) {
                            waiting.push_back(next);
                        }
                    }
                    None => {}
                }
            }
        }
    }
    None
}

/// The taker of the text of a component's property.
enum Taker<'s> {
    Class(&'static PropertyLanguage, Vec<String>),
    /// The property of a composite inside: its file, and its name.
    Composite(usize, &'s str),
}

fn taken_by(scene: &Scene, file: usize, property: ElementId) -> Option<Taker<'_>> {
    let of = &scene.files[file];
    let name = &of.text[of.element(property).value("name")?];
    taker(scene, file, scene.component_in(file, property)?, name)
}

fn taker<'s>(scene: &Scene, file: usize, component: &Component, name: &'s str) -> Option<Taker<'s>> {
    if let Some(inner) = scene.inner(file, component) {
        return Some(Taker::Composite(inner, name));
    }
    let declared = scene.class(component)?.declaration().property(name)?;
    let language = PropertyLanguage::named(declared.language.as_deref()?)?;
    Some(Taker::Class(language, declared.plays.clone()))
}

fn is_a(scene: &Scene, component: &Component, class: &str) -> bool {
    let declaration = scene.class(component).map(|class| class.declaration());
    class.is_empty()
        || declaration.is_some_and(|one| one.name == class || one.extends.iter().any(|other| other == class))
}

/// The completions of a language at a byte of the scene's file; `range` is the text of the property.
pub(super) fn complete(of: &Language, scene: &Scene, range: Range<usize>, at: usize) -> Vec<Proposal> {
    let found = with_text(of, scene, &range, at, of.language.complete);
    found.into_iter().map(|one| shifted(one, range.start)).collect()
}

/// What the word at a byte of the scene's file means, in Markdown, with its bytes.
pub(in crate::editor) fn explain(
    of: &Language,
    scene: &Scene,
    range: Range<usize>,
    at: usize,
) -> Option<(String, Range<usize>)> {
    let Explanation { text, bytes } = with_text(of, scene, &range, at, of.language.explain)?;
    Some((text, range.start + bytes.start..range.start + bytes.end))
}

fn with_text<T>(of: &Language, scene: &Scene, range: &Range<usize>, at: usize, ask: fn(&PropertyText<'_>) -> T) -> T {
    let text = &scene.file().text[range.clone()];
    let components = |class: &str| components(scene, of.composite, class);
    let events = scene.registry.events();
    ask(&PropertyText { text, at: at - range.start, plays: &of.plays, events: &events, components: &components })
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

/// The names of the components of a class in a composite, or of all for an empty name; of replicas, the name of the
/// first.
fn components(scene: &Scene, composite: usize, class: &str) -> Vec<String> {
    let components = scene.components_of(composite).filter(|(_, one)| is_a(scene, one, class));
    let first = |name: &str| render(name, &mut |_| Ok(ExpressionValue::Integer(1))).ok();
    components.filter_map(|(_, one)| first(&one.name.text)).collect()
}
