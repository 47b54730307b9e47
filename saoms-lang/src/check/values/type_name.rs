//! The names of the types of properties.

use crate::check::report::{Report, replacing};
use crate::diagnostic::{Diagnostic, Edit, Severity, codes, nearest, quoted};
use crate::load::vocabulary::{BUILT_IN_TYPES, XML_SCHEMA};
use crate::model::{Part, Property, Version};
use crate::source::{Location, Span, Text};
use crate::syntax::{Document, Element};

/// Names of other languages for types of XML Schema.
const OTHER_NAMES: &[(&str, &str)] = &[
    ("bool", "boolean"),
    ("str", "string"),
    ("text", "string"),
    ("number", "double"),
    ("real", "double"),
    ("uint", "unsignedInt"),
    ("int32", "int"),
    ("int64", "long"),
    ("float32", "float"),
    ("float64", "double"),
    ("uri", "anyURI"),
];

/// Reports a type in the namespace of XML Schema that is not there.
pub(crate) fn named(property: &Property, document: &Document, report: &mut Report<'_>) {
    let Some(of) = property.r#type().filter(|of| !of.is_empty()) else { return };
    let (prefix, local) = of.split_once(':').unwrap_or(("", of));
    let element = document.element(property.origin().element);
    let namespace = element.resolve_prefix(prefix);
    if namespace.is_none() && !prefix.is_empty() {
        return unbound(of, (prefix, local), document, report);
    }
    if namespace != Some(XML_SCHEMA) {
        let is_of_sca = namespace.is_none_or(|namespace| Version::from_namespace(namespace).is_some());
        if let Some(meant) = meant(local).filter(|_| prefix.is_empty() && is_of_sca) {
            unprefixed(of, meant, element, document, report);
        } else if let Some(namespace) = namespace.filter(|one| BUILT_IN_TYPES.contains(&local) && is_nearly_schema(one))
            && report.is_first_unbound(document.file(), prefix)
        {
            let message = format!("unknown namespace {} of this type", quoted(namespace));
            let one = Diagnostic::new(&codes::UNKNOWN_TYPE, of.location, message).severity(Severity::Warning);
            report.push(one.help(format!("did you mean {}?", quoted(&format!("xmlns:{prefix}=\"{XML_SCHEMA}\"")))));
        }
        return;
    }
    if BUILT_IN_TYPES.contains(&local) {
        return;
    }
    let message = format!("XML Schema has no type {}", quoted(local));
    let one = Diagnostic::new(&codes::UNKNOWN_TYPE, of.location, message);
    let is_whole = property.value.iter().chain(&property.text).all(|text| text.trim().parse::<i32>().is_ok());
    let number = (local == "number" && is_whole).then_some("int");
    report.push(match number.or_else(|| meant(local)) {
        Some(meant) => {
            let meant = if prefix.is_empty() { meant.to_owned() } else { format!("{prefix}:{meant}") };
            one.suggest(replacing(of, &meant), of.location, meant)
        }
        None => one.help("its types are `string`, `boolean`, `int`, `double` and so on; a type of your own has the prefix of its own namespace"),
    });
}

/// True if a namespace is that of XML Schema but for a slip.
fn is_nearly_schema(namespace: &str) -> bool {
    nearest(namespace, [XML_SCHEMA]).is_some()
}

/// The type of XML Schema that is meant by a name.
fn meant(local: &str) -> Option<&'static str> {
    let known = || BUILT_IN_TYPES.iter().copied();
    let other = || OTHER_NAMES.iter().find(|(name, _)| *name == local).map(|(_, meant)| *meant);
    known().find(|name| *name == local).or_else(other).or_else(|| nearest(local, known()))
}

/// Reports a type of XML Schema that is written without a prefix, and so is one of another namespace.
fn unprefixed(of: &Text, meant: &'static str, element: Element<'_>, document: &Document, report: &mut Report<'_>) {
    let message = format!("the type {} without a prefix is not a type of XML Schema", quoted(of));
    let one = Diagnostic::new(&codes::UNKNOWN_TYPE, of.location, message).severity(Severity::Warning);
    if let Some(prefix) = prefix_of_schema(element) {
        let meant = format!("{prefix}:{meant}");
        return report.push(one.suggest(replacing(of, &meant), of.location, meant));
    }
    let prefix = if element.resolve_prefix("xsd").is_none() { "xsd" } else { "xs" };
    let meant = format!("{prefix}:{meant}");
    let edit = Edit { location: of.location, replacement: meant.clone() };
    let description = replacing(of, &meant);
    // Once in a file is enough.
    if !report.is_first_unbound(document.file(), prefix) {
        return report.push(one.suggest_edits(description, vec![edit]));
    }
    let (end, declaration) = declaration(prefix, document);
    let description = format!("{description}, and declare {} in the root element", quoted(&declaration));
    let declare = Edit { location: end, replacement: format!(" {declaration}") };
    report.push(one.suggest_edits(description, vec![edit, declare]));
}

/// A prefix that is bound to XML Schema where an element stands.
fn prefix_of_schema(element: Element<'_>) -> Option<&str> {
    let around = std::iter::successors(Some(element), |element| element.parent());
    let declared = around.flat_map(|element| element.written_attributes());
    let mut prefixes = declared.filter_map(|one| one.name().strip_prefix("xmlns:"));
    prefixes.find(|prefix| element.resolve_prefix(prefix).is_some_and(|namespace| namespace == XML_SCHEMA))
}

/// The declaration of a prefix of XML Schema, and where it belongs.
fn declaration(prefix: &str, document: &Document) -> (Location, String) {
    let end = Span::empty(document.root().name_span().end).in_file(document.file());
    (end, format!("xmlns:{prefix}=\"{XML_SCHEMA}\""))
}

/// Reports a type whose prefix is bound to no namespace. It counts as that of its name all the same.
fn unbound(of: &Text, (prefix, local): (&str, &str), document: &Document, report: &mut Report<'_>) {
    if !report.is_first_unbound(document.file(), prefix) {
        return;
    }
    let message = format!("the prefix {} of this type is not declared", quoted(prefix));
    let one = Diagnostic::new(&codes::UNKNOWN_TYPE, of.location, message).severity(Severity::Warning);
    if !BUILT_IN_TYPES.contains(&local) {
        return report.push(one.help(format!("declare it: `xmlns:{prefix}=\"...\"`")));
    }
    let (end, declaration) = declaration(prefix, document);
    let description = format!("declare it in the root element: {}", quoted(&declaration));
    report.push(one.suggest(description, end, format!(" {declaration}")));
}

/// True if a type is one of XML Schema with a slip in its name, or as other languages call it, which is reported.
pub(crate) fn is_misspelt(of: &str) -> bool {
    let local = local(of);
    !BUILT_IN_TYPES.contains(&local) && meant(local).is_some()
}

/// The name of a type without its prefix.
pub(crate) fn local(of: &str) -> &str {
    of.rsplit(':').next().unwrap_or(of)
}
