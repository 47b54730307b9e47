//! Values as files give them, before they are held against what they should be.

use std::borrow::Cow;
use std::rc::Rc;
use std::slice;

use super::type_name::local;
use crate::check::judged::{Faulty, Judged};
use crate::check::report::Report;
use crate::check::values::replica::Instance;
use crate::diagnostic::{Diagnostic, Severity, codes, quoted};
use crate::model::{Part, Property, ValueDocument, Version};
use crate::source::{Located, Location, Text};
use crate::syntax::{Document, Element};

/// Every value that a property is given; none when it is given nothing.
#[derive(Clone)]
pub(crate) struct Raw<'a>(pub(crate) Vec<Piece<'a>>);

/// One value.
#[derive(Clone)]
pub(crate) enum Piece<'a> {
    Text(Cow<'a, Text>),
    /// Elements: the named values of a complex property, and the replica whose numbers are in their texts.
    Elements(Rc<[Element<'a>]>, Option<&'a Instance>),
    /// The root of XML in a file, with the whole text: what counts is for the one who takes it to say.
    Whole(&'a Text, Element<'a>, Option<&'a Instance>),
}

impl<'a> Raw<'a> {
    pub(crate) fn one(text: &'a Text) -> Self {
        Self(vec![Piece::Text(Cow::Borrowed(text))])
    }

    /// The length of its texts.
    pub(crate) fn bytes(&self) -> usize {
        let length = |piece: &Piece<'_>| match piece {
            Piece::Text(text) => text.len(),
            Piece::Whole(text, ..) => text.len(),
            Piece::Elements(..) => 0,
        };
        self.0.iter().map(length).sum()
    }

    /// The values that components take of a property of this declaration: what is inside of each `element` that is its
    /// type.
    pub(crate) fn inside_elements_of(self, property: &Property) -> Self {
        let Some(of) = property.element() else { return self };
        let is_it = |one: &Element<'_>| one.local_name() == local(of);
        let pieces = self.0.into_iter().flat_map(|piece| match piece {
            Piece::Elements(elements, instance) if elements.iter().all(is_it) => {
                Self::of_elements(&elements, instance).0
            }
            Piece::Whole(_, root, instance) if is_it(&root) => vec![Piece::inside(root, instance)],
            other => vec![other],
        });
        Self(pieces.collect())
    }

    /// Elements `of` a name that are written beside each other, as one value each.
    pub(crate) fn split_into_elements(self, of: &str) -> Self {
        let pieces = self.0.into_iter().flat_map(|piece| match piece {
            Piece::Elements(elements, instance) if elements.iter().all(|one| one.local_name() == local(of)) => {
                elements.iter().map(|one| Piece::Elements([*one].into(), instance)).collect()
            }
            other => vec![other],
        });
        Self(pieces.collect())
    }

    /// The values inside these elements, one each.
    pub(crate) fn of_elements(elements: &[Element<'a>], instance: Option<&'a Instance>) -> Self {
        Self(elements.iter().map(|element| Piece::inside(*element, instance)).collect())
    }
}

impl<'a> Piece<'a> {
    /// The value inside an element.
    pub(crate) fn inside(element: Element<'a>, instance: Option<&'a Instance>) -> Self {
        let children: Rc<[Element<'a>]> = element.children().collect();
        if !children.is_empty() {
            return Self::Elements(children, instance);
        }
        let nothing = || Located::new("".into(), element.name_location());
        Self::text(element.trimmed_text().unwrap_or_else(nothing), instance)
    }

    /// A text of a replica, or of what is none.
    pub(crate) fn text(text: Text, instance: Option<&'a Instance>) -> Self {
        Self::Text(match instance {
            Some(instance) => instance.text(Cow::Owned(text)),
            None => Cow::Owned(text),
        })
    }

    /// The elements that it is.
    pub(crate) fn elements(&self) -> Option<&[Element<'a>]> {
        match self {
            Self::Text(_) => None,
            Self::Elements(elements, _) => Some(elements),
            Self::Whole(_, root, _) => Some(slice::from_ref(root)),
        }
    }

    /// The replica whose numbers are in its texts.
    pub(crate) fn instance(&self) -> Option<&'a Instance> {
        match self {
            Self::Text(_) => None,
            Self::Elements(_, instance) | Self::Whole(_, _, instance) => *instance,
        }
    }

    pub(crate) fn location(&self) -> Location {
        match self {
            Self::Text(text) => text.location,
            Self::Whole(text, ..) => text.location,
            // Never without any: it was made from some.
            Self::Elements(elements, _) => elements[0].name_location(),
        }
    }
}

/// True if a property of a composite has several values, but takes one. In SCA 1.0 elements of this name may be parts
/// of a complex value.
pub(crate) fn is_one_of_several(property: &Property, version: Version) -> bool {
    version.is_1_1() && property.values().len() > 1 && property.many().is_none_or(|many| !many.value)
}

/// The values that a property gives directly, in one of four ways: the attribute `value`, what is inside, elements
/// `value`, or a file. Two ways at once are reported.
pub(crate) fn raw<'a>(
    property: &'a Property,
    document: &'a Document,
    instance: Option<&'a Instance>,
    report: &mut Report<'_>,
) -> Judged<Raw<'a>> {
    if let (Some(file), None, None) = (property.file(), property.document(), property.from_file()) {
        // As a rule it was reported by who tried to read it.
        if !report.has_errors() {
            report.push(Diagnostic::new(&codes::FILE_UNREADABLE, file.location, "the file was not read"));
        }
        return Err(Faulty);
    }
    let mut ways = ways(property, document, instance).into_iter();
    match (ways.next(), ways.next()) {
        (Some((first, _)), Some((second, _))) => {
            let message = format!("the property {} is given a value in two ways", quoted(&property.name));
            let one = Diagnostic::new(&codes::VALUE_IN_TWO_WAYS, second, message).label(first, "the other value");
            report.push(one.help(
                "write it in one way: as text inside, as the attribute `value`, as `<value>` elements, or in a `file`",
            ));
            Err(Faulty)
        }
        (only, _) => Ok(only.map_or_else(|| Raw(Vec::new()), |(_, raw)| raw)),
    }
}

