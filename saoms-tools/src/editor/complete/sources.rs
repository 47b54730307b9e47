//! Sources of property values: `$name`, and the parts of complex values that paths lead to.

use std::collections::BTreeSet;
use std::ops::Range;

use saoms_lang::syntax::ElementId;

use super::ProposalKind;

use super::{Proposal, names};
use crate::editor::scene::Scene;
use crate::editor::scene::outline::{Component, Named};
use crate::editor::syntax::{Places, is_declaration, local};

/// The number of elements of values that are searched.
const MOST: usize = 20_000;
/// The number of components that are searched for values that they give a composite.
const MOST_GIVERS: usize = 100;

/// The number of texts that are proposed.
const MOST_TEXTS: usize = 200;

/// An element of a value: its file and its place there.
type Part = (usize, ElementId);

/// Proposals at a place of a `source`: a property of the composite, or behind `/` and `[` the elements and attributes
/// in its value.
pub(super) fn complete(scene: &Scene, value: Range<usize>, at: usize) -> Vec<Proposal> {
    let text = &scene.file().text;
    if let Some(all) = texts(scene, &value, at) {
        return all;
    }
    let Some(mut paths) = paths(&text[value.start..at]) else { return Vec::new() };
    let Some(typed) = paths.pop() else { return Vec::new() };
    let end = at + text[at..value.end].find(|letter| !is_name(letter)).unwrap_or(value.end - at);
    let from = around(scene, paths);
    let Some((steps, last)) = typed.rsplit_once('/') else {
        return match from {
            // In a predicate.
            Some(from) if !typed.starts_with('$') => parts(scene, &from, &(at - typed.len()..end)),
            _ => names::sources(scene, &(at - typed.len()..end)),
        };
    };
    let range = at - last.len()..end;
    let (from, steps) = split(steps, scene, from);
    let from = match steps {
        None => from.iter().copied().chain(only(scene, &from)).collect(),
        Some(steps) => walk(scene, from, steps.split('/')),
    };
    parts(scene, &from, &range)
}

/// The elements that paths around one choose from; `None` where there is none around it.
fn around(scene: &Scene, paths: Vec<&str>) -> Option<Vec<Part>> {
    paths.into_iter().fold(None, |from, path| {
        let (start, steps) = split(path, scene, from);
        Some(walk(scene, start, steps.into_iter().flat_map(|steps| steps.split('/'))))
    })
}

/// Proposals for the text behind `=`, where its quote is open.
fn texts(scene: &Scene, value: &Range<usize>, at: usize) -> Option<Vec<Proposal>> {
    let text = &scene.file().text;
    let typed = &text[value.start..at];
    let (open, quote) = open_quote(typed)?;
    let operand = typed[..open].trim_end().strip_suffix('=')?;
    let mut paths = paths(operand.strip_suffix('!').unwrap_or(operand).trim_end())?;
    let path = paths.pop()?;
    let (start, steps) = split(path, scene, around(scene, paths));
    let (steps, last) =
        steps.map(|steps| steps.rsplit_once('/').map_or((None, steps), |(steps, last)| (Some(steps), last)))?;
    let here = match steps {
        Some(steps) => walk(scene, start, steps.split('/')),
        None => start,
    };
    let rest = &text[at..value.end];
    let end = rest.find(quote).or_else(|| rest.find(|letter| !is_name(letter))).unwrap_or(rest.len());
    let range = value.start + open + 1..at + end;
    let mut seen = BTreeSet::new();
    let mut add = |text: &str| {
        // A text that would need character references is not proposed.
        let is_plain = !text.is_empty() && !text.contains(['&', '<', '"', '\'', '\n']);
        let is_new = is_plain && seen.len() < MOST_TEXTS && seen.insert(text.to_owned());
        is_new.then(|| Proposal::new(text, ProposalKind::Value, &range))
    };
    let mut all = Vec::new();
    if let Some(name) = last.strip_prefix('@') {
        for (file, one) in here {
            let attributes = scene.files[file].element(one).written_attributes();
            let named = attributes.filter(|one| one.local_name() == local(name));
            all.extend(named.filter_map(|one| add(one.raw_value())));
        }
        return Some(all);
    }
    let elements = if matches!(last, "." | "text()") { here } else { named(scene, &here, local(last)) };
    for (file, one) in elements {
        let file = &scene.files[file];
        all.extend(file.element(one).text_place().and_then(|at| add(file.text[at].trim())));
    }
    Some(all)
}

/// The open quote at the end of a part of an XPath, with its place.
fn open_quote(typed: &str) -> Option<(usize, char)> {
    typed.char_indices().fold(None, |open, (at, letter)| match open {
        Some((_, quote)) if quote == letter => None,
        Some(open) => Some(open),
        None => matches!(letter, '"' | '\'').then_some((at, letter)),
    })
}

fn is_name(letter: char) -> bool {
    letter.is_alphanumeric() || "_-.:".contains(letter)
}

/// The paths that are not at their end yet in a part of an XPath: the innermost last, which the others choose by a
/// predicate. `None` within quotes.
fn paths(typed: &str) -> Option<Vec<&str>> {
    let mut open: Vec<Range<usize>> = std::iter::once(0..0).collect();
    let mut quote = None;
    for (at, letter) in typed.char_indices() {
        let next = at + letter.len_utf8();
        match letter {
            _ if quote == Some(letter) => quote = None,
            _ if quote.is_some() => continue,
            '\'' | '"' => quote = Some(letter),
            '[' => {
                open.push(next..next);
                continue;
            }
            ']' => {
                open.pop();
                open.last_mut()?.end = next;
                continue;
            }
            _ if is_name(letter) || "$@*/".contains(letter) => {
                open.last_mut()?.end = next;
                continue;
            }
            _ => {}
        }
        *open.last_mut()? = next..next;
    }
    let all = open.into_iter().map(|range| &typed[range]);
    quote.is_none().then(|| all.collect())
}

