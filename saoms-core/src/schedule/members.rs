//! The components of a fleet by their paths.

use std::fmt;

use saoms_api::rule::nearest;

use super::engine::Engine;

/// Error: a fleet has no such periodic component.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UnknownComponent {
    name: String,
    /// True if it is no periodic one.
    passive: bool,
    /// The path of the most similar one.
    nearest: Option<String>,
}

impl fmt::Display for UnknownComponent {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.passive {
            write!(formatter, "component `{}` is passive: it has no executions that could be scheduled", self.name)
        } else {
            write!(formatter, "the fleet has no component `{}`", self.name)?;
            self.nearest.as_ref().map_or(Ok(()), |nearest| write!(formatter, "; did you mean `{nearest}`?"))
        }
    }
}

impl std::error::Error for UnknownComponent {}

impl Engine {
    /// The number of a periodic component of the fleet.
    pub(super) fn periodic(&self, component: &str) -> Result<u32, UnknownComponent> {
        let number = self.numbers.get(component).copied();
        let slot = number.map(|number| &self.slots[number as usize]).filter(|slot| slot.is_member());
        match (number, slot) {
            (Some(number), Some(slot)) if slot.policy.periodic => Ok(number),
            _ => Err(UnknownComponent { passive: slot.is_some(), ..self.unknown(component) }),
        }
    }

    /// The error of a component that the fleet does not have.
    pub(super) fn unknown(&self, component: &str) -> UnknownComponent {
        let members = self.slots.iter().filter(|slot| slot.is_member());
        let nearest = nearest(component, members.map(|slot| &*slot.name)).map(str::to_owned);
        UnknownComponent { name: component.to_owned(), passive: false, nearest }
    }
}
