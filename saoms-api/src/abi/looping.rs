use std::ffi::c_void;
use std::ptr;
use std::sync::{Mutex, PoisonError};

use crate::adaptation::Writable;
use crate::contain::contained;
use crate::{
    Context, DynEntries, DynLoop, Failure, Knowledge, LoopClass, LoopRegistration, PropertyValue, SmolStr,
    Snapshot,
};

use super::class::Construct;
use super::component::Desk;
use super::entries::{GivenEntries, Remote, RemoteKnowledge, give};
use super::guard::{guarded, guarded_construct, guarded_value};
use super::import;
use super::lease::Lent;
use super::{Bytes, EntriesHandle, FindingSink, HostHandle, PropertyView, Sink, Status};

/// A function of a loop, with its component's knowledge.
pub type Step = unsafe extern "C" fn(
    looping: *mut c_void,
    knowledge: *const EntriesHandle,
    host: *const HostHandle,
    error: Sink,
) -> Status;

/// A loop class: how to make loops of it, and their functions.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct LoopClassTable {
    /// The size of this table in bytes.
    pub size: usize,
    /// Makes a loop of it.
    pub construct: Construct,
    /// The functions of its loops.
    pub looping: *const LoopTable,
}

/// The functions of a loop. The first argument of each is the loop.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct LoopTable {
    /// The size of this table in bytes.
    pub size: usize,
    /// The name of an entry that it changes, by its number from 0; empty behind the last. It stays as long as the program runs.
    pub effect: unsafe extern "C" fn(looping: *mut c_void, number: u32) -> Bytes,
    /// The entries that it adds to the knowledge; 0 where there are none.
    pub entries: unsafe extern "C" fn(looping: *mut c_void, given: *mut EntriesHandle) -> u32,
    /// Asks for topics, references and entries. Called once, after all loops have added their entries.
    pub initialize: Step,
    /// Takes in what arrived and what is measured. Called in each execution, for all loops before the first one adapts.
    pub monitor: Step,
    /// Analyzes, plans and executes, and writes symptom and decision to the journal. What it changed, the caller sees by itself.
    pub adapt: Step,
    /// Ends the work.
    pub shutdown: Step,
    /// Frees the loop.
    pub destroy: unsafe extern "C" fn(looping: *mut c_void),
}

/// A loop that is given away, with its functions.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct LoopInstance {
    /// The loop.
    pub instance: *mut c_void,
    /// Its functions.
    pub table: *const LoopTable,
}

// SAFETY: what the pointer leads to is constant.
unsafe impl Sync for LoopClassTable {}

impl LoopClassTable {
    /// The table of a loop class.
    pub const fn of<L: LoopClass>() -> LoopClassTable {
        LoopClassTable { size: size_of::<LoopClassTable>(), construct: construct::<L>, looping: &TABLE }
    }
}

unsafe extern "C" fn construct<L: LoopClass>(
    values: *const PropertyView,
    count: usize,
    instance: *mut *mut c_void,
    findings: FindingSink,
    error: Sink,
) -> Status {
    let make = || {
        // SAFETY: the host lends the values to this call.
        let values = unsafe { PropertyView::read(values, count) }?;
        Ok(Exported::into_pointer(LoopRegistration::of::<L>().construct(&values)?))
    };
    // SAFETY: the host waits for the call with its sinks, and has a place for the pointer.
    unsafe { guarded_construct(findings, error, make, instance) }
}

/// Gives a loop of this side away.
pub(super) fn give_loop(instance: Box<dyn DynLoop>) -> LoopInstance {
    LoopInstance { instance: Exported::into_pointer(instance), table: &TABLE }
}

/// A loop of this side as the other one holds it.
struct Exported {
    instance: Box<dyn DynLoop>,
    desk: Desk,
    knowledge: Option<RemoteKnowledge>,
    /// Sees nothing: what the loop changes is looked at on the side of the knowledge.
    snapshot: Snapshot,
}

