//! Elements and end tags.

use std::ops::Range;

use super::ProposalKind;
use saoms_lang::load::vocabulary::{
    COMPONENT, COMPOSITE, CONTRIBUTION, Kind, LOOP, OWN_ELEMENTS, SEVERITY, SEVERITY_PARENTS, children, other,
};
use saoms_lang::model::Version;
use saoms_lang::syntax::Element;

use super::attributes::Own;
use super::completion::in_snippet;
use super::{Proposal, names};
use crate::editor::describe;
use crate::editor::scene::Scene;
use crate::editor::syntax::{Places, prefix, root as root_of};

/// Those that most files have come first.
const USUAL: &[&str] = &[
    "deployable", "implementation.java", "implementation.composite", "component", "property", "reference", "service",
    "wire", "include",
];

/// The names behind a `<`.
pub(super) fn in_tag(
    scene: &Scene,
    parent: Option<Element<'_>>,
    element: Option<Element<'_>>,
    name: &Range<usize>,
) -> Vec<Proposal> {
    // An element that has its attributes or its end gets another name and nothing else.
    let is_new = element.is_none_or(|one| !one.has_whole_start_tag() && one.written_attributes().next().is_none());
    let start = element.map_or(name.start - 1, |one| one.tag().start);
    let range = start..name.end;
    let found = proposals(scene, parent, &range);
    if is_new {
        return found;
    }
    let plain = found.into_iter().filter(|one| !one.label.contains(' '));
    plain.map(|one| one.renaming(name)).collect()
}

/// Elements at a place without a `<`.
pub(super) fn in_content(scene: &Scene, parent: Option<Element<'_>>, at: usize) -> Vec<Proposal> {
    proposals(scene, parent, &(at..at))
}

/// The end tag of an element.
pub(super) fn end(scene: &Scene, element: Option<Element<'_>>, name: &Range<usize>, at: usize) -> Vec<Proposal> {
    let file = scene.file();
    let Some(element) = element else { return Vec::new() };
    let wanted = element.name();
    let close = if file.text[name.end..].trim_start().starts_with('>') { "" } else { ">" };
    let range = name.start..name.end.max(at);
    vec![Proposal::new(wanted, ProposalKind::Class, &range).insert(format!("{wanted}{close}"))]
}

fn proposals(scene: &Scene, parent: Option<Element<'_>>, range: &Range<usize>) -> Vec<Proposal> {
    let file = scene.file();
    let Some(parent) = parent else {
        let has_root = root_of(&file.document).is_some_and(|one| one.tag().start != range.start);
        return if has_root { Vec::new() } else { vec![root(scene, range)] };
    };
    let Some(kind) = file.kind(parent.id()) else { return Vec::new() };
    let sca = prefix(file.document.root().name());
    let has_implementation = parent
        .children()
        .any(|child| child.local_name().starts_with("implementation.") && child.tag().start != range.start);
    let fits = |name: &&str| !(has_implementation && name.starts_with("implementation."));
    let mut all: Vec<Proposal> =
        children(kind).filter(fits).map(|name| element(kind, name, &format!("{sca}{name}"), range)).collect();
    if std::ptr::eq(kind, &COMPONENT) {
        all.extend(names::missing_properties(scene, parent.id()).into_iter().map(|(one, preset)| {
            let name = format!("{sca}property {}", one.name);
            let value = in_snippet(one.default.as_deref().unwrap_or_default());
            let rank = if one.required { 0 } else { 6 };
            Proposal::new(name, ProposalKind::Property, range)
                .detail(describe::facts(one, preset))
                .doc(describe::property(one, preset))
                .rank(rank)
                .snippet(format!("<{sca}property name=\"{}\">${{1:{value}}}</{sca}property>", one.name))
        }));
    }
    if let Some(own) = Own::at(scene, parent.id()) {
        if std::ptr::eq(kind, &COMPONENT) {
            all.push(added(&LOOP, &own, "name=\"$1\"$2", range));
        }
        if SEVERITY_PARENTS.contains(&kind.name) {
            all.push(added(&SEVERITY, &own, "code=\"$1\" level=\"$2\" reason=\"$3\"", range));
        }
    }
    all
}

