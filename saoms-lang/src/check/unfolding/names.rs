//! Names of composites and paths of components: each is there once, and leads where it means to.

use std::collections::{HashMap, HashSet};

use crate::check::fleet::Fleet;
use crate::check::report::{Report, replacing};
use crate::diagnostic::{Code, Diagnostic, Edit, Severity, codes, nearest, quoted};
use crate::model::{Composite, Missing, Naming, Version};
use crate::source::{Location, Span};
use crate::syntax::{Element, escaped, hidden_in};

/// Checks that no two components have one path. Where none is given, names alone see to that.
pub(crate) fn paths(fleet: &Fleet<'_>, report: &mut Report<'_>) {
    if fleet.members.iter().all(|member| member.component.path.is_none()) {
        return;
    }
    let mut first: HashMap<&str, Location> = HashMap::with_capacity(fleet.members.len());
    for member in fleet.members.iter().filter(|one| !one.is_partial && !one.component.name.is_empty()) {
        let given = member.component.path.as_deref();
        let place = given.unwrap_or(&member.component.name).location;
        let earlier = first.entry(member.path()).or_insert(place);
        if *earlier != place && given.is_some() {
            let message = format!("two components have the path {}", quoted(member.path()));
            let one = Diagnostic::new(&codes::COMPONENT_REPEATED, place, message);
            report.push(one.label(*earlier, "the first").help("give each its own path, or none"));
        }
    }
}

/// Checks that no two composites of one namespace have one name; the places of those that are there again, text for
/// text.
pub(crate) fn composites(composites: &[Composite], report: &mut Report<'_>) -> HashSet<usize> {
    let mut again = HashSet::new();
    let mut names: HashMap<(&str, &str), &Composite> = HashMap::new();
    let named = composites.iter().enumerate().filter(|(_, composite)| !composite.name.is_empty());
    for (place, composite) in named {
        let name = (composite.namespace(), composite.name.as_str());
        let Some(first) = names.get(&name) else {
            names.insert(name, composite);
            continue;
        };
        let message = format!("there are two composites {} in one namespace", quoted(name.1));
        let one = Diagnostic::new(&codes::COMPOSITE_REPEATED, composite.name.location, message);
        let one = one.label(first.name.location, "the first");
        report.push(one.help("give each its own name; was one file given twice?"));
        if first.document.text() == composite.document.text() {
            again.insert(place);
        }
    }
    again
}

/// True if a name means the very composite that it leads to. A name without a prefix is of the default namespace, as
/// all QNames in values are (SCA Assembly 1.1, 5.6.1 and 5.7; XML Schema 1.0, part 2, 3.2.18).
pub(crate) fn is_exact(naming: Naming<'_>, around: &Composite, found: &Composite) -> bool {
    let prefix = naming.name.split_once(':').map_or("", |(prefix, _)| prefix);
    let element = naming.origin.element(&around.document);
    match element.resolve_prefix(prefix) {
        Some(namespace) => namespace == found.namespace(),
        None => prefix.is_empty() && found.namespace().is_empty(),
    }
}

/// The warning that a name leads to a composite of another namespace than it means: other programs would not find it.
pub(crate) fn loose(naming: Naming<'_>, around: &Composite, found: &Composite) -> Diagnostic {
    let (name, element) = (naming.name, naming.origin.element(&around.document));
    let (prefix, local) = name.split_once(':').unwrap_or(("", name));
    let default = element.resolve_prefix("").unwrap_or_default();
    let why = match prefix {
        "" if default.is_empty() => format!("{} without a prefix is in no namespace", quoted(local)),
        "" if Version::from_namespace(default).is_some() => {
            format!("{} without a prefix is in the default namespace, which is that of SCA", quoted(local))
        }
        "" => format!("{} without a prefix is in the namespace {}", quoted(local), quoted(default)),
        prefix => format!("the prefix {} is not declared", quoted(prefix)),
    };
    let namespace = found.namespace();
    let taken = match namespace {
        "" => "the composite in no namespace is used".to_owned(),
        namespace => format!("the composite in {} is used", quoted(namespace)),
    };
    let message = format!("{why}: {taken}");
    let one = Diagnostic::new(code(naming, around), name.location, message).severity(Severity::Warning);
    let one = one.label(found.name.location, "this composite is used");
    if namespace.is_empty() {
        return one.help("give it a `targetNamespace`, and name it with a prefix of that namespace");
    }
    if let Some(bound) = prefix_of(namespace, element) {
        let right = format!("{bound}:{local}");
        // Names with the same prefix are wrong in the same way.
        let others = around.namings().filter_map(|other| {
            let rest = other.name.split_once(':').filter(|(of, _)| *of == prefix && !prefix.is_empty())?.1;
            let is_other = other.name.location != name.location
                && other.origin.element(&around.document).resolve_prefix(prefix).is_none();
            is_other.then(|| Edit { location: other.name.location, replacement: escaped(&format!("{bound}:{rest}")) })
        });
        let own = Edit { location: name.location, replacement: escaped(&right) };
        let edits: Vec<Edit> = std::iter::once(own).chain(others).collect();
        let more = if edits.len() > 1 { ", and the same prefix of the other names" } else { "" };
        return one.suggest_edits(format!("{}{more}", replacing(name, &right)), edits);
    }
    // Others may be bound further inside.
    let is_free = |one: &String| element.resolve_prefix(one).is_none();
    let own = if namespace == around.namespace() { "tns" } else { "ns" };
    let numbered = (1..).map(|number| format!("{own}{number}"));
    let first = if prefix.is_empty() { own } else { prefix };
    let Some(free) = std::iter::once(first.to_owned()).chain(numbered).find(is_free) else { return one };
    let declaration = format!("xmlns:{free}=\"{}\"", escaped(namespace));
    let root = around.document.root();
    let place = Span::empty(root.name_span().end).in_file(around.file());
    let mut edits = vec![Edit { location: place, replacement: format!(" {declaration}") }];
    let right = format!("{free}:{local}");
    let mut what = format!("insert {} into {}", quoted(&declaration), quoted(root.name()));
    if right != name.as_str() {
        what += &format!(", and {}", replacing(name, &right));
        edits.push(Edit { location: name.location, replacement: escaped(&right) });
    }
    one.suggest_edits(what, edits)
}

