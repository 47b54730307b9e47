//! Names: of classes, properties, services, loops, composites.

use std::collections::{BTreeSet, HashSet};
use std::ops::Range;

use super::ProposalKind;
use saoms_lang::diagnostic::codes;
use saoms_lang::expression::is_name;
use saoms_lang::registry::{ClassDeclaration, PropertyDeclaration};
use saoms_lang::syntax::{Element, ElementId};

use super::Proposal;
use crate::editor::describe;
use crate::editor::scene::Scene;
use crate::editor::scene::contracts::Contract;
use crate::editor::scene::expressions::INDEX;
use crate::editor::scene::outline::{Component, Loop, Named, Side};
use crate::editor::syntax::{Places, root_name_end};

/// Fixed values.
pub(super) fn words(words: &[&str], range: &Range<usize>) -> Vec<Proposal> {
    let all = words.iter().zip(0..);
    all.map(|(word, rank)| Proposal::new(*word, ProposalKind::EnumMember, range).rank(rank)).collect()
}

/// The codes of diagnostics, those of rules over fleets included.
pub(super) fn codes(scene: &Scene, range: &Range<usize>) -> Vec<Proposal> {
    let of_rules = scene.registry.rules().iter().map(|rule| rule.code());
    let all = codes::ALL.iter().copied().chain(of_rules);
    all.map(|code| {
        let one = Proposal::new(code.id, ProposalKind::EnumMember, range);
        one.detail(format!("{}: {}", code.severity.name(), code.name)).doc(describe::code(code, code.rule))
    })
    .collect()
}

/// The word of a value that a byte touches.
pub(super) fn word_at(text: &str, value: Range<usize>, at: usize) -> Range<usize> {
    let is_part = |c: char| c.is_alphanumeric() || "_-.".contains(c);
    let before = text[value.start..at].trim_end_matches(is_part).len();
    let after = text[at..value.end].len() - text[at..value.end].trim_start_matches(is_part).len();
    value.start + before..at + after
}

pub(super) fn classes(scene: &Scene, range: &Range<usize>) -> Vec<Proposal> {
    let all = scene.registry.iter();
    all.map(|class| {
        let kind = if class.declaration().is_periodic() { "periodic" } else { "passive" };
        Proposal::new(class.name(), ProposalKind::Class, range)
            .detail(kind)
            .doc(describe::class(class))
            // Those of larger packages are for files of theirs, as the manual's own names are.
            .rank(if class.is_alias() { 9 } else { 4 + class.name().matches('.').count().min(4) as u8 })
    })
    .collect()
}

/// The properties that a component, or a loop, has not been given yet. One that the cursor is in counts as not given.
pub(super) fn properties(scene: &Scene, element: ElementId, range: &Range<usize>) -> Vec<Proposal> {
    let file = scene.file();
    let Some(parent) = file.element(element).parent().map(Element::id) else { return Vec::new() };
    let given = given(scene, parent, element);
    let mut all: Vec<Proposal> = declared(scene, parent)
        .into_iter()
        .filter(|(one, _)| !given.contains(one.name.as_str()))
        .map(|(one, preset)| {
            Proposal::new(&one.name, ProposalKind::Property, range)
                .detail(describe::facts(one, preset))
                .doc(describe::property(one, preset))
                .rank(if one.required && preset.is_none() { 1 } else { 5 })
        })
        .collect();
    if let Some(component) = scene.component_around(parent) {
        for inner in scene.inside(0, component) {
            let declared = &scene.files[*inner].outline.properties;
            let open = declared.iter().filter(|one| !given.contains(one.text.as_str()));
            all.extend(open.map(|one| Proposal::new(&one.text, ProposalKind::Property, range)));
        }
    }
    all
}

/// The declared properties that a component lacks, each with what its class's name presets.
pub(super) fn missing_properties(scene: &Scene, component: ElementId) -> Vec<(&PropertyDeclaration, Option<&str>)> {
    let given = given(scene, component, component);
    let all = declared(scene, component).into_iter();
    all.filter(|(one, preset)| preset.is_none() && !given.contains(one.name.as_str())).collect()
}

