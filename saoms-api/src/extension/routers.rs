use smol_str::SmolStr;

use crate::Failure;
use crate::host::PropertyValue;

/// The values of a component, by the names of their properties.
type Values = [(SmolStr, PropertyValue)];

/// A class whose components are routers of networks: where one of them is in a program, the program listens at its
/// address, and others join the network there.
#[derive(Clone, Copy, Debug)]
pub struct RouterClass {
    /// The name of the class.
    pub class: &'static str,
    /// The address of a component with these properties, as the `url` of its clients says it.
    pub address: fn(&Values) -> Result<String, Failure>,
}

inventory::collect!(RouterClass);

impl RouterClass {
    /// The classes that are linked into this program, in no particular order.
    pub fn linked() -> impl Iterator<Item = &'static RouterClass> {
        inventory::iter::<RouterClass>()
    }
}
