use std::cell::RefCell;
use std::ffi::c_void;
use std::ptr;
use std::sync::{Mutex, PoisonError};

use saoms_abi::{EntriesHandle, LoopTable, Step};

use crate::boundary::entries::{OwnedRemoteEntries, RemoteEntries};
use crate::boundary::lease::Lease;
use crate::host::present::{Function, Owner, enter};
use crate::host::{DynEntries, DynLoop, Snapshot};
use crate::{Context, Failure, Knowledge};

/// Takes over a loop of the other side.
///
/// # Errors
/// A name of an entry that it changes cannot be read.
///
/// # Safety
/// It is given away to the caller, and its functions keep the rules of the boundary for as long as the program runs.
pub unsafe fn import_loop(
    instance: *mut c_void,
    table: LoopTable,
    owner: &'static Owner,
) -> Result<Box<dyn DynLoop>, Failure> {
    let mut imported =
        ImportedLoop { instance, table, owner, effects: &[], lease: Lease::default(), fault: RefCell::default() };
    let _entered = enter(owner, Function::Construct);
    let mut effects = Vec::new();
    for number in 0.. {
        // SAFETY: as the caller promises; the names stay by the rules.
        let name = unsafe { (table.effect)(instance, number).get_text() }?;
        if name.is_empty() {
            break;
        }
        if effects.len() >= MOST_EFFECTS {
            return Err(Failure::new(format!(
                "names more than {MOST_EFFECTS} entries that it changes: `effect` has to end with an empty text"
            )));
        }
        effects.push(name);
    }
    imported.effects = kept(effects);
    Ok(Box::new(imported))
}

/// Greatest number of entries that a loop changes.
const MOST_EFFECTS: usize = 1000;

/// The list as a constant. Loops of one class have the same, so few lists are kept.
fn kept(list: Vec<&'static str>) -> &'static [&'static str] {
    static KNOWN: Mutex<Vec<&'static [&'static str]>> = Mutex::new(Vec::new());
    let mut known = KNOWN.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(same) = known.iter().find(|same| ***same == *list) {
        return same;
    }
    let new: &'static [&'static str] = list.leak();
    known.push(new);
    new
}

/// A loop of the other side.
struct ImportedLoop {
    instance: *mut c_void,
    table: LoopTable,
    owner: &'static Owner,
    effects: &'static [&'static str],
    lease: Lease,
    /// The fault of its entries, which `initialize` reports, because it has no entries then.
    fault: RefCell<Option<Failure>>,
}

// SAFETY: the rules say that a loop is used by one thread at a time, not by which.
unsafe impl Send for ImportedLoop {}

impl ImportedLoop {
    fn step(
        &mut self,
        function: Function,
        step: Step,
        knowledge: &mut dyn Knowledge,
        context: &mut Context<'_>,
    ) -> Result<(), Failure> {
        let instance = self.instance;
        let _entered = enter(self.owner, function);
        self.lease.step(knowledge, context, |knowledge, host, error| {
            // SAFETY: the functions keep the rules, the instance is theirs, and the handles are lent to this call.
            unsafe { step(instance, knowledge, host, error) }
        })
    }
}

impl DynLoop for ImportedLoop {
    fn effects(&self) -> &'static [&'static str] {
        self.effects
    }

    fn entries(&self) -> Option<Box<dyn DynEntries>> {
        let mut handle = EntriesHandle { state: ptr::null_mut(), functions: ptr::null() };
        // SAFETY: the functions keep the rules; what they give away is this side's.
        unsafe {
            if (self.table.entries)(self.instance, &raw mut handle) == 0 {
                return None;
            }
            match RemoteEntries::new(handle) {
                Ok(remote) => Some(Box::new(OwnedRemoteEntries(remote))),
                Err(failure) => {
                    self.fault.replace(Some(failure));
                    None
                }
            }
        }
    }

    fn initialize(&mut self, knowledge: &mut dyn Knowledge, context: &mut Context<'_>) -> Result<(), Failure> {
        if let Some(failure) = self.fault.take() {
            return Err(Failure::new(format!("the entries that it adds cannot be used: {failure}")));
        }
        self.step(Function::Initialize, self.table.initialize, knowledge, context)
    }

    fn monitor(&mut self, knowledge: &mut dyn Knowledge, context: &mut Context<'_>) -> Result<(), Failure> {
        self.step(Function::Monitor, self.table.monitor, knowledge, context)
    }

    fn adapt(
        &mut self,
        knowledge: &mut dyn Knowledge,
        snapshot: &mut Snapshot,
        context: &mut Context<'_>,
    ) -> Result<(), Failure> {
        // A decision of the loop is not seen from here, so the entries are compared in any case.
        snapshot.take(knowledge);
        let result = self.step(Function::Adapt, self.table.adapt, knowledge, context);
        result.and(snapshot.record(knowledge, context))
    }

    fn shutdown(&mut self, knowledge: &mut dyn Knowledge, context: &mut Context<'_>) -> Result<(), Failure> {
        self.step(Function::Shutdown, self.table.shutdown, knowledge, context)
    }
}

impl Drop for ImportedLoop {
    fn drop(&mut self) {
        let _entered = enter(self.owner, Function::Destroy);
        // SAFETY: the instance was given away to this, and is given back once.
        unsafe { (self.table.destroy)(self.instance) }
    }
}
