use saoms_abi::{Bytes, ComponentTable, ImplementationTable};
use saoms_api::Failure;
use saoms_api::boundary::call_for_bytes;
use saoms_api::host::present::{Function, enter, looked_after, subject};
use saoms_api::host::{DynComponent, PropertyValue, SmolStr};

use super::component::{component, constructed, read};

/// The functions of a library for classes in other languages.
#[derive(Clone, Copy, Debug)]
pub(in crate::plugin) struct Implementation {
    table: &'static ImplementationTable,
    component: ComponentTable,
    library: &'static str,
}

impl Implementation {
    /// The functions of a table, and the path of its library.
    ///
    /// # Safety
    /// The functions of the table keep the rules of [the boundary](saoms_abi), for as long as the program runs.
    pub(in crate::plugin) unsafe fn new(table: &'static ImplementationTable, library: &'static str) -> Implementation {
        // SAFETY: as the caller promises, the pointer leads to a table.
        Implementation { table, component: unsafe { read(table.component) }, library }
    }

    /// What the library says of the class that a request names: JSON, as [`ImplementationTable::declare`] describes it.
    pub(in crate::plugin) fn declare(&self, request: &str) -> Result<Vec<u8>, Failure> {
        let owner = subject(self.library);
        let (declare, mut answer) = (self.table.declare, Vec::new());
        let _looked = looked_after(owner, Function::Load);
        let _entered = enter(owner, Function::Load);
        // SAFETY: `new`'s caller promised that the function keeps the rules; the rest is lent to this call.
        call_for_bytes(&mut answer, |sink, error| unsafe { declare(Bytes::text(request), sink, error) })?;
        Ok(answer)
    }

    /// Makes a component of the class that a request names.
    pub(in crate::plugin) fn construct(
        &self,
        request: &str,
        values: &[(SmolStr, PropertyValue)],
    ) -> Result<Box<dyn DynComponent>, Failure> {
        let owner = subject(self.library);
        let construct = self.table.construct;
        let (instance, refused) = constructed(owner, values, |values, count, made, findings, error| {
            // SAFETY: as in `declare`.
            unsafe { construct(Bytes::text(request), values, count, made, findings, error) }
        })?;
        component(self.component, instance, owner, refused)
    }
}
