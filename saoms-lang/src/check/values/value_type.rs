//! Values of properties against the simple types that these name.

use super::simple_type::SimpleType;
use super::type_name::local;
use crate::check::report::{Report, replacing};
use crate::diagnostic::{Code, Diagnostic, Severity, codes, nearest, quoted};
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

impl Typed<'_> {
    /// The namespace of a name in its attributes.
    pub(crate) fn namespace(&self, of: &str) -> Option<String> {
        let prefix = of.split_once(':').map_or("", |(prefix, _)| prefix);
        let element = self.document.element(self.property.origin().element);
        element.resolve_prefix(prefix).map(|namespace| namespace.into_owned())
    }

    /// Its type, where that is a simple one of XML Schema. A type of the same name in a namespace of users is another
    /// one.
    fn simple_type(&self) -> Option<&'static SimpleType> {
        let of = self.property.r#type()?;
        let found = SimpleType::find(local(of))?;
        let is_ours = !of.contains(':') || self.namespace(of).is_none_or(|namespace| namespace == XML_SCHEMA);
        is_ours.then_some(found)
    }

    /// True if a value is of its type.
    pub(crate) fn accepts(&self, value: &str) -> bool {
        self.simple_type().is_none_or(|of| is_written(self.property, of, value))
    }

    /// Reports a value that is not of its type.
    pub(crate) fn check(&self, value: &Text, report: &mut Report<'_>) {
        if let Some(of) = self.simple_type() {
            holds(self.property, of, value, report);
        }
    }
}

/// True if a value is of the type of a property, where it is not known what the prefixes of types mean; where it is
/// not, that is reported.
pub(crate) fn holds_by_name(property: &Property, value: &Text, report: &mut Report<'_>) -> bool {
    let of = property.r#type().and_then(|of| SimpleType::find(local(of)));
    of.is_none_or(|of| holds(property, of, value, report))
}

fn is_written(property: &Property, of: &SimpleType, value: &str) -> bool {
    // Many values may be written as a list, as in files of SCA 1.0.
    let is_list = property.many().is_some_and(|many| many.value);
    let mut listed = value.split_whitespace().peekable();
    (of.accepts)(value) || is_list && listed.peek().is_some() && listed.all(of.accepts)
}

fn holds(property: &Property, of: &SimpleType, value: &Text, report: &mut Report<'_>) -> bool {
    if is_written(property, of, value) {
        return true;
    }
    // In a text of its own an empty value can be seen.
    let is_hidden = value.is_empty() && value.location.file == property.tag().file;
    let at = if is_hidden { property.tag() } else { value.location };
    let code = &codes::COMPOSITE_VALUE_TYPE;
    if report.skip(code, Severity::Error, at) || report.has_diagnostic(code, at) || is_refused(value, report)
    {
        return false;
    }
    let named = property.r#type();
    let message = format!(
        "the property {} is of the type {}: found {}, expected {}",
        quoted(&property.name),
        quoted(named.map_or("", Text::as_str)),
        if value.is_empty() { "nothing".to_owned() } else { quoted(value) },
        of.expected
    );
    let one = Diagnostic::new(code, at, message);
    let one = named.into_iter().fold(one, |one, named| one.label(named.location, "the type"));
    report.push(match meant_boolean(value).filter(|_| of.is_boolean()) {
        Some(meant) => one.suggest(replacing(value, meant), at, meant),
        None => one.help("change the value, or the type"),
    });
    false
}

/// The boolean that a text probably means.
fn meant_boolean(text: &str) -> Option<&'static str> {
    match text.to_ascii_lowercase().as_str() {
        "yes" | "y" | "on" | "t" => Some("true"),
        "no" | "n" | "off" | "f" => Some("false"),
        other => nearest(other, ["true", "false"]),
    }
}

/// True if the class that takes a value refuses it, which is reported and says more.
fn is_refused(value: &Text, report: &Report<'_>) -> bool {
    const OF_CLASSES: [&Code; 4] =
        [&codes::VALUE_TYPE, &codes::VALUE_EMPTY, &codes::VALUE_RANGE, &codes::VALUE_NOT_ALLOWED];
    OF_CLASSES.into_iter().any(|code| report.has_diagnostic(code, value.location))
}
