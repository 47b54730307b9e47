use saoms_abi::{Construct, LoopClassTable, LoopTable};
use saoms_api::Failure;
use saoms_api::boundary::import_loop;
use saoms_api::host::present::subject;
use saoms_api::host::{DynLoop, PropertyValue, SmolStr};

use super::component::construct;

/// A loop class of a plugin.
#[derive(Clone, Copy, Debug)]
pub struct ImportedLoopClass {
    construct: Construct,
    looping: LoopTable,
    library: &'static str,
}

impl ImportedLoopClass {
    /// A loop class from its table, and the path of its library.
    ///
    /// # Safety
    /// The functions of the table keep the rules of [the boundary](saoms_abi), for as long as the program runs.
    pub const unsafe fn new(table: &LoopClassTable, library: &'static str) -> ImportedLoopClass {
        // SAFETY: as the caller promises, the pointer leads to a table.
        ImportedLoopClass { construct: table.construct, looping: unsafe { *table.looping }, library }
    }

    /// Makes a loop.
    ///
    /// # Errors
    /// The loop refuses the values, or panics.
    pub fn construct(&self, values: &[(SmolStr, PropertyValue)]) -> Result<Box<dyn DynLoop>, Failure> {
        let owner = subject(self.library);
        // SAFETY: `new`'s caller promised that the functions keep the rules.
        let (instance, refused) = unsafe { construct(self.construct, owner, values) }?;
        // SAFETY: the same; the loop is given away to this.
        let looping = unsafe { import_loop(instance, self.looping, owner) };
        refused.and(looping)
    }
}
