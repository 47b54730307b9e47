//! Topics: who publishes and who reads them, and under which names.

use std::collections::BTreeMap;
use std::ops::Range;

use saoms_lang::registry::ClassTopic;

use super::Scene;
use super::outline::{Component, Implementation};
use super::symbol::{FileRange, Occurrence, Symbol};
use crate::editor::syntax::trimmed;

/// The property that gives topics other names.
pub(crate) const RENAME: &str = "topicRename";

/// The most components that are named.
const MOST: usize = 12;

/// A topic of a component.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Topic<'s> {
    pub(crate) declaration: &'s ClassTopic,
    pub(crate) is_published: bool,
}

/// A topic as a component of a file has it.
#[derive(Clone, Debug)]
pub(crate) struct Use<'s> {
    pub(crate) topic: Topic<'s>,
    /// The name that it has in the fleet.
    pub(crate) name: &'s str,
    pub(crate) file: usize,
    pub(crate) component: &'s Component,
    /// The place of the name, if it is another one than the class gives.
    pub(crate) at: Option<Range<usize>>,
}

/// The names of a `topicRename`, each old one with the new one: `OLD,new::OLD2,new2`, or `OLD::new`.
pub(crate) fn pairs(text: &str, range: Range<usize>) -> Vec<[Range<usize>; 2]> {
    let has_comma = text[range.clone()].contains(',');
    let pieces = if has_comma { split(text, range, "::") } else { vec![range] };
    let separator = if has_comma { "," } else { "::" };
    let pair = |piece| match &split(text, piece, separator)[..] {
        [old, new] => Some([trimmed(text, old.clone()), trimmed(text, new.clone())]),
        _ => None,
    };
    pieces.into_iter().filter_map(pair).filter(|pair| pair.iter().all(|name| !name.is_empty())).collect()
}

fn split(text: &str, range: Range<usize>, separator: &str) -> Vec<Range<usize>> {
    let mut start = range.start;
    let mut pieces = Vec::new();
    for piece in text[range].split(separator) {
        pieces.push(start..start + piece.len());
        start += piece.len() + separator.len();
    }
    pieces
}

impl Scene {
    /// The topics of a component of a file, those of its loops included, by the names that these give them.
    pub(crate) fn topics(&self, of: (usize, &Component)) -> Vec<Topic<'_>> {
        let mut all: Vec<Topic<'_>> = Vec::new();
        let class = self.class(of.1).map(|class| class.declaration());
        let own = class.into_iter().map(|class| (&class.publishes, &class.subscribes));
        let loops = self.loops(of).map(|one| (&one.declaration().publishes, &one.declaration().subscribes));
        for (publishes, subscribes) in own.chain(loops) {
            let published = publishes.iter().map(|declaration| Topic { declaration, is_published: true });
            let read = subscribes.iter().map(|declaration| Topic { declaration, is_published: false });
            all.extend(published.chain(read));
        }
        all
    }

    /// The `topicRename` of a component of a file.
    pub(crate) fn renamed(&self, file: usize, component: &Component) -> Vec<[Range<usize>; 2]> {
        let of = &self.files[file];
        let property = component.properties.iter().find(|one| one.text == RENAME);
        let value = property.and_then(|one| self.place_of_value(file, one.element));
        value.map_or_else(Vec::new, |value| pairs(&of.text, value))
    }

    /// The topics of all components of the fleets that the first file is part of.
    pub(crate) fn uses_of_topics(&self) -> Vec<Use<'_>> {
        let mut all = Vec::new();
        for file in self.fleet_files() {
            let text = &self.files[file].text;
            for component in &self.files[file].outline.components {
                let renamed = self.renamed(file, component);
                for topic in self.topics((file, component)) {
                    let own = topic.declaration.name.as_str();
                    let other = renamed.iter().find(|[old, _]| text[old.clone()] == *own);
                    let at = other.map(|[_, new]| new.clone());
                    let name = at.clone().map_or(own, |at| &text[at]);
                    all.push(Use { topic, name, file, component, at });
                }
            }
        }
        all
    }

    /// Every place of a topic: where it gets its name, or else the classes of the components that have it. Those that
    /// publish it define it.
    pub(crate) fn places_of_topic(&self, name: &str) -> Vec<Occurrence> {
        // A component that publishes a topic and reads it has it at one place.
        let mut places: BTreeMap<FileRange, bool> = BTreeMap::new();
        for one in self.uses_of_topics().into_iter().filter(|one| one.name == name) {
            let class = match &one.component.implementation {
                Some(Implementation::Class(class)) => class.at.clone(),
                _ => one.component.name.at.clone(),
            };
            let at = FileRange::new(one.file, &one.at.unwrap_or(class));
            *places.entry(at).or_default() |= one.topic.is_published;
        }
        let symbol = Symbol::Topic { name: name.to_owned() };
        let occurrence =
            |(at, is_definition)| Occurrence { symbol: symbol.clone(), at, is_definition, is_in_expression: false };
        places.into_iter().map(occurrence).collect()
    }

    /// Documentation of a topic of the fleet.
    pub(crate) fn about_topic(&self, name: &str) -> Option<String> {
        let uses = self.uses_of_topics();
        let uses: Vec<&Use<'_>> = uses.iter().filter(|one| one.name == name).collect();
        let first = uses.first()?.topic.declaration;
        let names = |is_published: bool| {
            let meant = uses.iter().filter(|one| one.topic.is_published == is_published);
            let mut names: Vec<String> = meant.map(|one| format!("`{}`", one.component.name.text)).collect();
            names.dedup();
            match names.len() {
                0 => "nobody".to_owned(),
                count if count > MOST => format!("{} and {} more", names[..MOST].join(", "), count - MOST),
                _ => names.join(", "),
            }
        };
        Some(format!(
            "**{name}**: a topic of `{}` ({})\n\nPublished by {}\n\nRead by {}",
            first.message,
            first.kind.name(),
            names(true),
            names(false)
        ))
    }
}