/// A prefix that is bound to a namespace at an element.
fn prefix_of<'a>(namespace: &str, at: Element<'a>) -> Option<&'a str> {
    let around = std::iter::successors(Some(at), |one| one.parent());
    let mut declared = around.flat_map(|one| one.namespace_declarations());
    declared.find_map(|one| {
        let prefix = one.name().strip_prefix("xmlns:").filter(|_| one.value() == namespace)?;
        // It may be bound to another one further inside.
        at.resolve_prefix(prefix).is_some_and(|bound| bound == namespace).then_some(prefix)
    })
}

fn code(naming: Naming<'_>, around: &Composite) -> &'static Code {
    match naming.origin.element(&around.document).local_name() {
        "include" => &codes::INCLUDE_NOT_FOUND,
        _ => &codes::COMPOSITE_NOT_FOUND,
    }
}

/// The namespace that a prefix stands for, at its declaration, and the one that is meant: where there is a composite of
/// the name.
pub(super) fn wrong_prefix<'m>(
    naming: Naming<'_>,
    missing: &'m Missing,
    around: &Composite,
) -> Option<(Location, &'m str)> {
    let (prefix, _) = naming.name.split_once(':')?;
    let meant = missing.elsewhere.as_deref().filter(|meant| missing.near.is_empty() && !meant.is_empty())?;
    let named = naming.origin.element(&around.document);
    let mut declared =
        std::iter::successors(Some(named), |one| one.parent()).flat_map(|one| one.namespace_declarations());
    let declared = declared.find(|one| one.name().strip_prefix("xmlns:") == Some(prefix))?;
    // It may be that of other composites.
    nearest(&declared.value(), [meant])?;
    Some((declared.value_span().in_file(around.file()), meant))
}

/// The fault of a name that leads nowhere.
pub(crate) fn not_found(
    naming: Naming<'_>,
    (missing, prefix): (&Missing, Option<(Location, &str)>),
    composite: &Composite,
    assume_classes: bool,
) -> Diagnostic {
    let (name, wrong_namespace) = (naming.name, prefix);
    let (namespaces, local) = composite.resolve_name(naming);
    let of = match &namespaces {
        None => String::new(),
        Some(all) => match all.first().map_or("", |namespace| namespace.as_str()) {
            "" => " in no namespace".to_owned(),
            namespace => format!(" in the namespace {}", quoted(namespace)),
        },
    };
    let message = format!("there is no composite {}{of}", quoted(local));
    let mut one = Diagnostic::new(code(naming, composite), name.location, message);
    if let Some(place) = missing.misspelt {
        one = one.label(place, "expected `targetNamespace`");
    }
    // What is spelt alike is meant; anything else may come from another contribution.
    if assume_classes && missing.near.is_empty() {
        one = one.severity(Severity::Warning);
    }
    if namespaces.is_none() {
        let prefix = name.split(':').next().unwrap_or_default();
        one = one.help(format!("the prefix {} is not declared", quoted(prefix)));
    }
    if local.ends_with(".composite") {
        one =
            one.help("write the composite's `name` with the prefix of its `targetNamespace`, not the name of its file");
    }
    // Without a prefix it is taken for one of the target namespace, which had better be said.
    let around = naming.origin.element(&composite.document);
    let of = namespaces.as_ref().and_then(|all| all.first()).filter(|_| !name.contains(':'));
    let prefix = of.and_then(|namespace| prefix_of(namespace, around));
    // A name with a character that nobody sees is not proposed, but has to be mended where it is.
    let others = missing.near.iter().chain(&missing.elsewhere);
    let hidden: Vec<(&String, String)> = others
        .filter_map(|other| {
            let (seen, sign) = hidden_in(other)?;
            Some((other, format!("the name {} of another composite contains {sign}: write it without", quoted(&seen))))
        })
        .collect();
    one.help.extend(hidden.iter().map(|(_, help)| help.clone()));
    let is_hidden = |name: &str| hidden.iter().any(|(other, _)| *other == name);
    for near in missing.near.iter().filter(|near| !is_hidden(near)) {
        let meant = prefix.map_or_else(|| near.clone(), |prefix| format!("{prefix}:{near}"));
        let places = composite.namings().filter(|other| other.name.value == name.value);
        let edit = |place: Location| Edit { location: place, replacement: escaped(&meant) };
        let edits: Vec<Edit> = places.map(|other| edit(other.name.location)).collect();
        let description = match edits.len() {
            0 | 1 => replacing(name, &meant),
            count => format!("{}, in {count} places", replacing(name, &meant)),
        };
        one = one.suggest_edits(description, if edits.is_empty() { vec![edit(name.location)] } else { edits });
    }
    if let Some((at, meant)) = wrong_namespace.filter(|(_, meant)| !is_hidden(meant)) {
        let of = namespaces.iter().flatten().next().map_or("", |namespace| namespace.as_str());
        one = one.suggest(replacing(of, meant), at, escaped(meant));
    }
    for searched in &missing.searched {
        one = one.help(searched.clone());
    }
    if missing.searched.is_empty() {
        one = one.help("name the file of that composite in the command as well");
    }
    one
}
