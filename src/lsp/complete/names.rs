//! Names: of classes, properties, services, loops, composites.

use std::collections::BTreeSet;
use std::ops::Range;

use lsp_types::CompletionItemKind;
use saoms_core::diagnostic::codes;
use saoms_core::expression::is_name;
use saoms_core::registry::{ClassDeclaration, InterfaceDeclaration, PropertyDeclaration};

use super::Proposal;
use crate::lsp::describe;
use crate::lsp::expressions::INDEX;
use crate::lsp::outline::{Component, Loop, Named};
use crate::lsp::scene::Scene;

/// Fixed values.
pub(super) fn words(words: &[&str], range: &Range<usize>) -> Vec<Proposal> {
    let all = words.iter().zip(0..);
    all.map(|(word, rank)| Proposal::new(*word, CompletionItemKind::ENUM_MEMBER, range).rank(rank)).collect()
}

/// The codes of diagnostics, those of rules over fleets included.
pub(super) fn codes(scene: &Scene, range: &Range<usize>) -> Vec<Proposal> {
    let of_rules = scene.registry.rules().iter().map(|rule| rule.code());
    let all = codes::ALL.iter().copied().chain(of_rules);
    all.map(|code| {
        let one = Proposal::new(code.id, CompletionItemKind::ENUM_MEMBER, range);
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
        Proposal::new(class.name(), CompletionItemKind::CLASS, range)
            .detail(kind)
            .doc(describe::class(class))
            // The manual's own names are for its own files.
            .rank(if class.is_alias() { 6 } else { 5 })
    })
    .collect()
}

/// The properties that a component, or a loop, has not been given yet. One that the cursor is in counts as not given.
pub(super) fn properties(scene: &Scene, element: usize, range: &Range<usize>) -> Vec<Proposal> {
    let file = scene.file();
    let Some(parent) = file.tree.elements[element].parent else { return Vec::new() };
    let given: Vec<&str> = given(scene, parent, element);
    let mut all: Vec<Proposal> = declared(scene, parent)
        .into_iter()
        .filter(|(one, _)| !given.contains(&one.name.as_str()))
        .map(|(one, preset)| {
            Proposal::new(&one.name, CompletionItemKind::PROPERTY, range)
                .detail(describe::facts(one, preset))
                .doc(describe::property(one, preset))
                .rank(if one.required && preset.is_none() { 1 } else { 5 })
        })
        .collect();
    if let Some(component) = scene.component_around(parent) {
        for inner in scene.inside(0, component) {
            let declared = &scene.files[inner].outline.properties;
            let open = declared.iter().filter(|one| !given.contains(&one.text.as_str()));
            all.extend(open.map(|one| Proposal::new(&one.text, CompletionItemKind::PROPERTY, range)));
        }
    }
    all
}

/// The declared properties that a component lacks, each with what its class's name presets.
pub(super) fn missing_properties(
    scene: &Scene,
    component: usize,
) -> Vec<(&PropertyDeclaration, Option<&str>)> {
    let given = given(scene, component, component);
    let all = declared(scene, component).into_iter();
    all.filter(|(one, preset)| preset.is_none() && !given.contains(&one.name.as_str())).collect()
}

/// The names of the properties in an element, but for that of one of them.
fn given(scene: &Scene, parent: usize, except: usize) -> Vec<&str> {
    let file = scene.file();
    let others = file.tree.children(parent).filter(|child| *child != except);
    let named = others.filter(|child| file.tree.local(&file.text, *child) == "property");
    named.filter_map(|child| Some(&file.text[file.tree.value(&file.text, child, "name")?])).collect()
}

/// The properties that an element, a component or a loop, can be given.
pub(in crate::lsp) fn declared(scene: &Scene, element: usize) -> Vec<(&PropertyDeclaration, Option<&str>)> {
    declared_in(scene, 0, element)
}

/// The same of any file.
pub(super) fn declared_in(
    scene: &Scene,
    file: usize,
    element: usize,
) -> Vec<(&PropertyDeclaration, Option<&str>)> {
    let Some(component) = scene.component_in(file, element) else { return Vec::new() };
    if let Some(one) = component.loops.iter().find(|one| one.name.element == element) {
        let class = loop_class(scene, component, one);
        let class = class.and_then(|class| scene.registry.get_loop(&class));
        return class
            .into_iter()
            .flat_map(|class| &class.declaration().properties)
            .map(|one| (one, None))
            .collect();
    }
    let Some(class) = scene.class(component) else { return Vec::new() };
    let all = describe::properties(class.declaration());
    all.map(|one| (one, describe::preset(class, &one.name))).collect()
}

/// The class of a loop: what the element says, or what the component's class has under this name.
pub(in crate::lsp) fn loop_class(scene: &Scene, component: &Component, one: &Loop) -> Option<String> {
    if let Some(class) = &one.class {
        return Some(class.text.clone());
    }
    default_loops(scene, component)
        .into_iter()
        .find(|(short, _)| *short == one.name.text)
        .map(|(_, class)| class)
}

