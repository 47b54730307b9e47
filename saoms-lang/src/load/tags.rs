//! What the loader knows of an element by the shape of its start tag: found once for all tags that are written alike.

use super::Loader;
use super::children::{Family, is_defined, meant_name};
use super::vocabulary::{Kind, VARIANTS};
use crate::xml::{Attribute, Element};

/// How many attributes are usual.
const USUAL: usize = 12;

/// The place of a usual attribute in what is known of a shape.
// The compiler finds it beforehand where the name is written out, which takes that all from there to here is inlined.
#[inline(always)]
fn usual(name: &str) -> Option<usize> {
    match name {
        "name" => Some(0),
        "value" => Some(1),
        "target" => Some(2),
        "class" => Some(3),
        "source" => Some(4),
        "promote" => Some(5),
        "requires" => Some(6),
        "policySets" => Some(7),
        "uri" => Some(8),
        "multiplicity" => Some(9),
        "interface" => Some(10),
        "type" => Some(11),
        _ => None,
    }
}

/// No place.
const NONE: u8 = u8::MAX;

/// What is known of a shape.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tag {
    is_known: bool,
    /// Whose the element is; `None` where that is to be looked at, and told, of each.
    pub(super) family: Option<Family>,
    /// The place of its local name among the frequent ones, when it is one of these of SCA.
    frequent: u8,
    /// What it is called, when SCA defines such a variant of an implementation, an interface or a binding.
    variant: Option<&'static str>,
    /// What its attributes are all right for.
    sound_for: Option<&'static Kind>,
    /// Where each of the usual attributes is among all.
    places: [u8; USUAL],
    /// A bit for each of the usual attributes that it has, and [`OTHERS`] for all others, declarations of namespaces included.
    has: u16,
}

/// The bit of attributes that are not usual.
const OTHERS: u16 = 1 << USUAL;

/// The elements of SCA that most elements are.
const FREQUENT: [&str; 5] = ["property", "service", "reference", "component", "wire"];
/// So many of these are kept whatever they hold.
const ALWAYS_KEPT: usize = 3;

impl Tag {
    const UNKNOWN: Self = Self {
        is_known: false,
        family: None,
        frequent: NONE,
        variant: None,
        sound_for: None,
        places: [NONE; USUAL],
        has: 0,
    };

    fn of(element: Element<'_>, family: Option<Family>) -> Self {
        let mut tag = Self { is_known: true, family, ..Self::UNKNOWN };
        if family == Some(Family::Sca) {
            let name = element.local_name();
            tag.frequent = FREQUENT.iter().position(|one| *one == name).map_or(NONE, |place| place as u8);
            let mut variants = VARIANTS.iter().flat_map(|(_, variants)| *variants);
            tag.variant = variants.find(|one| **one == name).copied();
        }
        for (place, attribute) in element.written_attributes().enumerate() {
            match usual(attribute.name()) {
                Some(usual) if place < usize::from(NONE) => {
                    tag.places[usual] = place as u8;
                    tag.has |= 1 << usual;
                }
                _ => tag.has |= OTHERS,
            }
        }
        tag
    }
}

impl Loader<'_> {
    /// What is known of an element's tag.
    #[inline(always)]
    pub(super) fn tag(&mut self, element: Element<'_>) -> &Tag {
        let shape = element.shape();
        if !self.tags.get(shape).is_some_and(|tag| tag.is_known) {
            self.new_tag(element);
        }
        &self.tags[shape]
    }

    #[cold]
    fn new_tag(&mut self, element: Element<'_>) {
        let shape = element.shape();
        if self.tags.len() <= shape {
            self.tags.resize(element.document().shapes().max(shape + 1), Tag::UNKNOWN);
        }
        let tag = Tag::of(element, self.sure_family(element));
        self.tags[shape] = tag;
    }

    /// Whose an element is, as [`Loader::family`] has it, and what it is called there: the local name, or what is meant by it.
    #[inline]
    pub(super) fn meaning<'a>(&mut self, element: Element<'a>) -> (Family, &'a str) {
        let tag = self.tag(element);
        match FREQUENT.get(usize::from(tag.frequent)).copied().or(tag.variant) {
            Some(name) => (Family::Sca, name),
            None => (self.family(element), meant_name(element)),
        }
    }

    /// Whether SCA defines this variant of an implementation, an interface or a binding.
    #[inline]
    pub(super) fn is_defined(&mut self, element: Element<'_>) -> bool {
        self.tag(element).variant.is_some() || is_defined(element)
    }

    /// Whether the attributes of an element of its shape were found to be all right for this kind.
    #[inline]
    pub(super) fn is_sound(&mut self, element: Element<'_>, kind: &'static Kind) -> bool {
        self.tag(element).sound_for.is_some_and(|sound| std::ptr::eq(sound, kind))
    }

    /// Remembers that they are.
    pub(super) fn set_sound(&mut self, element: Element<'_>, kind: &'static Kind) {
        self.tag(element);
        self.tags[element.shape()].sound_for = Some(kind);
    }

    /// How many children have each of the [`FREQUENT`] names. Components and wires that hold nothing at all are told, and not kept.
    pub(super) fn counted(&mut self, element: Element<'_>) -> [usize; FREQUENT.len()] {
        let mut counted = [0; FREQUENT.len()];
        for child in element.children() {
            let place = usize::from(self.tag(child).frequent);
            if let Some(count) = counted.get_mut(place) {
                *count += usize::from(place < ALWAYS_KEPT || !child.is_bare());
            }
        }
        counted
    }

    /// The attribute of this name in no namespace.
    #[inline(always)]
    pub(super) fn attribute<'a>(&mut self, element: Element<'a>, name: &str) -> Option<Attribute<'a>> {
        let tag = self.tag(element);
        match usual(name) {
            Some(usual) if tag.has & 1 << usual != 0 => Some(element.nth_attribute(tag.places[usual].into())),
            _ if tag.has & OTHERS == 0 => None,
            _ => element.attribute(name),
        }
    }

    /// Whether the element has no attribute but some of these, which are usual ones, and declares no namespace.
    #[inline(always)]
    pub(super) fn has_only(&mut self, element: Element<'_>, names: &[&str]) -> bool {
        let allowed = names.iter().filter_map(|name| usual(name)).fold(0, |all, usual| all | 1 << usual);
        self.tag(element).has & !allowed == 0
    }

    /// The place of a usual attribute among those of an element that has it and no others but these.
    pub(super) fn only_of(&mut self, element: Element<'_>, names: &[&str], name: &str) -> Option<usize> {
        let place = usual(name)?;
        let has_only = self.has_only(element, names);
        let tag = self.tag(element);
        (has_only && tag.has & 1 << place != 0).then(|| tag.places[place].into())
    }
}
