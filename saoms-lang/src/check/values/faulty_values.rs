//! Values with a fault that is reported. Who finds a fault in one first says so here, and the others say no more of it.

use std::cell::RefCell;
use std::collections::HashSet;

use crate::diagnostic::{Code, codes};
use crate::source::Location;

/// The faulty values of a fleet by their places, which they keep however many composites give them on.
#[derive(Default)]
pub(crate) struct FaultyValues {
    /// Those that are not of the type of a property of a composite.
    mistyped: RefCell<HashSet<Location>>,
    /// Those that a class refuses, each with the code of its fault, and whether replicas take them.
    refused: RefCell<HashSet<(Location, &'static str, bool)>>,
}

impl FaultyValues {
    /// Adds a value that is not of the type of a property; `false` where it is known.
    pub(crate) fn add_mistyped(&self, at: Location) -> bool {
        self.mistyped.borrow_mut().insert(at)
    }

    pub(crate) fn is_mistyped(&self, at: Location) -> bool {
        self.mistyped.borrow().contains(&at)
    }

    /// Adds a value that the class of a component, which may be a replica, refuses.
    pub(crate) fn add_refused(&self, code: &'static Code, at: Location, is_copy: bool) {
        self.refused.borrow_mut().insert((at, code.id, is_copy));
    }

    /// True if a class refuses a value for what it is.
    pub(crate) fn is_refused(&self, at: Location) -> bool {
        let of_values = [&codes::VALUE_TYPE, &codes::VALUE_EMPTY, &codes::VALUE_RANGE, &codes::VALUE_NOT_ALLOWED];
        of_values.into_iter().any(|code| self.is_refused_of(code, at, false) || self.is_refused_of(code, at, true))
    }

    /// True if a value is refused with this code where a replica takes it, or where a component takes it that is none.
    pub(crate) fn is_refused_of(&self, code: &'static Code, at: Location, is_copy: bool) -> bool {
        self.refused.borrow().contains(&(at, code.id, is_copy))
    }
}
