//! Topics, in the language of `topicRename`: `OLD,new::OLD2,new2`.

use std::collections::BTreeMap;
use std::ops::Range;

use super::ProposalKind;
use saoms_lang::registry::ClassTopic;
use saoms_lang::syntax::ElementId;

use super::Proposal;
use crate::editor::describe;
use crate::editor::scene::Scene;
use crate::editor::scene::outline::Component;

/// The names that can stand at a place of a value of `topicRename`.
pub(super) fn complete(scene: &Scene, property: ElementId, value: Range<usize>, at: usize) -> Vec<Proposal> {
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
    let own = own(scene, (0, component));
    let own = own.iter().map(|(name, topic)| item(name, Some(*topic), &range));
    // The old name is one of the class; the new one can be any, as a rule one that others have.
    match comma {
        None => own.collect(),
        Some(_) => all(scene).into_iter().map(|(name, topic)| item(&name, topic, &range)).collect(),
    }
}

fn item(name: &str, topic: Option<&ClassTopic>, range: &Range<usize>) -> Proposal {
    let one = Proposal::new(name, ProposalKind::Event, range);
    match topic {
        Some(topic) => one.detail(format!("{} ({})", topic.message, topic.kind.name())).doc(describe::topic(topic)),
        None => one.detail("a new name in this composite"),
    }
}

/// The topics of a component of a file by their own names.
fn own<'s>(scene: &'s Scene, of: (usize, &Component)) -> BTreeMap<&'s str, &'s ClassTopic> {
    let all = scene.topics(of).into_iter();
    all.map(|topic| (topic.declaration.name.as_str(), topic.declaration)).collect()
}

/// The topics of all components of the composite, and the names that they are given anew.
fn all(scene: &Scene) -> BTreeMap<String, Option<&ClassTopic>> {
    let mut all = BTreeMap::new();
    for (file, component) in scene.components_of(0) {
        let own = own(scene, (file, component));
        let text = &scene.files[file].text;
        for [old, new] in scene.renamed(file, component) {
            all.insert(text[new].to_owned(), own.get(&text[old]).copied());
        }
        all.extend(own.into_iter().map(|(name, topic)| (name.to_owned(), Some(topic))));
    }
    all
}