/// The names of the properties in an element, but for that of one of them.
fn given(scene: &Scene, parent: ElementId, except: ElementId) -> HashSet<&str> {
    let file = scene.file();
    let others = file.element(parent).children().filter(|child| child.id() != except);
    let named = others.filter(|child| child.local_name() == "property");
    named.filter_map(|child| Some(&file.text[child.value("name")?])).collect()
}

/// The properties that an element, a component or a loop, can be given.
pub(crate) fn declared(scene: &Scene, element: ElementId) -> Vec<(&PropertyDeclaration, Option<&str>)> {
    declared_in(scene, 0, element)
}

/// The same of any file.
pub(super) fn declared_in(scene: &Scene, file: usize, element: ElementId) -> Vec<(&PropertyDeclaration, Option<&str>)> {
    let Some(component) = scene.component_in(file, element) else { return Vec::new() };
    if let Some(one) = component.loops.iter().find(|one| one.name.element == element) {
        let class = scene.class_of_loop((file, component), one);
        let class = class.and_then(|class| scene.registry.get_loop(&class));
        return class.into_iter().flat_map(|class| &class.declaration().properties).map(|one| (one, None)).collect();
    }
    let Some(class) = scene.class(component) else { return Vec::new() };
    let all = describe::properties(class.declaration());
    all.map(|one| (one, describe::preset(class, &one.name))).collect()
}

/// The names of loops: for `name` those that can be changed and are not yet, for `before` and `after` all others.
pub(super) fn loops(scene: &Scene, element: ElementId, attribute: &str, range: &Range<usize>) -> Vec<Proposal> {
    let Some(component) = scene.component_around(element) else { return Vec::new() };
    let is_own = |one: &&Loop| one.name.element == element;
    let others: Vec<&str> =
        component.loops.iter().filter(|one| !is_own(one)).map(|one| one.name.text.as_str()).collect();
    let own = component.loops.iter().find(is_own).map_or("", |one| &one.name.text);
    let names_itself = attribute == "name";
    let defaults = scene.default_loops((0, component));
    let is_open = |short: &str| if names_itself { !others.contains(&short) } else { short != own };
    let of_class = defaults.iter().filter(|(short, _)| is_open(short)).map(|(short, class)| {
        let doc = scene.registry.get_loop(class).map(|one| describe::looping(one));
        Proposal::new(*short, ProposalKind::Function, range).detail(*class).doc(doc.unwrap_or_default())
    });
    let is_new = |name: &&str| !name.is_empty() && defaults.iter().all(|(short, _)| short != name);
    let added = others.iter().filter(|name| !names_itself && is_new(name));
    of_class.chain(added.map(|name| Proposal::new(*name, ProposalKind::Function, range))).collect()
}

/// The loops of the registry; those that work on the component's knowledge, or on any, first.
pub(super) fn loop_classes(scene: &Scene, element: ElementId, range: &Range<usize>) -> Vec<Proposal> {
    let class = scene.component_around(element).and_then(|component| scene.class(component));
    let knowledge = class.and_then(|class| class.declaration().knowledge.as_ref()).map(|one| &one.name);
    let all = scene.registry.loops();
    all.map(|one| {
        let declaration = one.declaration();
        let fits = declaration.knowledge.is_none() || declaration.knowledge.as_ref() == knowledge;
        Proposal::new(one.name(), ProposalKind::Function, range)
            .detail(declaration.doc.split('.').next().unwrap_or_default())
            .doc(describe::looping(one))
            .rank(if fits { 4 } else { 8 })
    })
    .collect()
}

/// The services or references of the component that an element is in which nothing is said about yet.
pub(super) fn parts(scene: &Scene, element: ElementId, side: Side, range: &Range<usize>) -> Vec<Proposal> {
    let Some(component) = scene.component_around(element) else { return Vec::new() };
    let named = if side == Side::Service { &component.services } else { &component.references };
    let others = named.iter().filter(|one| one.element != element);
    let said: HashSet<&str> = others.map(|one| one.text.as_str()).collect();
    let all = scene.contracts((0, component), side).unwrap_or_default();
    contracts(all.into_iter().filter(|one| !said.contains(one.name)), range)
}

