//! The root element: whether it is a composite, and its version of SCA. Namespaces that are nearly those of SCA or
//! SAOMS are reported, because elements in them would be skipped silently.

use std::collections::{HashMap, HashSet};

use super::Loader;
use super::children::renamed;
use crate::diagnostic::{Diagnostic, Diagnostics, Edit, Severity, codes, nearest, quoted};
use crate::model::{SAOMS_NAMESPACE, Version};
use crate::source::{Location, Span};
use crate::syntax::{Attribute, Document, Element};

impl Loader<'_> {
    /// True if the root is a composite, or nearly one; also sets its version of SCA.
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

    /// Reports declarations of namespaces that are nearly those that count, where elements or attributes are in them.
    pub(super) fn similar_namespaces(&mut self, document: &Document) {
        let near = document.namespaces().filter_map(|one| Some((one, self.meant_namespace(one, document)?)));
        let near: Vec<(&str, &str)> = near.collect();
        if near.is_empty() {
            return;
        }
        let (mut used, mut declared) = (HashSet::new(), HashMap::new());
        for element in document.elements() {
            used.insert(element.namespace());
            used.extend(element.attributes().map(Attribute::namespace));
            for one in element.namespace_declarations() {
                declared.entry(one.value()).or_insert(one);
            }
        }
        for (written, meant) in near {
            let Some(first) = declared.get(written).filter(|_| used.contains(written)) else { continue };
            let at = first.value_span().in_file(document.file());
            let message = format!("unknown namespace {}: did you mean {}?", quoted(written), quoted(meant));
            let one = Diagnostic::new(&codes::NAMESPACE_NEAR, at, message);
            let mut one = one.mend(format!("replace it with {}", quoted(meant)), meant);
            if let Some(passed_over) = self.passed_over.as_ref().filter(|one| one.namespace == written) {
                let why = format!("its attribute {} {}", quoted(&passed_over.name), passed_over.meaning);
                one = one.severity(Severity::Error).help(why);
            }
            self.report(one);
        }
    }

    /// The namespace that counts and is nearly this one. That of the root is judged with it.
    pub(super) fn meant_namespace(&self, written: &str, document: &Document) -> Option<&'static str> {
        let is_of_root = written == self.namespace || written == document.root().namespace();
        nearly(written).filter(|_| !is_of_root)
    }
}

fn wrong_root(root: Element<'_>, version: Option<Version>) -> Diagnostic {
    let message = format!("the root element is {}, expected `composite`", quoted(root.name()));
    let location = root.name_location();
    let mut one = Diagnostic::new(&codes::ROOT, location, message);
    let local = root.local_name();
    if is_around_composites(root) {
        return unwrapped(one, root);
    }
    if let Some(meant) = meant_root(root) {
        return renamed(one, root, meant);
    }
    if version.is_none() {
        one = one.help(format!("of the namespace {}", namespaces()));
    }
    let hint = match (version.is_some(), local) {
        (true, "componentType") => "this describes an implementation; name the composite that uses it",
        (true, "contribution") => {
            "this describes a contribution; name a composite in it, or rename the file to `sca-contribution.xml`"
        }
        (true, "definitions") => "this holds policies; name a composite",
        (true, "component") => "put the component into a `composite`",
        (true, _) => return renamed(one, root, "composite"),
        _ => return one,
    };
    one.help(hint)
}

/// True if a root has nothing but composites in it.
fn is_around_composites(root: Element<'_>) -> bool {
    root.children().next().is_some() && root.children().all(|child| child.local_name() == "composite")
}

/// The fault of a root around composites, with what mends it if there is one composite alone.
fn unwrapped(one: Diagnostic, root: Element<'_>) -> Diagnostic {
    if root.children().nth(1).is_some() {
        return one.help("write each composite into a file of its own: a file has exactly one");
    }
    let is_plain = root.attributes().next().is_none() && root.namespace_declarations().next().is_none();
    let tags = [Some(root.start_tag_span()), root.end_tag_span()];
    let file = root.document().file();
    let edits = tags.into_iter().flatten();
    let edits = edits.map(|tag| Edit { location: tag.in_file(file), replacement: String::new() }).collect();
    let description = "remove its start tag and end tag: the composite in it is the root";
    match is_plain {
        true => one.suggest_edits(description, edits),
        false => one.help("make the composite in it the root"),
    }
}

/// The name that a root of SCA, or of no namespace, has by a slip of the pen.
fn meant_root(root: Element<'_>) -> Option<&'static str> {
    if is_around_composites(root) {
        return None;
    }
    let is_of_sca = Version::from_namespace(root.namespace()).is_some() || root.namespace().is_empty();
    nearest(root.local_name(), ["composite"]).filter(|_| is_of_sca)
}

fn wrong_namespace(root: Element<'_>) -> Diagnostic {
    let namespace = root.namespace();
    if namespace.is_empty() {
        let version = Version::Oasis200912;
        let message = "`composite` is in no namespace, so it is not a composite of SCA";
        let place = Span::empty(root.name_span().end).in_file(root.document().file());
        let declaration = format!("xmlns=\"{}\"", version.namespace());
        return Diagnostic::new(&codes::NAMESPACE, root.name_location(), message)
            .help(format!("it has to be in {}", namespaces()))
            .suggest(format!("insert {}", quoted(&declaration)), place, format!(" {declaration}"));
    }
    let message = format!("{} is not a namespace of SCA", quoted(namespace));
    let location = declaration(root).unwrap_or_else(|| root.name_location());
    let one = Diagnostic::new(&codes::NAMESPACE, location, message).help(format!("use the namespace {}", namespaces()));
    match meant(namespace) {
        Some(version) if location != root.name_location() => {
            one.mend(format!("replace it with {}", quoted(version.namespace())), version.namespace())
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
        format!("the root element is {found}, expected {} of SCA", quoted(expected))
    } else if root.namespace().is_empty() {
        format!("{found} is in no namespace, expected one of SCA")
    } else {
        format!("{found} is in the namespace {}, expected one of SCA", quoted(root.namespace()))
    };
    let one = Diagnostic::new(&codes::ROOT, root.name_location(), message).help(help);
    diagnostics.push(match root.local_name() == expected {
        true => one.help(format!("that is {}", namespaces())),
        false => one,
    });
}

/// The namespace that is meant by one that differs in a slip of the pen.
fn nearly(written: &str) -> Option<&'static str> {
    if written == SAOMS_NAMESPACE || Version::from_namespace(written).is_some() {
        return None;
    }
    let of_sca = Version::ALL.map(Version::namespace).into_iter().find(|known| {
        // Drafts and other versions have numbers of their own.
        let is_other_version = known.len() == written.len()
            && known.bytes().zip(written.bytes()).all(|(a, b)| a == b || a.is_ascii_digit() && b.is_ascii_digit());
        is_slip(written, known) && !is_other_version
    });
    of_sca.or_else(|| is_slip(written, SAOMS_NAMESPACE).then_some(SAOMS_NAMESPACE))
}

/// True if two texts differ in their case, in one character, or in two that stand together.
fn is_slip(written: &str, meant: &str) -> bool {
    let (written, meant) = (written.trim().trim_end_matches('/').to_lowercase(), meant.to_lowercase());
    let (one, other) = (written.as_bytes(), meant.as_bytes());
    let longest = one.len().max(other.len());
    let same = one.iter().zip(other).take_while(|(a, b)| a == b).count();
    let room = one.len().min(other.len()) - same;
    let behind = one.iter().rev().zip(other.iter().rev()).take(room).take_while(|(a, b)| a == b).count();
    longest - same - behind <= 2
}
