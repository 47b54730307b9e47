//! Loops of components.

use super::origin::parts;
use super::{Origin, Property};
use crate::source::{Located, Text};

/// A `loop` of a component: it adds, replaces, removes, moves or parametrises one.
#[derive(Clone, Debug, PartialEq)]
pub struct LoopElement {
    /// The origin in its file.
    pub origin: Origin,
    /// `name`: what the loop is called within the component; empty, at the tag, when the file has none.
    pub name: Text,
    /// `class`: a name in the registry.
    pub class: Option<Box<Text>>,
    /// `before`: the loop that it stands directly before.
    pub before: Option<Box<Text>>,
    /// `after`: the loop that it stands directly after.
    pub after: Option<Box<Text>>,
    /// `remove`.
    pub remove: Option<Located<bool>>,
    /// Its properties in order.
    pub properties: Vec<Property>,
}

impl LoopElement {
    /// True if it takes the loop of its name away.
    pub fn is_removal(&self) -> bool {
        self.remove.is_some_and(|remove| remove.value)
    }
}

parts!(LoopElement);
