//! Where attributes stand in components that are written alike.

use super::Origin;
use crate::source::Span;
use crate::xml::{Attribute, Document, Element};

/// Where an attribute is in each component of a form.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Place {
    /// Its element, counted from that of the component.
    pub(crate) element: u32,
    /// How the start tag of that is written, its place among the attributes there, and among all of the component, with the bit of that.
    shape: u32,
    at: u32,
    pub(crate) nth: u32,
    pub(crate) bit: u64,
    /// How far before the first value of its element the name of that is, and how long.
    back: u32,
    name_len: u32,
}

impl Place {
    /// That of an attribute of a part of a component: the one at this place among all that are written in it.
    pub(crate) fn of(component: Element<'_>, part: Element<'_>, at: usize) -> Self {
        let nth = part.values_behind(component) + at as u32;
        let (first, name) = (part.nth_attribute(0).value_span(), part.name_span());
        Self {
            element: part.id().0 - component.id().0,
            shape: part.shape() as u32,
            at: at as u32,
            nth,
            bit: 1_u64.checked_shl(nth).unwrap_or_default(),
            back: first.start - name.start,
            name_len: name.len(),
        }
    }
}

/// A component that is written as others are, whose attributes are found by their places.
#[derive(Clone, Copy)]
pub(crate) struct Copied<'d> {
    element: Element<'d>,
    /// Where its values are, and those behind them.
    values: &'d [Span],
}

impl<'d> Copied<'d> {
    pub(crate) fn new(element: Element<'d>) -> Self {
        Self { element, values: element.values() }
    }

    pub(crate) fn element(&self) -> Element<'d> {
        self.element
    }

    /// The document that it is in.
    pub(crate) fn document(&self) -> &'d Document {
        self.element.document()
    }

    /// Where the value of an attribute is.
    #[inline]
    pub(crate) fn value(&self, place: Place) -> Span {
        self.values[place.nth as usize]
    }

    #[inline]
    pub(crate) fn attribute(&self, place: Place) -> Attribute<'d> {
        Attribute::of(self.document(), (place.shape, place.at), self.value(place))
    }

    /// Where the element comes from that has an attribute.
    #[inline]
    pub(crate) fn origin(&self, place: Place) -> Origin {
        let start = self.values[(place.nth - place.at) as usize].start - place.back;
        let element = self.element.id().further(place.element);
        Origin { tag: Span::new(start, start + place.name_len).in_file(self.document().file()), element }
    }
}
