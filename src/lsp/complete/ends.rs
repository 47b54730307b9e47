//! Ends of wires: `component` and `component/part`.

use std::collections::BTreeSet;
use std::ops::Range;

use lsp_types::CompletionItemKind;
use saoms_core::registry::InterfaceDeclaration;

use super::{Proposal, names};
use crate::lsp::contracts::Contract;
use crate::lsp::outline::{Component, Implementation, Side};
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
    let promotes = attribute == "promote";
    let in_reference = file.tree.local(text, element) == "reference";
    let side = match attribute == "source" || (promotes && in_reference) {
        true => Side::Reference,
        false => Side::Service,
    };
    let asked = Asked { side, interface: interface(scene, element, attribute) };
    // What a reference of the composite targets is around the composite.
    let is_outer = attribute == "target" && in_reference && scene.component_around(element).is_none();
    let scopes = if is_outer { scene.users(0).to_vec() } else { vec![0] };
    if let Some(slash) = text[word.start..at].find('/') {
        let (name, start) = (&text[word.start..word.start + slash], word.start + slash + 1);
        // What stands behind a second slash is a binding, which nobody declares.
        if text[start..at].contains('/') {
            return Vec::new();
        }
        let end = text[at..word.end].find('/').map_or(word.end, |found| at + found);
        let of = scopes.into_iter().find_map(|scope| {
            // Replicas have the parts of what they are replicas of.
            let (file, name) = scene.named(scope, name);
            scene.component(file, &name)
        });
        let known = of.and_then(|of| scene.contracts(of, side)).unwrap_or_default();
        return names::contracts(known.into_iter().filter(|one| asked.fits(one)), &(start..end));
    }
    let end = text[at..word.end].find('/').map_or(word.end, |found| at + found);
    let own = (!is_outer && !promotes).then(|| scene.component_around(element)).flatten();
    let mut seen = BTreeSet::new();
    let mut all = Vec::new();
    for of @ (_, component) in scopes.into_iter().flat_map(|scope| scene.components_of(scope)) {
        let name = &component.name.text;
        let fitting = asked.of(scene, of);
        if name.is_empty() || fitting == Fitting::None || !seen.insert(name) {
            continue;
        }
        let is_own = own.is_some_and(|own| own.name == component.name) && of.0 == 0;
        let shown = match &component.implementation {
            Some(Implementation::Class(name) | Implementation::Composite(name)) => name.text.as_str(),
            None => "",
        };
        let range = word.start..end;
        let mut add = |label: String, detail: String, rank: u8| {
            all.push(Proposal::new(label, CompletionItemKind::VARIABLE, &range).detail(detail).rank(rank));
        };
        if let Some(all_of_them) = group(name) {
            // A replica that names its own group means the others.
            add(all_of_them, format!("all replicas: {shown}"), 4);
        }
        match fitting {
            // A component that calls itself is a mistake; a replica may call another one.
            _ if is_own && group(name).is_none() => {}
            Fitting::Several(parts) => {
                for part in parts {
                    add(format!("{name}/{part}"), shown.to_owned(), 4);
                }
            }
            _ => add(name.clone(), shown.to_owned(), if is_own { 8 } else { 4 }),
        }
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

/// What an end has to have.
struct Asked<'s> {
    side: Side,
    interface: Option<&'s InterfaceDeclaration>,
}

/// Which parts of a component are what is asked for.
#[derive(Debug, PartialEq, Eq)]
enum Fitting {
    None,
    /// One, or it cannot be known.
    Some,
    /// These, of which one has to be named.
    Several(Vec<String>),
}

impl Asked<'_> {
    fn fits(&self, one: &Contract<'_>) -> bool {
        let both = self.interface.zip(one.interface);
        both.is_none_or(|(wanted, offered)| wanted == offered)
    }

    fn of(&self, scene: &Scene, of: (usize, &Component)) -> Fitting {
        let Some(known) = scene.contracts(of, self.side) else { return Fitting::Some };
        let fitting: Vec<&str> = known.iter().filter(|one| self.fits(one)).map(|one| one.name).collect();
        match (&fitting[..], self.side, self.interface) {
            ([], ..) => Fitting::None,
            // A reference is named as a rule.
            ([_], Side::Service, _) | (_, Side::Service, None) => Fitting::Some,
            _ => Fitting::Several(fitting.into_iter().map(str::to_owned).collect()),
        }
    }
}

/// The interface that a reference, or the source of a wire, asks for.
fn interface<'s>(scene: &'s Scene, element: usize, attribute: &str) -> Option<&'s InterfaceDeclaration> {
    let file = scene.file();
    let value = |element: usize, name: &str| Some(&file.text[file.tree.value(&file.text, element, name)?]);
    if attribute != "target" {
        return None;
    }
    let (of, reference) = match file.tree.local(&file.text, element) {
        "wire" => {
            let (component, reference) = value(element, "source")?.split_once('/')?;
            let (file, component) = scene.named(0, component);
            (scene.component(file, &component)?, reference)
        }
        name => {
            // A binding is in its reference.
            let element = if name == "reference" { element } else { file.tree.elements[element].parent? };
            match scene.component_around(element) {
                Some(component) => ((0, component), value(element, "name")?),
                None => {
                    let (component, reference) = value(element, "promote")?.split_once('/')?;
                    let reference = reference.split(char::is_whitespace).next()?;
                    let (file, component) = scene.named(0, component);
                    (scene.component(file, &component)?, reference)
                }
            }
        }
    };
    scene.contract(of, Side::Reference, reference)?.interface
}