/// The loops that the class of a component has, in every list of it: their short names and their classes.
pub(in crate::lsp) fn default_loops(scene: &Scene, component: &Component) -> Vec<(String, String)> {
    let Some(class) = scene.class(component) else { return Vec::new() };
    let mut all: Vec<(String, String)> = Vec::new();
    for name in class.declaration().loops.all().flat_map(|(_, names)| names) {
        let short = name.rsplit('.').next().unwrap_or(name).to_owned();
        if !all.iter().any(|(_, known)| known == name) {
            all.push((short, name.clone()));
        }
    }
    all
}

/// The names of loops: for `name` those that can be changed, for `before` and `after` all others.
pub(super) fn loops(scene: &Scene, element: usize, attribute: &str, range: &Range<usize>) -> Vec<Proposal> {
    let Some(component) = scene.component_around(element) else { return Vec::new() };
    let mut all: Vec<Proposal> = default_loops(scene, component)
        .into_iter()
        .map(|(short, class)| {
            let doc = scene.registry.get_loop(&class).map(|one| describe::looping(one));
            Proposal::new(short, CompletionItemKind::FUNCTION, range)
                .detail(class)
                .doc(doc.unwrap_or_default())
        })
        .collect();
    if attribute != "name" {
        let added =
            component.loops.iter().filter(|one| one.name.element != element && !one.name.text.is_empty());
        for one in added {
            if !all.iter().any(|known| known.label == one.name.text) {
                all.push(Proposal::new(&one.name.text, CompletionItemKind::FUNCTION, range));
            }
        }
    }
    all
}

/// The loops of the registry; those that work on the component's knowledge, or on any, first.
pub(super) fn loop_classes(scene: &Scene, element: usize, range: &Range<usize>) -> Vec<Proposal> {
    let class = scene.component_around(element).and_then(|component| scene.class(component));
    let knowledge = class.and_then(|class| class.declaration().knowledge.as_ref()).map(|one| &one.name);
    let all = scene.registry.loops();
    all.map(|one| {
        let declaration = one.declaration();
        let fits = declaration.knowledge.is_none() || declaration.knowledge.as_ref() == knowledge;
        Proposal::new(one.name(), CompletionItemKind::FUNCTION, range)
            .detail(declaration.doc.split('.').next().unwrap_or_default())
            .doc(describe::looping(one))
            .rank(if fits { 4 } else { 8 })
    })
    .collect()
}

/// The services of the class, or of the composite inside, of the component that an element is in.
pub(super) fn services(scene: &Scene, element: usize, range: &Range<usize>) -> Vec<Proposal> {
    let component = scene.component_around(element);
    component.map_or_else(Vec::new, |component| services_of(scene, (0, component), range))
}

/// Its references.
pub(super) fn references(scene: &Scene, element: usize, range: &Range<usize>) -> Vec<Proposal> {
    let component = scene.component_around(element);
    component.map_or_else(Vec::new, |component| references_of(scene, (0, component), range))
}

/// The services of a component of a file.
pub(super) fn services_of(scene: &Scene, of: (usize, &Component), range: &Range<usize>) -> Vec<Proposal> {
    let declared = scene.class(of.1).map(|class| class.declaration().offers());
    let declared = declared.into_iter().flatten().map(|one| (one.name.clone(), &one.interface, ""));
    contracts(declared, inner(scene, of, |file| &scene.files[file].outline.services), range)
}

/// The references of a component of a file.
pub(super) fn references_of(scene: &Scene, of: (usize, &Component), range: &Range<usize>) -> Vec<Proposal> {
    let declared = scene.class(of.1).into_iter().flat_map(|class| &class.declaration().references);
    let declared = declared.map(|one| {
        let more = match (one.optional, one.many) {
            (true, true) => ", optional, many",
            (true, false) => ", optional",
            (false, true) => ", many",
            (false, false) => "",
        };
        (one.name.clone(), &one.interface, more)
    });
    contracts(declared, inner(scene, of, |file| &scene.files[file].outline.references), range)
}

fn inner<'s>(
    scene: &'s Scene,
    (file, component): (usize, &Component),
    parts: impl Fn(usize) -> &'s Vec<Named>,
) -> Vec<&'s Named> {
    scene.inside(file, component).into_iter().flat_map(parts).collect()
}

fn contracts<'d>(
    declared: impl Iterator<Item = (String, &'d InterfaceDeclaration, &'d str)>,
    inner: Vec<&Named>,
    range: &Range<usize>,
) -> Vec<Proposal> {
    let declared = declared.map(|(name, interface, more)| {
        Proposal::new(name, CompletionItemKind::INTERFACE, range).detail(format!("{}{more}", interface.name))
    });
    let inner = inner.into_iter().map(|one| Proposal::new(&one.text, CompletionItemKind::INTERFACE, range));
    declared.chain(inner).collect()
}

