use crate::host::{DynComponent, LoopRegistration, PropertyValue, SmolStr};
use crate::{Class, Failure, Properties};

/// The function that makes a component from the values of its properties.
type Construct = fn(&[(SmolStr, PropertyValue)]) -> Result<Box<dyn DynComponent>, Failure>;

/// Registration of a class: its declaration as text, and its constructor. `#[derive(Class)]` submits one for every
/// class that is linked in; a registry value collects them with [`Registration::linked`].
#[derive(Clone, Copy, Debug)]
pub struct Registration {
    declaration: &'static str,
    construct: Construct,
    loops: &'static [LoopRegistration],
}

impl Registration {
    /// The registration of a class.
    pub const fn of<C: Class>() -> Registration {
        Registration {
            declaration: C::DECLARATION,
            construct: |values| Ok(Box::new(C::new(C::Properties::from_values(values)?)?)),
            loops: C::LOOPS,
        }
    }

    /// The class's declaration, in the shape of [`crate::host::declaration`].
    pub const fn declaration(&self) -> &'static str {
        self.declaration
    }

    /// Constructs a component from the values that its composite gives; absent ones take their defaults.
    ///
    /// # Errors
    /// A value is missing or wrong (the checker finds these before, with their place), or the values do not fit
    /// together.
    pub fn construct(&self, values: &[(SmolStr, PropertyValue)]) -> Result<Box<dyn DynComponent>, Failure> {
        (self.construct)(values)
    }

    /// The loops that the declaration names.
    pub const fn loops(&self) -> &'static [LoopRegistration] {
        self.loops
    }

    /// The classes that are linked into this program, in no particular order.
    pub fn linked() -> impl Iterator<Item = &'static Registration> {
        inventory::iter::<Registration>()
    }
}

inventory::collect!(Registration);
