//! Attributes.

use std::ops::Range;

use super::ProposalKind;
use saoms_lang::load::vocabulary::{Known, own_attributes};
use saoms_lang::model::{SAOMS_NAMESPACE, Version};
use saoms_lang::syntax::{Attribute, Element, ElementId};

use super::{Proposal, value};
use crate::editor::describe;
use crate::editor::scene::Scene;
use crate::editor::syntax::{Places, bytes, root_name_end, version};

/// The attributes that an element can still get.
pub(super) fn complete(scene: &Scene, element: Element<'_>, name: &Range<usize>) -> Vec<Proposal> {
    let file = scene.file();
    let Some(kind) = file.kind(element.id()) else { return Vec::new() };
    let is_here = |one: &Attribute<'_>| bytes(one.name_span()) == *name;
    // One that has its value already gets another name and nothing else.
    let has_value = element.written_attributes().any(|one| is_here(&one) && one.has_value());
    let is_taken = |written: &str| element.written_attributes().any(|one| !is_here(&one) && one.name() == written);
    let version = version(&file.document);
    let own = Own::at(scene, element.id());
    let added = own.iter().flat_map(|own| {
        let free = own_attributes(kind).map(|known| (format!("{}:{}", own.prefix, known.name), known));
        let free = free.filter(|(written, _)| !is_taken(written));
        free.map(|(written, known)| own.bound(attribute(written, known, has_value, name)))
    });
    let all = kind.of(version).map(|known| (known.name.to_owned(), known));
    let free = all.filter(|(written, _)| !is_taken(written));
    free.map(|(written, known)| attribute(written, known, has_value, name)).chain(added).collect()
}

/// The prefix of the namespace of SAOMS at an element.
pub(super) struct Own<'s> {
    pub(super) prefix: &'s str,
    /// The place for a missing declaration.
    at: Option<usize>,
}

impl<'s> Own<'s> {
    /// `None` where the usual prefix means something else.
    pub(super) fn at(scene: &'s Scene, element: ElementId) -> Option<Self> {
        let element = scene.file().element(element);
        if let Some(prefix) = element.prefix_of(SAOMS_NAMESPACE).filter(|own| !own.is_empty()) {
            return Some(Self { prefix, at: None });
        }
        let is_free = element.resolve_prefix("saoms").is_none();
        is_free.then(|| Self { prefix: "saoms", at: root_name_end(&scene.file().document) })
    }

    /// A proposal that has the prefix, with its declaration where that is lacking.
    pub(super) fn bound(&self, one: Proposal) -> Proposal {
        match self.at {
            Some(at) => one.also(at, format!(" xmlns:{}=\"{SAOMS_NAMESPACE}\"", self.prefix)),
            None => one,
        }
    }
}

fn attribute(written: String, known: &Known, has_value: bool, range: &Range<usize>) -> Proposal {
    let text = if has_value { written.clone() } else { format!("{written}=\"$1\"") };
    let one = Proposal::new(written, ProposalKind::Field, range)
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
