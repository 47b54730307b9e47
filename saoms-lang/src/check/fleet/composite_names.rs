//! Names of composites: diagnostics about names that lead nowhere, or to another composite than they mean.

use crate::check::report::replacing;
use crate::diagnostic::{Code, Diagnostic, Edit, Severity, codes, quoted};
use crate::model::{Composite, Missing, Naming, Version};
use crate::source::Span;
use crate::syntax::{Element, escaped};

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
        "" if Version::from_namespace(&default).is_some() => {
            format!("{} without a prefix is in the default namespace, which is that of SCA", quoted(local))
        }
        "" => format!("{} without a prefix is in the namespace {}", quoted(local), quoted(&default)),
        prefix => format!("the prefix {} is bound to no namespace", quoted(prefix)),
    };
    let namespace = found.namespace();
    let taken = match namespace {
        "" => "that in no namespace is taken".to_owned(),
        namespace => format!("that of {} is taken", quoted(namespace)),
    };
    let message = format!("{why}: {taken}");
    let one = Diagnostic::new(code(naming, around), name.location, message).severity(Severity::Warning);
    let one = one.label(found.name.location, "this one");
    if namespace.is_empty() {
        return one.help("give it a `targetNamespace`, and name it with a prefix that is bound to that");
    }
    if let Some(bound) = prefix_of(namespace, element) {
        let right = format!("{bound}:{local}");
        return one.suggest(replacing(name, &right), name.location, escaped(&right));
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

/// The fault of a name that leads nowhere.
pub(crate) fn not_found(
    naming: Naming<'_>,
    missing: &Missing,
    composite: &Composite,
    assume_classes: bool,
) -> Diagnostic {
    let name = naming.name;
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
    // What is spelt alike is meant; anything else may come from another contribution.
    if assume_classes && missing.near.is_empty() {
        one = one.severity(Severity::Warning);
    }
    if namespaces.is_none() {
        let prefix = name.split(':').next().unwrap_or_default();
        one = one.help(format!("the prefix {} is bound to no namespace", quoted(prefix)));
    }
    if local.ends_with(".composite") {
        one = one.help(
            "it is the `name` in a composite that is meant, with the prefix of its `targetNamespace`, and not its file",
        );
    }
    for near in &missing.near {
        let replacement = escaped(near);
        one = one.suggest(replacing(name, near), name.location, replacement);
    }
    for searched in &missing.searched {
        one = one.help(searched.clone());
    }
    if missing.searched.is_empty() {
        one = one.help("name the file of the composite beside this one");
    }
    one
}
