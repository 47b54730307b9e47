//! The root element: is it a composite, and of which version of SCA?

use super::Loader;
use super::children::renaming;
use crate::diagnostic::{Diagnostic, Diagnostics, codes, nearest, quoted};
use crate::model::Version;
use crate::source::{Location, Span};
use crate::syntax::Element;

impl Loader<'_> {
    /// True if the root is a composite, or written as nearly one; finds out of which version of SCA.
    pub(super) fn root(&mut self, root: Element<'_>) -> bool {
        let namespace = root.namespace();
        namespace.clone_into(&mut self.namespace);
        let version = Version::from_namespace(namespace);
        if root.is_unnamed() {
            return false;
        }
        if root.local_name() != "composite" {
            self.report(wrong_root(root, version));
            if meant_root(root).is_none() {
                return false;
            }
        }
        // Behind a wrong namespace the rest is read as if it were the right one, so that other faults are found too.
        self.version = version.or_else(|| meant(namespace)).unwrap_or(Version::Osoa10);
        let is_unknown = namespace.is_empty() && root.has_damaged_tag();
        if version.is_none() && !is_unknown {
            self.report(wrong_namespace(root));
        }
        true
    }
}

fn wrong_root(root: Element<'_>, version: Option<Version>) -> Diagnostic {
    let message = format!("the root element is {} and has to be `composite`", quoted(root.name()));
    let location = root.name_location();
    let mut one = Diagnostic::new(&codes::ROOT, location, message);
    let local = root.local_name();
    if let Some(meant) = meant_root(root) {
        let edits = renaming(root, root.prefix(), meant);
        return one.suggest_edits(format!("replace {} with {}", quoted(local), quoted(meant)), edits);
    }
    if version.is_none() {
        one = one.help(format!("of the namespace {}", namespaces()));
    }
    let hint = match (version.is_some(), local) {
        (true, "componentType") => "this describes an implementation; name the composite that uses it",
        (true, "contribution") => "this describes a contribution; name a composite in it",
        (true, "definitions") => "this holds policies; name a composite",
        (true, "component") => "a component stands in a `composite`",
        _ => return one,
    };
    one.help(hint)
}

/// The name that a root of SCA, or of no namespace, has by a slip of the pen.
fn meant_root(root: Element<'_>) -> Option<&'static str> {
    let is_of_sca = Version::from_namespace(root.namespace()).is_some() || root.namespace().is_empty();
    nearest(root.local_name(), ["composite"]).filter(|_| is_of_sca)
}

fn wrong_namespace(root: Element<'_>) -> Diagnostic {
    let namespace = root.namespace();
    if namespace.is_empty() {
        let version = Version::Oasis200912;
        let message = "`composite` is in no namespace, and so it is no composite of SCA";
        let place = Span::empty(root.name_span().end).in_file(root.document().file());
        let declaration = format!("xmlns=\"{}\"", version.namespace());
        return Diagnostic::new(&codes::NAMESPACE, root.name_location(), message)
            .help(format!("it has to be in {}", namespaces()))
            .suggest(format!("insert {}", quoted(&declaration)), place, format!(" {declaration}"));
    }
    let message = format!("{} is no namespace of SCA", quoted(namespace));
    let location = declaration(root).unwrap_or_else(|| root.name_location());
    let one = Diagnostic::new(&codes::NAMESPACE, location, message)
        .help(format!("the namespace of a composite is {}", namespaces()));
    match meant(namespace) {
        Some(version) if location != root.name_location() => {
            let description = format!("replace it with {}", quoted(version.namespace()));
            one.suggest(description, location, version.namespace())
        }
        _ => one,
    }
}

/// The version whose namespace is meant, when what is written is near enough.
pub(super) fn meant(namespace: &str) -> Option<Version> {
    let near = nearest(namespace, Version::ALL.map(Version::namespace));
    near.and_then(Version::from_namespace)
}

/// The place of the namespace of the root.
fn declaration(root: Element<'_>) -> Option<Location> {
    let wanted = root.prefix();
    let found = root.namespace_declarations().find(|one| match one.prefix() {
        Some(_) => Some(one.local_name()) == wanted,
        None => wanted.is_none(),
    })?;
    Some(found.value_span().in_file(root.document().file()))
}

fn namespaces() -> String {
    let all = Version::ALL.map(|version| format!("`{}` ({})", version.namespace(), version.label()));
    format!("{}, {} or {}", all[0], all[1], all[2])
}

/// Reports a file whose root is not the element of SCA that it has to be, with what such a file is for; of a text that
/// is no XML its faults.
pub(super) fn of_another_kind(
    root: Element<'_>,
    expected: &str,
    help: &str,
    faults: Vec<Diagnostic>,
    diagnostics: &mut Diagnostics,
) {
    if !faults.is_empty() {
        return faults.into_iter().for_each(|fault| diagnostics.push(fault));
    }
    let found = quoted(root.name());
    let message = if root.local_name() != expected {
        format!("the root element is {found} and has to be {} of SCA", quoted(expected))
    } else if root.namespace().is_empty() {
        format!("{found} is in no namespace, and has to be in one of SCA")
    } else {
        format!("{found} is in the namespace {}, and has to be in one of SCA", quoted(root.namespace()))
    };
    let one = Diagnostic::new(&codes::ROOT, root.name_location(), message).help(help);
    diagnostics.push(match root.local_name() == expected {
        true => one.help(format!("that is {}", namespaces())),
        false => one,
    });
}
