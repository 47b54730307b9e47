//! Properties that are typed by a global element: their values are such elements, not what is inside.

use super::raw::{Piece, Raw};
use crate::check::report::{Report, list};
use crate::diagnostic::{Code, Diagnostic, Severity, codes, quoted};
use crate::model::Property;
use crate::source::Text;
use crate::syntax::{Document, Element, ElementId};

impl<'a> Raw<'a> {
    /// What components take of a property of this declaration: where an `element` is its type, what is inside of each
    /// such element.
    pub(crate) fn inside_elements_of(self, property: &Property) -> Self {
        let Some(of) = property.element() else { return self };
        let name = local(of);
        let pieces = self.0.into_iter().flat_map(|piece| match piece {
            Piece::Elements(elements, instance) if elements.iter().all(|one| one.local_name() == name) => {
                Raw::of_elements(&elements, instance).0
            }
            Piece::Whole(_, root, instance) if root.local_name() == name => {
                Raw::of_elements(&[root], instance).0
            }
            other => vec![other],
        });
        Self(pieces.collect())
    }
}

impl<'a> Raw<'a> {
    /// True if they can be others as those of a property that takes several of an `element`.
    pub(crate) fn is_split_by(&self, property: &Property) -> bool {
        property.element().is_some() && property.many().is_some_and(|many| many.value)
    }

    /// The values of a property that takes several of an `element`, one each, where they are written beside each other.
    pub(crate) fn split_into_elements_of(self, property: &Property) -> Self {
        let Some(of) = property.element().filter(|_| self.is_split_by(property)) else { return self };
        let name = local(of);
        let pieces = self.0.into_iter().flat_map(|piece| match piece {
            Piece::Elements(elements, instance) if elements.iter().all(|one| one.local_name() == name) => {
                elements.iter().map(|one| Piece::Elements([*one].into(), instance)).collect()
            }
            other => vec![other],
        });
        Self(pieces.collect())
    }
}

fn local(name: &str) -> &str {
    name.rsplit(':').next().unwrap_or(name)
}

/// Checks that the values of a property that has an `element` are such elements; `code` is that of a value of the wrong
/// type.
pub(crate) fn check(property: &Property, document: &Document, code: &'static Code, report: &mut Report<'_>) {
    let Some(of) = property.element().filter(|of| !of.is_empty() && property.r#type().is_none()) else {
        return;
    };
    holds((property, document), of, &Expected::of(of, property.origin.element(document)), code, report);
}

fn holds(
    (property, document): (&Property, &Document),
    of: &Text,
    expected: &Expected<'_>,
    code: &'static Code,
    report: &mut Report<'_>,
) {
    let wrong = |found: String| {
        let message = format!(
            "the property {} holds elements {}{}: found {found}",
            quoted(&property.name),
            quoted(of),
            expected.shown()
        );
        move |at| Diagnostic::new(code, at, message).label(of.location, "the element")
    };
    for text in property.simple_values().filter(|text| !text.is_empty()) {
        let help = format!("write `<{of}>...</{of}>` inside, or give the property a `type`");
        report.push(wrong(format!("the text {}", quoted(text)))(text.location).help(help));
    }
    let listed = property.values().iter().map(|value| value.content.as_slice());
    for content in listed.chain([property.content()]) {
        let elements: Vec<Element<'_>> = content.iter().map(|id: &ElementId| document.element(*id)).collect();
        let Some(first) = elements.iter().find(|one| !expected.is(**one)) else { continue };
        let at = first.name_location();
        if first.local_name() == expected.local {
            let found = format!("one {}", in_namespace(first.namespace()));
            // Its name says what is meant, and that is how its parts are found.
            let one = wrong(found)(at).severity(Severity::Warning);
            report.push(one.help(format!("write `<{of}>`")));
        } else {
            let found = list(elements.iter().map(|one| one.local_name()));
            let help = format!("put what is inside into `<{of}>...</{of}>`, or give the property a `type`");
            report.push(wrong(found)(at).help(help));
        }
    }
    let all: Vec<ElementId> = property.content().to_vec();
    if let [first, second, ..] = all[..]
        && property.many().is_none_or(|many| !many.value)
        && all.iter().all(|id| expected.is(document.element(*id)))
    {
        let message = format!("the property {} takes one element {}", quoted(&property.name), quoted(of));
        let one = Diagnostic::new(&codes::MANY_VALUES, document.element(second).name_location(), message);
        let one = one.label(document.element(first).name_location(), "the first");
        report.push(one.help("remove it, or write `many=\"true\"`"));
    }
}

/// The element that a property holds.
struct Expected<'a> {
    local: &'a str,
    /// Its namespace; `None` where the name does not say it.
    namespace: Option<String>,
}

impl<'a> Expected<'a> {
    /// A name without a prefix says nothing of a namespace: the default one is that of SCA, which has no elements for
    /// values.
    fn of(name: &'a Text, at: Element<'_>) -> Self {
        let namespace = name.split_once(':').and_then(|(prefix, _)| at.resolve_prefix(prefix));
        Self { local: local(name), namespace: namespace.map(|one| one.into_owned()) }
    }

    fn is(&self, element: Element<'_>) -> bool {
        element.local_name() == self.local
            && self.namespace.as_ref().is_none_or(|namespace| namespace == element.namespace())
    }

    fn shown(&self) -> String {
        self.namespace.as_ref().map_or_else(String::new, |one| format!(" {}", in_namespace(one)))
    }
}

fn in_namespace(namespace: &str) -> String {
    if namespace.is_empty() {
        "in no namespace".to_owned()
    } else {
        format!("in the namespace {}", quoted(namespace))
    }
}
