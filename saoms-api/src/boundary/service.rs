use std::any::Any;

use saoms_abi::Sink;

use crate::CallError;
use crate::host::present::{Function, Owner, enter, here};
use crate::host::{Operation, ServiceCall};

/// A call that came across the boundary: its arguments and its reply are bytes.
pub(super) struct BytesCall<'a> {
    operation: Operation,
    arguments: &'a [u8],
    reply: Sink,
    /// The code that calls, and takes the reply.
    caller: Option<(&'static Owner, Function)>,
}

impl BytesCall<'_> {
    /// # Safety
    /// The sink's owner waits for as long as the call is used.
    pub(super) unsafe fn new(operation: Operation, arguments: &[u8], reply: Sink) -> BytesCall<'_> {
        BytesCall { operation, arguments, reply, caller: here() }
    }
}

impl ServiceCall for BytesCall<'_> {
    fn operation(&self) -> Operation {
        self.operation
    }

    fn typed(&mut self) -> Option<(&mut dyn Any, &mut dyn Any)> {
        None
    }

    fn arguments(&mut self) -> Vec<u8> {
        self.arguments.to_vec()
    }

    fn reply(&mut self, bytes: &[u8]) -> Result<(), CallError> {
        let _entered = self.caller.map(|(owner, function)| enter(owner, function));
        // SAFETY: `new`'s caller promised that the owner waits.
        unsafe { self.reply.put(bytes) };
        Ok(())
    }
}