/// The values of each way in which a property gives some, and where that begins.
fn ways<'a>(
    property: &'a Property,
    document: &'a Document,
    instance: Option<&'a Instance>,
) -> Vec<(Location, Raw<'a>)> {
    let mut ways: Vec<(Location, Raw<'a>)> = Vec::new();
    if let Some(value) = property.value.as_ref() {
        ways.push((value.location, Raw::one(value)));
    }
    if let Some(text) = property.text.as_ref() {
        ways.push((text.location, Raw::one(text)));
    }
    if let Some(first) = property.values().first() {
        let values = property.values().iter().map(|value| {
            if value.content.is_empty() {
                return Piece::Text(Cow::Borrowed(&value.text));
            }
            Piece::Elements(value.content.iter().map(|id| document.element(*id)).collect(), instance)
        });
        ways.push((first.tag(), Raw(values.collect())));
    }
    if let Some(first) = property.content().first() {
        let elements = property.content().iter().map(|id| document.element(*id)).collect();
        ways.push((document.element(*first).name_location(), Raw(vec![Piece::Elements(elements, instance)])));
    }
    if let Some(file) = property.file() {
        let of_document = property.document().map(|from| document_value(from, property, instance));
        let found = of_document.or_else(|| property.from_file().map(Raw::one));
        ways.extend(found.map(|found| (file.location, found)));
    }
    ways
}

/// Reports a value beside a `source`, which comes before all others (SCA Assembly 1.1, 4.5). Where the composite's
/// property has no value of its own, it is what counts until one is given from outside.
pub(crate) fn beside_source(property: &Property, source: &Text, document: &Document, report: &mut Report<'_>) {
    let texts = [property.value.as_ref(), property.text.as_ref(), property.file()];
    let listed = property.values().first().map(Part::tag);
    let content = property.content().first().map(|id| document.element(*id).name_location());
    let mut ways = texts.into_iter().flatten().map(|text| text.location).chain(listed).chain(content);
    let Some(at) = ways.next() else { return };
    let message = format!("the property {} is given a value beside its `source`", quoted(&property.name));
    let one = Diagnostic::new(&codes::VALUE_IN_TWO_WAYS, at, message).severity(Severity::Warning);
    let one = Diagnostic { rule: None, ..one };
    report.push(one.label(source.location, "this `source` is used").help("keep one of the two: the value is ignored"));
}

/// The values of XML in a file.
fn document_value<'a>(from: &'a ValueDocument, property: &'a Property, instance: Option<&'a Instance>) -> Raw<'a> {
    let root = from.document.root();
    if let (false, Some(text)) = (from.is_list, property.from_file()) {
        return Raw(vec![Piece::Whole(text, root, instance)]);
    }
    let is_value = |one: &Element<'_>| one.local_name() == "value" && one.namespace() == root.namespace();
    let children: Vec<Element<'a>> = root.children().collect();
    match children.iter().all(is_value) {
        true => Raw::of_elements(&children, instance),
        false => Raw(vec![Piece::Elements(children.into(), instance)]),
    }
}