/// An element that SAOMS adds and SCA's names do not have.
fn added(kind: &'static Kind, own: &Own<'_>, attributes: &str, range: &Range<usize>) -> Proposal {
    debug_assert!(OWN_ELEMENTS.contains(&kind.name));
    let name = format!("{}:{}", own.prefix, kind.name);
    let snippet = format!("<{name} {attributes}/>");
    own.bound(Proposal::new(name, ProposalKind::Class, range).doc(describe::element(kind)).snippet(snippet))
}

fn element(parent: &'static Kind, name: &'static str, written: &str, range: &Range<usize>) -> Proposal {
    let kind = parent.child(name);
    let doc = match kind {
        Some(kind) => describe::element(kind),
        None => other(name).unwrap_or_default().to_owned(),
    };
    let in_composite = std::ptr::eq(parent, &COMPOSITE);
    let in_description = std::ptr::eq(parent, &CONTRIBUTION);
    let first_attribute = kind.and_then(|kind| kind.attributes.first()).filter(|_| in_description);
    let snippet = match name {
        _ if let Some(known) = first_attribute => format!("<{written} {}=\"$1\"/>", known.name),
        "component" => format!("<{written} name=\"$1\">\n  $0\n</{written}>"),
        "implementation.java" | "implementation.rust" => format!("<{written} class=\"$1\"/>"),
        "implementation.composite" | "include" => format!("<{written} name=\"$1\"/>"),
        "property" => format!("<{written} name=\"$1\">$2</{written}>"),
        "reference" | "service" if in_composite => format!("<{written} name=\"$1\" promote=\"$2\"/>"),
        "reference" => format!("<{written} name=\"$1\" target=\"$2\"/>"),
        "service" | "callback" => format!("<{written} name=\"$1\">$0</{written}>"),
        "wire" => format!("<{written} source=\"$1\" target=\"$2\"/>"),
        name if name.starts_with("interface.") => format!("<{written} interface=\"$1\"/>"),
        name if name.starts_with("binding.") => format!("<{written}$0/>"),
        "value" | "documentation" => format!("<{written}>$1</{written}>"),
        _ => format!("<{written}$0/>"),
    };
    let rank = match name {
        // Classes of SAOMS come before those that Java programs have, and before whole composites.
        "implementation.rust" => 2,
        _ if USUAL.contains(&name) => 3,
        _ => 7,
    };
    let first = kind.map_or(doc.as_str(), |kind| kind.doc);
    let detail = first.split_inclusive('.').next().unwrap_or_default().trim_end_matches('.');
    Proposal::new(written, ProposalKind::Class, range).detail(detail).doc(doc.clone()).rank(rank).snippet(snippet)
}

/// The root of a new file.
fn root(scene: &Scene, range: &Range<usize>) -> Proposal {
    let namespace = Version::Oasis200912.namespace();
    let name = scene.file().path.file_name().unwrap_or_default();
    if name == "sca-contribution.xml" {
        let text = format!("<contribution xmlns=\"{namespace}\">\n  <deployable composite=\"$1\"/>\n</contribution>");
        let one = Proposal::new(CONTRIBUTION.name, ProposalKind::Class, range);
        return one.doc(describe::element(&CONTRIBUTION)).snippet(text);
    }
    Proposal::new(COMPOSITE.name, ProposalKind::Class, range).doc(describe::element(&COMPOSITE)).snippet(format!(
        "<composite xmlns=\"{namespace}\" name=\"$1\" targetNamespace=\"urn:${{2:fleet}}\">\n  $0\n</composite>"
    ))
}