static TABLE: LoopTable = LoopTable {
    size: size_of::<LoopTable>(),
    effect: Exported::effect,
    entries: Exported::entries,
    initialize: Exported::initialize,
    monitor: Exported::monitor,
    adapt: Exported::adapt,
    shutdown: Exported::shutdown,
    destroy: Exported::destroy,
};

impl Exported {
    fn into_pointer(instance: Box<dyn DynLoop>) -> *mut c_void {
        let snapshot = Snapshot::blind();
        let exported = Exported { instance, desk: Desk::default(), knowledge: None, snapshot };
        Box::into_raw(Box::new(exported)).cast()
    }

    unsafe extern "C" fn effect(this: *mut c_void, number: u32) -> Bytes {
        // SAFETY: `this` comes from `into_pointer` and is used by this call alone.
        let exported = unsafe { &*this.cast::<Self>() };
        let effects = guarded_value(&[][..], || exported.instance.effects());
        effects.get(number as usize).map_or(Bytes::NONE, |name| Bytes::text(name))
    }

    unsafe extern "C" fn entries(this: *mut c_void, handle: *mut EntriesHandle) -> u32 {
        // SAFETY: as in `effect`; the caller gives a place for the handle.
        unsafe {
            let exported = &*this.cast::<Self>();
            let Ok(Some(entries)) = contained(|| exported.instance.entries()) else { return 0 };
            *handle = give(entries);
        }
        1
    }

    /// # Safety
    /// `this` comes from `into_pointer` and is used by this call alone; the handles are those of the call.
    unsafe fn step(
        this: *mut c_void,
        knowledge: *const EntriesHandle,
        host: *const HostHandle,
        takes_in: bool,
        code: impl FnOnce(
            &mut dyn DynLoop,
            &mut Snapshot,
            &mut dyn Knowledge,
            &mut Context<'_>,
        ) -> Result<(), Failure>,
    ) -> Result<(), Failure> {
        // SAFETY: as the caller promises.
        unsafe {
            let Exported { instance, desk, knowledge: known, snapshot } = &mut *this.cast::<Self>();
            let known = match known {
                Some(known) => {
                    known.renew(*knowledge);
                    known
                }
                none => {
                    let known = none.insert(RemoteKnowledge::new(*knowledge)?);
                    let own = instance.entries().map_or(&[][..], |entries| entries.declared());
                    known.extras_mut().permit(Writable { effects: instance.effects(), own });
                    known
                }
            };
            desk.with(&*host, takes_in, |context| code(&mut **instance, snapshot, known, context))
        }
    }

    unsafe extern "C" fn initialize(
        this: *mut c_void,
        knowledge: *const EntriesHandle,
        host: *const HostHandle,
        error: Sink,
    ) -> Status {
        // SAFETY: the caller keeps the table's contract.
        unsafe {
            guarded(error, || {
                Self::step(this, knowledge, host, false, |instance, _, knowledge, context| {
                    instance.initialize(knowledge, context)
                })
            })
        }
    }

    unsafe extern "C" fn monitor(
        this: *mut c_void,
        knowledge: *const EntriesHandle,
        host: *const HostHandle,
        error: Sink,
    ) -> Status {
        // SAFETY: as in `initialize`.
        unsafe {
            guarded(error, || {
                Self::step(this, knowledge, host, true, |instance, _, knowledge, context| {
                    instance.monitor(knowledge, context)
                })
            })
        }
    }

    unsafe extern "C" fn adapt(
        this: *mut c_void,
        knowledge: *const EntriesHandle,
        host: *const HostHandle,
        error: Sink,
    ) -> Status {
        // SAFETY: as in `initialize`.
        unsafe {
            guarded(error, || {
                Self::step(this, knowledge, host, false, |instance, snapshot, knowledge, context| {
                    instance.adapt(knowledge, snapshot, context)
                })
            })
        }
    }

    unsafe extern "C" fn shutdown(
        this: *mut c_void,
        knowledge: *const EntriesHandle,
        host: *const HostHandle,
        error: Sink,
    ) -> Status {
        // SAFETY: as in `initialize`.
        unsafe {
            guarded(error, || {
                Self::step(this, knowledge, host, false, |instance, _, knowledge, context| {
                    instance.shutdown(knowledge, context)
                })
            })
        }
    }

