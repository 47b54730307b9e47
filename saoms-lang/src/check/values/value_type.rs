//! Values of properties against the simple types that these name.

use super::simple_type::SimpleType;
use super::type_name::local;
use crate::check::report::{Report, replacing};
use crate::diagnostic::{Code, Diagnostic, Severity, codes, meant_boolean, quoted};
use crate::load::vocabulary::XML_SCHEMA;
use crate::model::{Part, Property};
use crate::source::Text;
use crate::syntax::Document;

/// A property that may have a type, and the document that says what the prefixes in it mean.
#[derive(Clone, Copy)]
pub(crate) struct Typed<'a> {
    pub(crate) property: &'a Property,
    pub(crate) document: &'a Document,
}

impl<'a> Typed<'a> {
    /// Its type as it is written, where that is a simple one of XML Schema. A type of the same name in a namespace of
    /// users is another one.
    pub(crate) fn simple_type(&self) -> Option<(&'a Text, &'static SimpleType)> {
        let of = self.property.r#type()?;
        let found = SimpleType::find(local(of))?;
        let namespace = of.split_once(':').and_then(|(prefix, _)| {
            let element = self.property.origin().element(self.document);
            element.resolve_prefix(prefix)
        });
        namespace.is_none_or(|namespace| namespace == XML_SCHEMA).then_some((of, found))
    }

    /// Reports a value that is not of its type.
    pub(crate) fn check(&self, value: &Text, report: &mut Report<'_>) -> Result<(), ()> {
        let is_right = self.simple_type().is_none_or(|of| holds(self.property, of, value, report));
        is_right.then_some(()).ok_or(())
    }
}

/// True if a value is of the type of a property, where it is not known what the prefixes of types mean; where it is
/// not, that is reported.
pub(crate) fn holds_by_name(property: &Property, value: &Text, report: &mut Report<'_>) -> bool {
    let of = property.r#type().and_then(|named| Some((named, SimpleType::find(local(named))?)));
    of.is_none_or(|of| holds(property, of, value, report))
}

fn holds(property: &Property, (named, of): (&Text, &SimpleType), value: &Text, report: &mut Report<'_>) -> bool {
    // Many values may be written as a list, as in files of SCA 1.0.
    let is_list = property.many().is_some_and(|many| many.value) && !value.trim().is_empty();
    if of.accepts(value) || is_list && value.split_whitespace().all(|one| of.accepts(one)) {
        return true;
    }
    // In a text of its own an empty value can be seen.
    let is_hidden = value.is_empty() && value.location.file == property.tag().file;
    let at = if is_hidden { property.tag() } else { value.location };
    let code = &codes::COMPOSITE_VALUE_TYPE;
    // The class that takes a value may refuse it as well, which says more.
    const OF_CLASSES: [&Code; 4] =
        [&codes::VALUE_TYPE, &codes::VALUE_EMPTY, &codes::VALUE_RANGE, &codes::VALUE_NOT_ALLOWED];
    let is_refused =
        |report: &Report<'_>| OF_CLASSES.into_iter().any(|code| report.has_diagnostic(code, value.location));
    if report.skip(code, Severity::Error, at) || report.has_diagnostic(code, at) || is_refused(report) {
        return false;
    }
    let message = format!(
        "the property {} is of the type {}: found {}, expected {}",
        quoted(&property.name),
        quoted(named),
        if value.is_empty() { "nothing".to_owned() } else { quoted(value) },
        of.expected
    );
    let one = Diagnostic::new(code, at, message).label(named.location, "the type");
    report.push(match meant_boolean(value).filter(|_| of.is_boolean()) {
        Some(meant) => one.suggest(replacing(value, meant), at, meant),
        None => one.help("change the value, or the type"),
    });
    false
}
