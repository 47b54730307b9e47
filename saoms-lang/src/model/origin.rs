//! Origins: the places of parts of the model in their files.

use crate::source::{FileId, Location};
use crate::syntax::{Document, Element, ElementId};

/// The element that a part of the model was made from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Origin {
    /// The name in its start tag: where a diagnostic about the whole part points.
    pub tag: Location,
    /// The element in the document of the file.
    pub element: ElementId,
}

impl Origin {
    /// The origin of what is made from `element`.
    pub fn of(element: Element<'_>) -> Self {
        Self { tag: element.name_location(), element: element.id() }
    }

    /// The file.
    pub const fn file(self) -> FileId {
        self.tag.file
    }

    /// The element itself, in the document of the composite of the same file.
    pub fn element(self, document: &Document) -> Element<'_> {
        debug_assert_eq!(document.file(), self.file());
        document.element(self.element)
    }
}

/// A part of the model, which has an origin.
pub trait Part {
    /// The origin in its file.
    fn origin(&self) -> Origin;

    /// The name in its start tag.
    fn tag(&self) -> Location {
        self.origin().tag
    }
}

macro_rules! parts {
    ($($part:ty),*) => {
        $(impl crate::model::Part for $part {
            fn origin(&self) -> crate::model::Origin {
                self.origin
            }
        })*
    };
}
pub(super) use parts;