/// The elements that a path starts from, and its steps: those of a property, or in a predicate those that this is
/// about.
fn split<'p>(path: &'p str, scene: &Scene, around: Option<Vec<Part>>) -> (Vec<Part>, Option<&'p str>) {
    let Some(rest) = path.strip_prefix('$') else { return (around.unwrap_or_default(), Some(path)) };
    let (name, steps) = rest.split_once('/').map_or((rest, None), |(name, steps)| (name, Some(steps)));
    let name = name.split('[').next().unwrap_or(name);
    (values(scene, name), steps)
}

/// The elements that hold the values of a property of the composite.
fn values(scene: &Scene, name: &str) -> Vec<Part> {
    let unit = scene.unit_of(0);
    let mut all = Vec::new();
    for &file in unit {
        all.extend(scene.property(file, name).into_iter().flat_map(|one| values_of(scene, file, one)));
    }
    // The components that the composite implements may give it one.
    let outer = scene.including(0);
    for &file in scene.users(0) {
        let components = scene.files[file].outline.components.iter();
        let is_giver = |one: &&Component| scene.inner(file, one).is_some_and(|one| outer.contains(&one));
        let givers = components.filter(is_giver).take(MOST_GIVERS);
        let given = givers.flat_map(|one| one.properties.iter().filter(|one| one.text == name));
        all.extend(given.flat_map(|one| values_of(scene, file, one)));
    }
    all
}

/// The elements that hold the values of one `property`: itself, each `value`, or each element of its value.
fn values_of(scene: &Scene, file: usize, property: &Named) -> Vec<Part> {
    let property = scene.files[file].element(property.element);
    let children = || property.children().take(MOST);
    let values: Vec<Part> =
        children().filter(|child| child.local_name() == "value").map(|child| (file, child.id())).collect();
    match values.is_empty() {
        false => values,
        true if property.written_attributes().any(|one| one.name() == "element") => {
            children().map(|child| (file, child.id())).collect()
        }
        true => vec![(file, property.id())],
    }
}

/// The elements that are alone in what a value stands in: such a value has the parts of its element as well.
fn only(scene: &Scene, all: &[Part]) -> Vec<Part> {
    let only = all.iter().filter_map(|&(file, element)| {
        let mut inside = scene.files[file].element(element).children();
        let only = inside.next()?;
        inside.next().is_none().then_some((file, only.id()))
    });
    only.collect()
}

/// The elements that steps lead to, predicates aside.
fn walk<'p>(scene: &Scene, from: Vec<Part>, steps: impl Iterator<Item = &'p str>) -> Vec<Part> {
    let mut here = from;
    for (place, step) in steps.enumerate() {
        let name = step.split('[').next().unwrap_or(step);
        let name = local(name.strip_prefix("child::").unwrap_or(name));
        let next = match name {
            "" => descendants(scene, &here),
            "." => continue,
            ".." => here
                .iter()
                .filter_map(|&(file, one)| Some((file, scene.files[file].element(one).parent()?.id())))
                .collect(),
            _ => match named(scene, &here, name) {
                none if none.is_empty() && place == 0 => named(scene, &only(scene, &here), name),
                found => found,
            },
        };
        here = next;
        here.sort_unstable();
        here.dedup();
    }
    here
}

fn named(scene: &Scene, of: &[Part], name: &str) -> Vec<Part> {
    let is_meant = |&(file, one): &Part| name == "*" || scene.files[file].element(one).local_name() == name;
    children(scene, of).filter(is_meant).collect()
}

fn children(scene: &Scene, of: &[Part]) -> impl Iterator<Item = Part> {
    let all =
        of.iter().flat_map(|&(file, one)| scene.files[file].element(one).children().map(move |one| (file, one.id())));
    all.take(MOST)
}

/// Elements with all that is inside them.
fn descendants(scene: &Scene, of: &[Part]) -> Vec<Part> {
    let all = of
        .iter()
        .flat_map(|&(file, one)| scene.files[file].element(one).descendants().map(move |one| (file, one.id())));
    all.take(MOST).collect()
}

/// The names of the elements and attributes in elements, the first text or value of each beside it.
fn parts(scene: &Scene, of: &[Part], range: &Range<usize>) -> Vec<Proposal> {
    let (mut all, mut seen) = (Vec::new(), BTreeSet::new());
    for (file, one) in children(scene, of) {
        let file = &scene.files[file];
        let name = file.element(one).local_name();
        if !name.is_empty() && seen.insert(name.to_owned()) {
            let text = file.element(one).text_place().map_or("", |at| &file.text[at]);
            all.push(Proposal::new(name, ProposalKind::Field, range).detail(text).rank(4));
        }
    }
    // A property that a value stands in is no part of that.
    let of_values = of.iter().filter(|(file, one)| scene.files[*file].kind(*one).is_none());
    for &(file, one) in of_values.take(MOST) {
        for attribute in scene.files[file].element(one).written_attributes() {
            let shown = format!("@{}", attribute.local_name());
            if !is_declaration(attribute.name()) && seen.insert(shown.clone()) {
                let value = attribute.raw_value();
                all.push(Proposal::new(shown, ProposalKind::Property, range).detail(value));
            }
        }
    }
    all
}
