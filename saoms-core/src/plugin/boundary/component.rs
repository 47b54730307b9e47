use std::ffi::c_void;
use std::mem::MaybeUninit;
use std::ptr;

use saoms_abi::{Bytes, ClassTable, ComponentTable, Construct, FindingSink, HostHandle, PropertyView, Sink, Status};
use saoms_api::boundary::{Lease, PropertyViews, call, call_for_bytes, call_with_findings};
use saoms_api::host::contain::contained;
use saoms_api::host::present::{Function, Owner, enter, looked_after, subject};
use saoms_api::host::{DynComponent, Invocation, PropertyValue, SmolStr};
use saoms_api::{CallError, Context, Failure, ReportValue, Saved};

use super::status::read_status;

/// A class of a plugin.
#[derive(Clone, Copy, Debug)]
pub struct ImportedClass {
    construct: Construct,
    component: ComponentTable,
    library: &'static str,
}

impl ImportedClass {
    /// A class from its table, and the path of its library.
    ///
    /// # Safety
    /// The functions of the table keep the rules of [the boundary](saoms_abi), for as long as the program runs.
    pub unsafe fn new(table: &ClassTable, library: &'static str) -> ImportedClass {
        // SAFETY: as the caller promises, the pointer leads to a table.
        ImportedClass { construct: table.construct, component: unsafe { read(table.component) }, library }
    }

    /// True if its components have this function, of those that may be null.
    pub fn has(&self, function: &str) -> bool {
        let ComponentTable { save, restore, waits_for, react, update, status, .. } = self.component;
        match function {
            "save" => save.is_some(),
            "restore" => restore.is_some(),
            "waits_for" => waits_for.is_some(),
            "react" => react.is_some(),
            "update" => update.is_some(),
            "status" => status.is_some(),
            _ => false,
        }
    }

    /// Makes a component.
    ///
    /// # Errors
    /// The class refuses the values, or panics.
    pub fn construct(&self, values: &[(SmolStr, PropertyValue)]) -> Result<Box<dyn DynComponent>, Failure> {
        let owner = subject(self.library);
        // SAFETY: `new`'s caller promised that the function keeps the rules.
        let (instance, refused) = unsafe { construct(self.construct, owner, values) }?;
        component(self.component, instance, owner, refused)
    }
}

/// A component that was made, unless the constructor refused what it made.
pub(super) fn component(
    table: ComponentTable,
    instance: *mut c_void,
    owner: &'static Owner,
    refused: Result<(), Failure>,
) -> Result<Box<dyn DynComponent>, Failure> {
    let component = ImportedComponent { table, instance, owner, lease: Lease::default() };
    refused?;
    Ok(Box::new(component))
}

/// A copy of the functions of components, with null for those that the library does not have.
///
/// # Safety
/// The pointer leads to a table, with all functions that may not be null.
pub(super) unsafe fn read(table: *const ComponentTable) -> ComponentTable {
    let mut copy = MaybeUninit::<ComponentTable>::zeroed();
    // SAFETY: as the caller promises, so many bytes are there. All functions that may not be null are among them, and
    // zeros are a null function.
    unsafe {
        let size = (*table.cast::<usize>()).min(size_of::<ComponentTable>());
        // Whole members alone: the size and each function are as large as this.
        let size = size - size % size_of::<usize>();
        copy.as_mut_ptr().cast::<u8>().copy_from_nonoverlapping(table.cast(), size);
        copy.assume_init()
    }
}

/// Constructs a component or a loop of a plugin. The inner result refuses what was made, which is the caller's in any
/// case: the constructor found something and yet says that all is well.
///
/// # Safety
/// The function keeps the rules of the boundary.
pub(super) unsafe fn construct(
    construct: Construct,
    owner: &'static Owner,
    values: &[(SmolStr, PropertyValue)],
) -> Result<(*mut c_void, Result<(), Failure>), Failure> {
    constructed(owner, values, |values, count, made, findings, error| {
        // SAFETY: as the caller promises; the rest is lent to this call.
        unsafe { construct(values, count, made, findings, error) }
    })
}

/// The same by a function that may have further arguments, and keeps the rules of the boundary.
pub(super) fn constructed(
    owner: &'static Owner,
    values: &[(SmolStr, PropertyValue)],
    construct: impl Fn(*const PropertyView, usize, *mut *mut c_void, FindingSink, Sink) -> Status,
) -> Result<(*mut c_void, Result<(), Failure>), Failure> {
    let views = PropertyViews::of(values);
    let mut instance = ptr::null_mut();
    let _looked = looked_after(owner, Function::Construct);
    let _entered = enter(owner, Function::Construct);
    // An exception of another language ends the program here, where it is known whose it is.
    let (result, findings) = contained(|| {
        call_with_findings(|findings, error| {
            construct(views.top.as_ptr(), views.top.len(), &raw mut instance, findings, error)
        })
    })?;
    let is_content = findings.is_empty();
    let with_findings = |message: String| -> Failure {
        match findings.into_iter().collect() {
            Ok(findings) => Failure::with_findings(message, findings),
            Err(unreadable) => unreadable,
        }
    };
    match result {
        Ok(()) if is_content => Ok((instance, Ok(()))),
        Ok(()) => {
            Ok((instance, Err(with_findings("the constructor reported a finding, but returned no failure".to_owned()))))
        }
        Err(failure) => Err(with_findings(failure.message().to_owned())),
    }
}

