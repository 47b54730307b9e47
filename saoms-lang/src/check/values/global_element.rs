//! Properties that are typed by a global element: their values are such elements, not what is inside. Only those who
//! have the schema of that element can judge them.

use super::raw::{Piece, Raw};
use super::type_name::local;
use crate::model::Property;

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
            Piece::Whole(_, root, instance) if root.local_name() == name => Raw::of_elements(&[root], instance).0,
            other => vec![other],
        });
        Self(pieces.collect())
    }

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
