use std::ffi::c_void;
use std::ptr;

use crate::{CallError, Context, DynComponent, Failure, Invocation, PropertyValue};

use super::component::call;
use super::data::PropertyViews;
use super::guard::call_outcome;
use super::lend::{Lent, with_handle};
use super::{Bytes, ClassTable, HostHandle, Sink, Status};

/// A class of the other side.
#[derive(Clone, Copy, Debug)]
pub struct ImportedClass {
    table: ClassTable,
}

impl ImportedClass {
    /// A class by its table.
    ///
    /// # Safety
    /// The functions of the table keep the rules of [the boundary](super), for as long as the program runs.
    pub const unsafe fn new(table: ClassTable) -> ImportedClass {
        ImportedClass { table }
    }

    /// Makes a component.
    ///
    /// # Errors
    /// The class refuses the values, or panics.
    pub fn construct(&self, values: &[(String, PropertyValue)]) -> Result<Box<dyn DynComponent>, Failure> {
        let views = PropertyViews::of(values);
        let mut instance = ptr::null_mut();
        // SAFETY: `new`'s caller promised that the functions keep the rules; the rest is lent to this call.
        call(|error| unsafe {
            (self.table.construct)(views.top.as_ptr(), views.top.len(), &raw mut instance, error)
        })?;
        Ok(Box::new(ImportedComponent { class: *self, instance, lent: Lent::default() }))
    }
}

/// A component of the other side.
#[derive(Debug)]
pub struct ImportedComponent {
    class: ImportedClass,
    instance: *mut c_void,
    lent: Lent,
}

// SAFETY: the rules say that a component is used by one thread at a time, not by which.
unsafe impl Send for ImportedComponent {}

impl ImportedComponent {
    #[inline]
    fn call(
        &mut self,
        context: &mut Context<'_>,
        function: unsafe extern "C" fn(*mut c_void, *const HostHandle, Sink) -> Status,
    ) -> Result<(), Failure> {
        let instance = self.instance;
        with_handle(context, &mut self.lent, |handle| {
            // SAFETY: the functions keep the rules, the instance is theirs, and the handle is lent to this call.
            call(|error| unsafe { function(instance, handle, error) })
        })
    }
}

impl DynComponent for ImportedComponent {
    fn initialize(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.call(context, self.class.table.component.initialize)
    }

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.call(context, self.class.table.component.execute)
    }

    fn shutdown(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.call(context, self.class.table.component.shutdown)
    }

    fn serve(&mut self, invocation: &mut Invocation<'_>, context: &mut Context<'_>) -> Result<(), CallError> {
        let arguments = invocation.call.arguments();
        let (mut reply, mut error) = (Vec::new(), Vec::new());
        let (into_reply, into_error) = (Sink::into(&mut reply), Sink::into(&mut error));
        let (service, operation) = (Bytes::text(invocation.service), invocation.call.operation());
        let (serve, instance) = (self.class.table.component.serve, self.instance);
        let status = with_handle(context, &mut self.lent, |handle| {
            // SAFETY: the functions keep the rules, the instance is theirs, and the rest is lent to this call.
            unsafe {
                serve(instance, handle, service, operation, Bytes::lend(&arguments), into_reply, into_error)
            }
        });
        call_outcome(status, &error)?;
        invocation.call.reply(&reply)
    }
}

impl Drop for ImportedComponent {
    fn drop(&mut self) {
        // SAFETY: the instance is the one that `construct` gave, and is given back once.
        unsafe { (self.class.table.component.destroy)(self.instance) }
    }
}
