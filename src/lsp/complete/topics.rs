//! Topics, in the language of `topicRename`: `OLD,new::OLD2,new2`.

use std::collections::BTreeMap;
use std::ops::Range;

use lsp_types::CompletionItemKind;
use saoms_core::registry::TopicDeclaration;

use super::Proposal;
use crate::lsp::describe;
use crate::lsp::outline::Component;
use crate::lsp::scene::Scene;

/// The names that can stand at a place of a value of `topicRename`.
pub(super) fn complete(scene: &Scene, property: usize, value: Range<usize>, at: usize) -> Vec<Proposal> {
    let text = &scene.file().text;
    let before = &text[value.start..at];
    let pair = before.rfind("::").map_or(0, |found| found + 2);
    let comma = before[pair..].rfind(',').map(|found| pair + found + 1);
    let start = value.start + comma.unwrap_or(pair);
    let start = start + text[start..at].len() - text[start..at].trim_start().len();
    let behind = &text[at..value.end];
    let end = behind.find(',').into_iter().chain(behind.find("::")).min().unwrap_or(behind.len());
    let range = start..at + behind[..end].trim_end().len();
    let Some(component) = scene.component_around(property) else { return Vec::new() };
    let own = of_component(scene, (0, component));
    let own = own.iter().map(|(name, topic)| item(name, Some(*topic), &range));
    // The old name is one of the class; the new one can be any, as a rule one that others have.
    match comma {
        None => own.collect(),
        Some(_) => all(scene).into_iter().map(|(name, topic)| item(&name, topic, &range)).collect(),
    }
}

fn item(name: &str, topic: Option<&TopicDeclaration>, range: &Range<usize>) -> Proposal {
    let one = Proposal::new(name, CompletionItemKind::EVENT, range);
    match topic {
        Some(topic) => {
            one.detail(format!("{} ({})", topic.message, topic.kind.name())).doc(describe::topic(topic))
        }
        None => one.detail("a new name in this composite"),
    }
}

/// The topics of a component of a file, those of its loops included, by their own names.
pub(in crate::lsp) fn of_component<'s>(
    scene: &'s Scene,
    of: (usize, &Component),
) -> BTreeMap<&'s str, &'s TopicDeclaration> {
    let class = scene.class(of.1).map(|class| class.declaration());
    let own = class.into_iter().flat_map(|class| class.publishes.iter().chain(&class.subscribes));
    let of_loops = scene.loops(of).flat_map(|one| {
        let declaration = one.declaration();
        declaration.publishes.iter().chain(&declaration.subscribes)
    });
    own.chain(of_loops).map(|topic| (topic.name.as_str(), topic)).collect()
}

/// The topics of all components of the composite, and the names that they are given anew.
fn all(scene: &Scene) -> BTreeMap<String, Option<&TopicDeclaration>> {
    let mut all = BTreeMap::new();
    for (file, component) in scene.components_of(0) {
        let own = of_component(scene, (file, component));
        let renamed = component.properties.iter().find(|one| one.text == "topicRename");
        let value = renamed.and_then(|one| scene.value_of(file, one.element)).unwrap_or_default();
        for pair in value.split("::") {
            if let Some((old, new)) = pair.split_once(',') {
                all.insert(new.trim().to_owned(), own.get(old.trim()).copied());
            }
        }
        all.extend(own.into_iter().map(|(name, topic)| (name.to_owned(), Some(topic))));
    }
    all.retain(|name, _| !name.is_empty());
    all
}