/// Services or references, each with its interface and how many targets it takes.
pub(super) fn contracts<'s>(all: impl Iterator<Item = Contract<'s>>, range: &Range<usize>) -> Vec<Proposal> {
    all.map(|one| {
        let interface = one.interface.map(|interface| interface.name.as_str());
        let facts: Vec<&str> = interface.into_iter().chain(one.multiplicity).collect();
        Proposal::new(one.name, ProposalKind::Interface, range).detail(facts.join(", ")).rank(if one.is_of_host {
            6
        } else {
            5
        })
    })
    .collect()
}

/// The interfaces that classes declare; the one that the service or the reference has by its class comes first.
pub(super) fn interfaces(scene: &Scene, element: ElementId, range: &Range<usize>) -> Vec<Proposal> {
    let file = scene.file();
    let own = file.element(element).parent().and_then(|contract| {
        let name = &file.text[contract.value("name")?];
        let of = (0, scene.component_around(contract.id())?);
        let found = [Side::Service, Side::Reference].into_iter().find_map(|side| scene.contract(of, side, name));
        Some(&found?.interface?.name)
    });
    let all: BTreeSet<&str> = scene.registry.iter().flat_map(|class| interfaces_of(class.declaration())).collect();
    let rank = |name: &str| if own.is_some_and(|own: &String| own == name) { 0 } else { 5 };
    all.iter().map(|name| Proposal::new(*name, ProposalKind::Interface, range).rank(rank(name))).collect()
}

fn interfaces_of(class: &ClassDeclaration) -> impl Iterator<Item = &str> {
    let references = class.references.iter().map(|one| &one.interface);
    class.offers().map(|one| &one.interface).chain(references).map(|one| one.name.as_str())
}

/// The composites that a file can name, with the prefix of their namespace. Where the file has none for it, one is
/// declared at its root.
pub(super) fn composites(scene: &Scene, element: ElementId, range: &Range<usize>) -> Vec<Proposal> {
    let file = scene.file();
    let deployed = file.outline.deployables.iter().filter(|one| one.element != element);
    let deployed: Vec<usize> = deployed.filter_map(|one| scene.composite(0, one)).collect();
    let root = root_name_end(&file.document);
    let default = file.element(element).resolve_prefix("");
    // What a contribution runs is its own.
    let is_hidden = |place: usize| scene.imports_this(place) || file.is_description() && scene.is_imported(place);
    let others = scene.files.iter().enumerate().skip(1).filter(|(place, _)| !is_hidden(*place));
    others
        .filter_map(|(place, other)| {
            let name = &other.outline.name.as_ref()?.text;
            let namespace = &other.outline.namespace;
            let bound = file.element(element).prefix_of(namespace).filter(|prefix| !prefix.is_empty());
            let written = bound.map_or_else(|| name.clone(), |prefix| format!("{prefix}:{name}"));
            // Without a prefix it is of the default namespace.
            let is_plain = namespace.is_empty() || default == Some(namespace);
            // A name that would lead elsewhere, or nowhere, is of no use.
            let meant = Named { element, text: written.clone(), at: range.clone() };
            let leads = scene.composite(0, &meant) == Some(place);
            let shown = other.path.file_name().unwrap_or_default().to_string_lossy();
            let one = |written: String| {
                Proposal::new(written, ProposalKind::Module, range).detail(shown).doc(format!("`{namespace}`"))
            };
            match root {
                _ if deployed.contains(&place) => None,
                _ if leads && (bound.is_some() || is_plain) => Some(one(written)),
                Some(root) if bound.is_none() && !is_plain => {
                    let is_own = *namespace == file.outline.namespace;
                    let prefix = free_prefix(scene, element, if is_own { "tns" } else { namespace });
                    let declaration = format!(" xmlns:{prefix}=\"{namespace}\"");
                    let rank = if is_own { 5 } else { 6 };
                    Some(one(format!("{prefix}:{name}")).also(root, declaration).rank(rank))
                }
                _ => None,
            }
        })
        .collect()
}

