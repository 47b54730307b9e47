//! Ends of wires: `component` and `component/part`.

use std::collections::BTreeSet;
use std::ops::Range;

use super::ProposalKind;
use saoms_lang::expression::{ExpressionError, ExpressionValue, INDEX, render};
use saoms_lang::model::SAOMS_NAMESPACE;
use saoms_lang::registry::InterfaceDeclaration;
use saoms_lang::syntax::{Element, ElementId};

use super::{Proposal, names};
use crate::editor::scene::Scene;
use crate::editor::scene::contracts::Contract;
use crate::editor::scene::outline::{Component, Implementation, Side};
use crate::editor::scene::symbol::group;
use crate::editor::syntax::Places;

/// Proposals for a target, a source or a promotion.
pub(super) fn complete(
    scene: &Scene,
    element: ElementId,
    attribute: &str,
    value: Range<usize>,
    at: usize,
) -> Vec<Proposal> {
    let file = scene.file();
    let text = &*file.text;
    let word = word(text, value, at);
    let promotes = attribute == "promote";
    let in_reference = file.element(element).local_name() == "reference";
    let side = match attribute == "source" || (promotes && in_reference) {
        true => Side::Reference,
        false => Side::Service,
    };
    let reference = (attribute == "target").then(|| calling(scene, element)).flatten();
    let asked = Asked {
        side,
        interface: reference.as_ref().and_then(|one| one.interface),
        takes_several: match &reference {
            Some(one) => one.multiplicity.is_none_or(|many| many.ends_with('n')),
            None => !promotes || in_reference,
        },
    };
    // What a replica says can hold its index.
    let in_replica = scene.component_around(element).is_some_and(|one| one.is_replicated);
    // What a reference of the composite targets is around the composite.
    let is_outer = attribute == "target" && in_reference && scene.component_around(element).is_none();
    let scopes = if is_outer { scene.users(0).to_vec() } else { vec![0] };
    if let Some(slash) = text[word.start..at].find('/') {
        let (name, start) = (&text[word.start..word.start + slash], word.start + slash + 1);
        // Behind a second slash is a binding, which is not declared.
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
        let parts = match fitting {
            Fitting::Several(parts) => parts,
            _ => Vec::new(),
        };
        let mut add = |name: String, detail: &str, rank: u8| {
            let named = |label| Proposal::new(label, ProposalKind::Variable, &range).detail(detail).rank(rank);
            match &parts[..] {
                [] => all.push(named(name)),
                parts => all.extend(parts.iter().map(|part| named(format!("{name}/{part}")))),
            }
        };
        // A component that calls itself is a mistake; a replica may call another one.
        let rank = if is_own { 8 } else { 4 };
        match group(name) {
            Some(group) => {
                if in_replica {
                    add(name.clone(), shown, rank);
                }
                // A replica that names its own group means the others.
                if asked.takes_several {
                    add(group, &format!("all replicas: {shown}"), 4);
                } else if !in_replica && let Some(first) = first_replica(scene, of) {
                    add(first, &format!("one of the replicas: {shown}"), 4);
                }
            }
            None if is_own => {}
            None => add(name.clone(), shown, rank),
        }
    }
    all
}

/// The name of the first replica of a component, where it does not depend on what is set from outside.
fn first_replica(scene: &Scene, (file, component): (usize, &Component)) -> Option<String> {
    let of = &scene.files[file];
    let from = of.element(component.name.element).attribute_in(SAOMS_NAMESPACE, "from");
    let written = from.map(|one| one.raw_value().trim());
    let first = written.map_or(Ok(1), str::parse).ok()?;
    let mut value = |name: &str| match name {
        INDEX => Ok(ExpressionValue::Integer(first)),
        _ => Err(ExpressionError::new("only the index is known")),
    };
    render(&component.name.text, &mut value).ok()
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

/// The requirement on an end.
struct Asked<'s> {
    side: Side,
    interface: Option<&'s InterfaceDeclaration>,
    /// True if it can be several components.
    takes_several: bool,
}

/// The parts of a component that fit.
#[derive(Debug, PartialEq, Eq)]
enum Fitting {
    None,
    /// One, or it cannot be known.
    Some,
    /// These: one of them has to be named.
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

/// The reference that calls what a target names: the one that it is in, or that the wire begins at.
fn calling<'s>(scene: &'s Scene, element: ElementId) -> Option<Contract<'s>> {
    let file = scene.file();
    let element = file.element(element);
    let value = |element: Element<'s>, name: &str| Some(&file.text[element.value(name)?]);
    let (of, reference) = match element.local_name() {
        "wire" => {
            let (component, reference) = value(element, "source")?.split_once('/')?;
            let (file, component) = scene.named(0, component);
            (scene.component(file, &component)?, reference)
        }
        name => {
            // A binding is in its reference.
            let element = if name == "reference" { element } else { element.parent()? };
            match scene.component_around(element.id()) {
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
    scene.contract(of, Side::Reference, reference)
}