/// The interfaces that classes declare; the one that the service or the reference has by its class comes first.
pub(super) fn interfaces(scene: &Scene, element: usize, range: &Range<usize>) -> Vec<Proposal> {
    let file = scene.file();
    let own = file.tree.elements[element].parent.and_then(|contract| {
        let name = &file.text[file.tree.value(&file.text, contract, "name")?];
        let class = scene.class(scene.component_around(contract)?)?.declaration();
        let service = class.offers().find(|one| one.name == name).map(|one| &one.interface.name);
        service.or_else(|| Some(&class.references.iter().find(|one| one.name == name)?.interface.name))
    });
    let all: BTreeSet<&str> =
        scene.registry.iter().flat_map(|class| interfaces_of(class.declaration())).collect();
    let rank = |name: &str| if own.is_some_and(|own| own == name) { 0 } else { 5 };
    all.iter()
        .map(|name| Proposal::new(*name, CompletionItemKind::INTERFACE, range).rank(rank(name)))
        .collect()
}

fn interfaces_of(class: &ClassDeclaration) -> impl Iterator<Item = &str> {
    let references = class.references.iter().map(|one| &one.interface);
    class.offers().map(|one| &one.interface).chain(references).map(|one| one.name.as_str())
}

/// The composites that a file can name, with the prefix of their namespace.
pub(super) fn composites(scene: &Scene, element: usize, range: &Range<usize>) -> Vec<Proposal> {
    let file = scene.file();
    let others = scene.files.iter().enumerate().skip(1);
    others
        .filter_map(|(place, other)| {
            let name = other.outline.name.as_ref()?;
            let namespace = &other.outline.namespace;
            let prefix =
                file.tree.prefix_of(&file.text, element, namespace).filter(|prefix| !prefix.is_empty());
            let written =
                prefix.map_or_else(|| name.text.clone(), |prefix| format!("{prefix}:{}", name.text));
            // A name that would lead elsewhere, or nowhere, is of no use.
            let meant = Named { element, text: written.clone(), at: range.clone() };
            let leads = scene.composite(0, &meant) == Some(place);
            let shown = other.path.file_name().unwrap_or_default().to_string_lossy().into_owned();
            leads.then(|| {
                Proposal::new(written, CompletionItemKind::MODULE, range)
                    .detail(shown)
                    .doc(format!("`{namespace}`"))
            })
        })
        .collect()
}

/// The namespaces of the composites around a file.
pub(super) fn namespaces(scene: &Scene, range: &Range<usize>) -> Vec<Proposal> {
    let others = scene.files.iter().skip(1).map(|other| other.outline.namespace.as_str());
    let others: BTreeSet<&str> = others.filter(|name| !name.is_empty()).collect();
    others.into_iter().map(|name| Proposal::new(name, CompletionItemKind::MODULE, range)).collect()
}

/// The name of a file, which its composite as a rule has as well.
pub(super) fn of_file(scene: &Scene, range: &Range<usize>) -> Vec<Proposal> {
    let stem = scene.file().path.file_stem().and_then(|stem| stem.to_str());
    let fits = stem.filter(|stem| !stem.contains(|c: char| c.is_whitespace() || "/&<\"'".contains(c)));
    let one = |stem| Proposal::new(stem, CompletionItemKind::MODULE, range).detail("the name of the file");
    fits.map(one).into_iter().collect()
}

/// The names of what a service or a reference of the composite promotes.
pub(super) fn promoted(scene: &Scene, element: usize, range: &Range<usize>) -> Vec<Proposal> {
    let ends = scene.file().outline.ends.iter().filter(|end| end.component.element == element);
    let names: BTreeSet<&str> = ends.filter_map(|end| Some(end.part.as_ref()?.text.as_str())).collect();
    names.into_iter().map(|name| Proposal::new(name, CompletionItemKind::INTERFACE, range)).collect()
}

/// `$name` of each property of the composite.
pub(super) fn sources(scene: &Scene, range: &Range<usize>) -> Vec<Proposal> {
    of_parameters(scene, "$", range)
}

/// The names of expressions: the properties of the composite, each with its value, and the index of a component that is replicated.
pub(super) fn parameters(
    scene: &Scene,
    replicated: Option<&Component>,
    range: &Range<usize>,
) -> Vec<Proposal> {
    let mut all = of_parameters(scene, "", range);
    all.retain(|one| is_name(&one.label));
    all.extend(replicated.map(|_| {
        Proposal::new(INDEX, CompletionItemKind::VARIABLE, range)
            .detail("what replicas are counted by")
            .rank(4)
    }));
    all
}

fn of_parameters(scene: &Scene, sign: &str, range: &Range<usize>) -> Vec<Proposal> {
    let of_file = |file: usize| scene.files[file].outline.properties.iter().map(move |one| (file, one));
    let all = scene.unit_of(0).iter().flat_map(|file| of_file(*file));
    all.map(|(file, one)| {
        let given = scene.value_of(file, one.element).unwrap_or_default();
        Proposal::new(format!("{sign}{}", one.text), CompletionItemKind::CONSTANT, range).detail(given)
    })
    .collect()
}