/// A component of a plugin.
#[derive(Debug)]
struct ImportedComponent {
    table: ComponentTable,
    instance: *mut c_void,
    owner: &'static Owner,
    lease: Lease,
}

// SAFETY: the rules say that a component is used by one thread at a time, not by which.
unsafe impl Send for ImportedComponent {}

impl ImportedComponent {
    #[inline]
    fn call(
        &mut self,
        context: &mut Context<'_>,
        called: Function,
        function: unsafe extern "C" fn(*mut c_void, *const HostHandle, Sink) -> Status,
    ) -> Result<(), Failure> {
        let instance = self.instance;
        let _entered = enter(self.owner, called);
        // SAFETY: the functions keep the rules, the instance is theirs, and the handle is lent to this call.
        self.lease.call(context, |handle, error| unsafe { function(instance, handle, error) })
    }
}

impl DynComponent for ImportedComponent {
    fn initialize(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        let _looked = looked_after(self.owner, Function::Initialize);
        self.call(context, Function::Initialize, self.table.initialize)
    }

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.call(context, Function::Execute, self.table.execute)
    }

    fn react(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        let react =
            self.table.react.ok_or("its library has no function `react`, although its class says that it reacts")?;
        self.call(context, Function::React, react)
    }

    fn update(&mut self, values: &[(SmolStr, PropertyValue)]) -> Result<(), Failure> {
        let update = self.table.update.ok_or("its library has no function `update`")?;
        let (instance, views) = (self.instance, PropertyViews::of(values));
        let _entered = enter(self.owner, Function::Update);
        // SAFETY: the functions keep the rules, the instance is theirs, and the rest is lent to this call.
        call(|error| unsafe { update(instance, views.top.as_ptr(), views.top.len(), error) })
    }

    fn shutdown(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.call(context, Function::Shutdown, self.table.shutdown)
    }

    fn serve(&mut self, invocation: &mut Invocation<'_>, context: &mut Context<'_>) -> Result<(), CallError> {
        let arguments = invocation.call.arguments();
        let (service, operation) = (Bytes::text(invocation.service), invocation.call.operation());
        let (serve, instance) = (self.table.serve, self.instance);
        let _entered = enter(self.owner, Function::Serve);
        let reply = self.lease.serve(context, |handle, reply, error| {
            // SAFETY: the functions keep the rules, the instance is theirs, and the rest is lent to this call.
            unsafe { serve(instance, handle, service, operation, Bytes::lend(&arguments), reply, error) }
        })?;
        invocation.call.reply(reply)
    }

    fn save(&mut self) -> Result<Saved, Failure> {
        let Some(save) = self.table.save else { return Ok(Saved::default()) };
        let (instance, mut bytes) = (self.instance, Vec::new());
        let _entered = enter(self.owner, Function::Save);
        // SAFETY: the functions keep the rules, the instance is theirs, and the sinks are lent to this call.
        call_for_bytes(&mut bytes, |saved, error| unsafe { save(instance, saved, error) })?;
        Ok(Saved::from_bytes(bytes))
    }

    fn restore(&mut self, saved: &Saved) -> Result<(), Failure> {
        let Some(restore) = self.table.restore else {
            return Err("the earlier build saved its state, and this one has no function `restore`".into());
        };
        let instance = self.instance;
        let _entered = enter(self.owner, Function::Restore);
        // SAFETY: as in `save`.
        call(|error| unsafe { restore(instance, Bytes::lend(saved.bytes()), error) })
    }

    fn waits_for(&self) -> Result<Option<String>, Failure> {
        let Some(waits_for) = self.table.waits_for else { return Ok(None) };
        let (instance, mut bytes) = (self.instance, Vec::new());
        let _entered = enter(self.owner, Function::WaitsFor);
        // SAFETY: as in `save`.
        call_for_bytes(&mut bytes, |text, error| unsafe { waits_for(instance, text, error) })?;
        let text = String::from_utf8(bytes)
            .map_err(|_| Failure::new("the text that it returned as the reason for its wait is not UTF-8"))?;
        Ok(Some(text).filter(|text| !text.is_empty()))
    }

    fn status(&self) -> Result<Vec<(String, ReportValue)>, Failure> {
        let Some(status) = self.table.status else { return Ok(Vec::new()) };
        let (instance, mut bytes) = (self.instance, Vec::new());
        let _entered = enter(self.owner, Function::Status);
        // SAFETY: as in `save`.
        call_for_bytes(&mut bytes, |values, error| unsafe { status(instance, values, error) })?;
        read_status(&bytes)
    }
}

impl Drop for ImportedComponent {
    fn drop(&mut self) {
        let _entered = enter(self.owner, Function::Destroy);
        // SAFETY: the instance is the one that `construct` gave, and is given back once.
        unsafe { (self.table.destroy)(self.instance) }
    }
}
