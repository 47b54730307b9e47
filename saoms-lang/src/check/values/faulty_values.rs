//! Values with a fault that is reported. Who finds a fault in one first adds it here, and the others skip the value.

use std::cell::RefCell;
use std::collections::HashSet;

use crate::diagnostic::{Code, codes};
use crate::source::Location;

/// The faulty values of a fleet by their places, which they keep however many composites give them on: each with the
/// code of its fault, and whether a replica takes it.
#[derive(Default)]
pub(crate) struct FaultyValues(RefCell<HashSet<(Location, &'static str, bool)>>);

impl FaultyValues {
    /// Adds a value; `false` where it is known.
    pub(crate) fn add(&self, code: &'static Code, at: Location, is_copy: bool) -> bool {
        self.0.borrow_mut().insert((at, code.id, is_copy))
    }

    pub(crate) fn has(&self, code: &'static Code, at: Location, is_copy: bool) -> bool {
        self.0.borrow().contains(&(at, code.id, is_copy))
    }

    /// True if a class refuses a value for what it is.
    pub(crate) fn is_refused(&self, at: Location) -> bool {
        let of_values = [&codes::VALUE_TYPE, &codes::VALUE_EMPTY, &codes::VALUE_RANGE, &codes::VALUE_NOT_ALLOWED];
        of_values.into_iter().any(|code| self.has(code, at, false) || self.has(code, at, true))
    }
}