    unsafe extern "C" fn destroy(this: *mut c_void) {
        // SAFETY: the pointer is that of `into_pointer`, given back once.
        let _ = contained(|| drop(unsafe { Box::from_raw(this.cast::<Self>()) }));
    }
}

/// A loop class of the other side.
#[derive(Clone, Copy, Debug)]
pub struct ImportedLoopClass {
    construct: Construct,
    looping: LoopTable,
}

impl ImportedLoopClass {
    /// A loop class by its table.
    ///
    /// # Safety
    /// The functions of the table keep the rules of [the boundary](super), for as long as the program runs.
    pub const unsafe fn new(table: &LoopClassTable) -> ImportedLoopClass {
        // SAFETY: as the caller promises, the pointer leads to a table.
        ImportedLoopClass { construct: table.construct, looping: unsafe { *table.looping } }
    }

    /// Makes a loop.
    ///
    /// # Errors
    /// The loop refuses the values, or panics.
    pub fn construct(&self, values: &[(SmolStr, PropertyValue)]) -> Result<Box<dyn DynLoop>, Failure> {
        // SAFETY: `new`'s caller promised that the functions keep the rules; the loop is given away to this.
        unsafe { import_loop(import::construct(self.construct, values)?, self.looping) }
    }
}

/// Takes over a loop of the other side.
///
/// # Safety
/// It is given away to the caller, and its functions keep the rules of the boundary for as long as the program runs.
pub(super) unsafe fn import_loop(
    instance: *mut c_void,
    table: LoopTable,
) -> Result<Box<dyn DynLoop>, Failure> {
    let mut imported = ImportedLoop { instance, table, effects: &[], lent: Lent::default() };
    let mut effects = Vec::new();
    for number in 0.. {
        // SAFETY: as the caller promises; the names stay by the rules.
        let name = unsafe { (table.effect)(instance, number).get_text() }?;
        if name.is_empty() {
            break;
        }
        effects.push(name);
    }
    imported.effects = kept(effects);
    Ok(Box::new(imported))
}

/// The list as a constant. Loops of one class have the same, so the lists that are kept stay few.
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
    effects: &'static [&'static str],
    lent: Lent,
}

// SAFETY: the rules say that a loop is used by one thread at a time, not by which.
unsafe impl Send for ImportedLoop {}

impl ImportedLoop {
    fn step(
        &mut self,
        step: Step,
        knowledge: &mut dyn Knowledge,
        context: &mut Context<'_>,
    ) -> Result<(), Failure> {
        let instance = self.instance;
        self.lent.step(knowledge, context, |knowledge, host, error| {
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
            Remote::new(handle).ok().map(|remote| Box::new(GivenEntries(remote)) as Box<dyn DynEntries>)
        }
    }

    fn initialize(
        &mut self,
        knowledge: &mut dyn Knowledge,
        context: &mut Context<'_>,
    ) -> Result<(), Failure> {
        self.step(self.table.initialize, knowledge, context)
    }

    fn monitor(&mut self, knowledge: &mut dyn Knowledge, context: &mut Context<'_>) -> Result<(), Failure> {
        self.step(self.table.monitor, knowledge, context)
    }

    fn adapt(
        &mut self,
        knowledge: &mut dyn Knowledge,
        snapshot: &mut Snapshot,
        context: &mut Context<'_>,
    ) -> Result<(), Failure> {
        // When the loop decides is not seen from here, so the entries are looked at in any case.
        snapshot.take(knowledge);
        let result = self.step(self.table.adapt, knowledge, context);
        result.and(snapshot.tell(knowledge, context))
    }

    fn shutdown(&mut self, knowledge: &mut dyn Knowledge, context: &mut Context<'_>) -> Result<(), Failure> {
        self.step(self.table.shutdown, knowledge, context)
    }
}

impl Drop for ImportedLoop {
    fn drop(&mut self) {
        // SAFETY: the instance was given away to this, and is given back once.
        unsafe { (self.table.destroy)(self.instance) }
    }
}
