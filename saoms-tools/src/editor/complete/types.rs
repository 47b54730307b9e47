//! Types of properties, and where their values can come from.

use std::ops::Range;

use super::ProposalKind;
use saoms_lang::load::vocabulary::{BUILT_IN_TYPES, XML_SCHEMA};
use saoms_lang::syntax::ElementId;

use super::Proposal;
use crate::editor::scene::Scene;
use crate::editor::syntax::{Places, root_name_end};

/// The types that most properties have come first, with what they are.
const USUAL: [(&str, &str); 5] = [
    ("string", "any text"),
    ("int", "a whole number of 32 bits"),
    ("boolean", "`true` or `false`"),
    ("double", "a number"),
    ("long", "a whole number of 64 bits"),
];

/// The types of XML Schema. Where the file has no prefix for them, one is declared at its root.
pub(super) fn complete(scene: &Scene, element: ElementId, range: &Range<usize>) -> Vec<Proposal> {
    let file = scene.file();
    let bound = file.element(element).prefix_of(XML_SCHEMA);
    let prefix = match bound {
        Some("") => String::new(),
        Some(prefix) => format!("{prefix}:"),
        None => "xsd:".to_owned(),
    };
    let declaration = root_name_end(&file.document).filter(|_| bound.is_none());
    let others = BUILT_IN_TYPES.iter().filter(|name| USUAL.iter().all(|(usual, _)| usual != *name));
    let all = USUAL.iter().map(|(name, what)| (*name, *what, 1)).chain(others.map(|name| (*name, "", 5)));
    all.zip(0..)
        .map(|((name, what, rank), place)| {
            let one = Proposal::new(format!("{prefix}{name}"), ProposalKind::TypeParameter, range);
            let one = one.detail(what).rank(if rank == 1 { place } else { rank + 5 });
            match declaration {
                Some(at) => one.also(at, format!(" xmlns:xsd=\"{XML_SCHEMA}\"")),
                None => one,
            }
        })
        .collect()
}

/// The elements that stand in a property: one of them is its value.
pub(super) fn elements(scene: &Scene, property: ElementId, range: &Range<usize>) -> Vec<Proposal> {
    let property = scene.file().element(property);
    let inside = property.children().filter(|child| child.local_name() != "value");
    inside.map(|child| Proposal::new(child.name(), ProposalKind::Class, range)).collect()
}

/// Environment variables: one named after the composite and the property, then those that there are.
pub(super) fn variables(scene: &Scene, property: ElementId, range: &Range<usize>) -> Vec<Proposal> {
    let file = scene.file();
    let is_root = file.element(property).parent().is_none();
    let name = file.element(property).value("name").map(|at| &file.text[at]);
    let composite = file.outline.name.as_ref().map(|one| one.text.as_str());
    // Where it is not that of a property, it is for the token of alerts.
    let usual =
        composite.zip(name.filter(|_| !is_root).or(is_root.then_some("alert token"))).map(|(composite, name)| {
            let joined = format!("{composite}_{name}").to_uppercase();
            joined.replace(|c: char| !c.is_ascii_alphanumeric(), "_")
        });
    let one = |name: &str| Proposal::new(name, ProposalKind::Constant, range);
    let mut all: Vec<Proposal> =
        usual.iter().map(|name| one(name).detail("named after the property").rank(0)).collect();
    let present = std::env::vars_os().filter_map(|(name, _)| name.into_string().ok());
    let free = present.filter(|name| usual.as_ref() != Some(name) && !name.contains(['&', '<', '"', '\'']));
    all.extend(free.map(|name| one(&name)));
    all
}