/// A prefix for a namespace that a file has not bound: the last word of it, as `fleet` of `urn:example:fleet`.
fn free_prefix(scene: &Scene, element: ElementId, namespace: &str) -> String {
    let file = scene.file();
    let is_part = |c: char| c.is_ascii_alphanumeric() || "_-.".contains(c);
    let mut words = namespace.rsplit(|c: char| !is_part(c));
    let fits = |word: &&str| word.starts_with(|c: char| c.is_ascii_alphabetic());
    let word = words.find(fits).unwrap_or("c");
    let is_free = |prefix: &String| file.element(element).resolve_prefix(prefix).is_none();
    let numbered = (2..).map(|number| format!("{word}{number}"));
    std::iter::once(word.to_owned()).chain(numbered).find(is_free).unwrap_or_default()
}

/// The namespaces of the composites around a file.
pub(super) fn namespaces(scene: &Scene, range: &Range<usize>) -> Vec<Proposal> {
    let others = scene.files.iter().skip(1).map(|other| other.outline.namespace.as_str());
    let others: BTreeSet<&str> = others.filter(|name| !name.is_empty()).collect();
    others.into_iter().map(|name| Proposal::new(name, ProposalKind::Module, range)).collect()
}

/// The name of a file, which its composite as a rule has as well.
pub(super) fn of_file(scene: &Scene, range: &Range<usize>) -> Vec<Proposal> {
    let stem = scene.file().path.file_stem().and_then(|stem| stem.to_str());
    let fits = stem.filter(|stem| !stem.contains(|c: char| c.is_whitespace() || "/&<\"'".contains(c)));
    let one = |stem| Proposal::new(stem, ProposalKind::Module, range).detail("the name of the file");
    fits.map(one).into_iter().collect()
}

/// The names of what a service or a reference of the composite promotes.
pub(super) fn promoted(scene: &Scene, element: ElementId, range: &Range<usize>) -> Vec<Proposal> {
    let ends = scene.file().outline.ends.iter().filter(|end| end.component.element == element);
    let names: BTreeSet<&str> = ends.filter_map(|end| Some(end.part.as_ref()?.text.as_str())).collect();
    names.into_iter().map(|name| Proposal::new(name, ProposalKind::Interface, range)).collect()
}

/// `$name` of each property of the composite.
pub(super) fn sources(scene: &Scene, range: &Range<usize>) -> Vec<Proposal> {
    of_composite(scene, 0, "$", range)
}

/// The names of expressions: the properties of the composite, each with its value, and the index of a component that is
/// replicated.
pub(super) fn parameters(scene: &Scene, replicated: Option<&Component>, range: &Range<usize>) -> Vec<Proposal> {
    parameters_of(scene, 0, replicated, range)
}

/// The same for a composite in another file.
pub(super) fn parameters_of(
    scene: &Scene,
    file: usize,
    replicated: Option<&Component>,
    range: &Range<usize>,
) -> Vec<Proposal> {
    let mut all = of_composite(scene, file, "", range);
    all.retain(|one| is_name(&one.label));
    all.extend(
        replicated
            .map(|_| Proposal::new(INDEX, ProposalKind::Variable, range).detail("the number of a replica").rank(4)),
    );
    all
}

fn of_composite(scene: &Scene, file: usize, sign: &str, range: &Range<usize>) -> Vec<Proposal> {
    let of_file = |file: usize| scene.files[file].outline.properties.iter().map(move |one| (file, one));
    let all = scene.unit_of(file).iter().flat_map(|file| of_file(*file));
    all.map(|(file, one)| {
        let given = scene.value_of(file, one.element).unwrap_or_default();
        Proposal::new(format!("{sign}{}", one.text), ProposalKind::Constant, range).detail(given)
    })
    .collect()
}
