use std::ffi::c_void;
use std::ptr;

use crate::adaptation::Writable;
use crate::contain::contained;
use crate::{
    Context, DynEntries, DynLoop, Failure, Knowledge, LoopClass, Phase, Properties, PropertyValue,
    Recordable, Snapshot, Subject,
};

use super::component::{Desk, call};
use super::data::PropertyViews;
use super::entries::{GivenEntries, Remote, RemoteKnowledge, give, with_knowledge};
use super::guard::guarded;
use super::host::{Lent, with_handle};
use super::{Bytes, EntriesHandle, HostHandle, PropertyView, Sink, Status};

/// A function of a loop: the loop, its component's knowledge, the host, where an error goes.
type Step = unsafe extern "C" fn(*mut c_void, *const EntriesHandle, *const HostHandle, Sink) -> Status;

/// A loop: how to make one, and its functions. [`Loop`](crate::Loop) says when each is called.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
#[expect(missing_docs, reason = "named as the functions of `Loop`, which says what they mean")]
pub struct LoopTable {
    /// The size of this table in bytes.
    pub size: usize,
    /// Makes a loop from the values that the composite gives: a list and its length, where the loop goes, where an error goes.
    pub construct: unsafe extern "C" fn(*const PropertyView, usize, *mut *mut c_void, Sink) -> Status,
    /// The name of an entry that it changes, by its number from 0; empty behind the last.
    pub effect: unsafe extern "C" fn(u32) -> Bytes,
    /// The entries that it adds to the knowledge; 0 where there are none.
    pub entries: unsafe extern "C" fn(*mut EntriesHandle) -> u32,
    pub initialize: Step,
    pub monitor: Step,
    /// Analyzes, plans and executes, and writes symptom and decision to the journal. What it changed the host sees by itself.
    pub adapt: Step,
    pub shutdown: Step,
    /// Frees the loop.
    pub destroy: unsafe extern "C" fn(*mut c_void),
}

/// A loop of this side as the other one holds it.
struct Exported<L> {
    instance: L,
    desk: Desk,
    knowledge: Option<RemoteKnowledge>,
}

impl LoopTable {
    /// The table of a loop.
    pub const fn of<L: LoopClass>() -> LoopTable {
        LoopTable {
            size: size_of::<LoopTable>(),
            construct: Exported::<L>::construct,
            effect: Exported::<L>::effect,
            entries: Exported::<L>::entries,
            initialize: Exported::<L>::initialize,
            monitor: Exported::<L>::monitor,
            adapt: Exported::<L>::adapt,
            shutdown: Exported::<L>::shutdown,
            destroy: Exported::<L>::destroy,
        }
    }
}

impl<L: LoopClass> Exported<L> {
    unsafe extern "C" fn construct(
        values: *const PropertyView,
        count: usize,
        instance: *mut *mut c_void,
        error: Sink,
    ) -> Status {
        // SAFETY: the host lends the values to this call, and a place for the pointer.
        unsafe {
            guarded(error, || {
                let values = PropertyView::read(values, count)?;
                let made = L::new(L::Properties::from_values(&values)?)?;
                let exported = Exported { instance: made, desk: Desk::default(), knowledge: None };
                *instance = Box::into_raw(Box::new(exported)).cast();
                Ok(())
            })
        }
    }

    unsafe extern "C" fn effect(number: u32) -> Bytes {
        L::EFFECTS.get(number as usize).map_or(Bytes::NONE, |name| Bytes::text(name))
    }

    unsafe extern "C" fn entries(handle: *mut EntriesHandle) -> u32 {
        let Ok(Some(entries)) = contained(|| <L as LoopClass>::entries()) else { return 0 };
        // SAFETY: the host gives a place for the handle.
        unsafe { *handle = give(entries) };
        1
    }

    /// # Safety
    /// `this` comes from `construct` and is used by this call alone; the handles are those of the call.
    unsafe fn step(
        this: *mut c_void,
        knowledge: *const EntriesHandle,
        host: *const HostHandle,
        takes_in: bool,
        code: impl FnOnce(&mut L, &mut L::Knowledge, &mut Context<'_>) -> Result<(), Failure>,
    ) -> Result<(), Failure> {
        // SAFETY: as the caller promises.
        unsafe {
            let exported = &mut *this.cast::<Self>();
            let remote = match &mut exported.knowledge {
                Some(known) => {
                    known.renew(*knowledge);
                    known
                }
                none => none.insert(RemoteKnowledge::new(*knowledge)?),
            };
            let own = <L as LoopClass>::entries().map_or(&[][..], |entries| entries.declared());
            remote.extras_mut().permit(Writable { effects: L::EFFECTS, own });
            let Some(subject) = L::Knowledge::of(remote) else {
                return Err(Failure::new(
                    "this loop works on the struct of a component that is built with it: in a plugin, give it `type Knowledge = dyn Knowledge`",
                ));
            };
            let instance = &mut exported.instance;
            exported.desk.with(&*host, takes_in, |context| code(instance, subject, context))?
        }
    }

    unsafe extern "C" fn initialize(
        this: *mut c_void,
        knowledge: *const EntriesHandle,
        host: *const HostHandle,
        error: Sink,
    ) -> Status {
        // SAFETY: the host calls with what the table's contract says.
        unsafe { guarded(error, || Self::step(this, knowledge, host, false, L::initialize)) }
    }

    unsafe extern "C" fn monitor(
        this: *mut c_void,
        knowledge: *const EntriesHandle,
        host: *const HostHandle,
        error: Sink,
    ) -> Status {
        // SAFETY: as in `initialize`.
        unsafe { guarded(error, || Self::step(this, knowledge, host, true, L::monitor)) }
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
                Self::step(this, knowledge, host, false, |instance, knowledge, context| {
                    let Some(symptom) = instance.analyze(knowledge, context)? else { return Ok(()) };
                    context.journal(Phase::Symptom, &symptom.record());
                    let Some(decision) = instance.plan(symptom, knowledge, context)? else { return Ok(()) };
                    context.journal(Phase::Decision, &decision.record());
                    instance.execute(decision, knowledge, context)
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
        unsafe { guarded(error, || Self::step(this, knowledge, host, false, L::shutdown)) }
    }

    unsafe extern "C" fn destroy(this: *mut c_void) {
        // SAFETY: the pointer is that of `construct`, given back once.
        let _ = contained(|| drop(unsafe { Box::from_raw(this.cast::<Self>()) }));
    }
}

/// A loop class of the other side.
#[derive(Clone, Debug)]
pub struct ImportedLoopClass {
    table: LoopTable,
    effects: &'static [&'static str],
}

impl ImportedLoopClass {
    /// A loop class by its table.
    ///
    /// # Errors
    /// The name of an entry is no text.
    ///
    /// # Safety
    /// The functions of the table keep the rules of [the boundary](super), for as long as the program runs.
    pub unsafe fn new(table: LoopTable) -> Result<ImportedLoopClass, Failure> {
        let mut effects = Vec::new();
        for number in 0.. {
            // SAFETY: as the caller promises; the names are constants of the library, which stays.
            let name = unsafe { (table.effect)(number).get_text() }?;
            if name.is_empty() {
                break;
            }
            effects.push(name);
        }
        Ok(ImportedLoopClass { table, effects: effects.leak() })
    }

    /// Makes a loop.
    ///
    /// # Errors
    /// The loop refuses the values, or panics.
    pub fn construct(&self, values: &[(String, PropertyValue)]) -> Result<Box<dyn DynLoop>, Failure> {
        let views = PropertyViews::of(values);
        let mut instance = ptr::null_mut();
        // SAFETY: `new`'s caller promised that the functions keep the rules; the rest is lent to this call.
        call(|error| unsafe {
            (self.table.construct)(views.top.as_ptr(), views.top.len(), &raw mut instance, error)
        })?;
        Ok(Box::new(ImportedLoop { class: self.clone(), instance, lent: Lent::default() }))
    }
}

/// A loop of the other side.
struct ImportedLoop {
    class: ImportedLoopClass,
    instance: *mut c_void,
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
        with_handle(context, &mut self.lent, |host| {
            with_knowledge(knowledge, |knowledge| {
                // SAFETY: the functions keep the rules, the instance is theirs, and the handles are lent to this call.
                call(|error| unsafe { step(instance, knowledge, host, error) })
            })
        })
    }
}

impl DynLoop for ImportedLoop {
    fn effects(&self) -> &'static [&'static str] {
        self.class.effects
    }

    fn entries(&self) -> Option<Box<dyn DynEntries>> {
        let mut handle = EntriesHandle { state: ptr::null_mut(), functions: ptr::null() };
        // SAFETY: the functions keep the rules; what they give away is this side's.
        unsafe {
            if (self.class.table.entries)(&raw mut handle) == 0 {
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
        self.step(self.class.table.initialize, knowledge, context)
    }

    fn monitor(&mut self, knowledge: &mut dyn Knowledge, context: &mut Context<'_>) -> Result<(), Failure> {
        self.step(self.class.table.monitor, knowledge, context)
    }

    fn adapt(
        &mut self,
        knowledge: &mut dyn Knowledge,
        snapshot: &mut Snapshot,
        context: &mut Context<'_>,
    ) -> Result<(), Failure> {
        // When the loop decides is not seen from here, so the entries are looked at in any case.
        snapshot.take(knowledge);
        let result = self.step(self.class.table.adapt, knowledge, context);
        result.and(snapshot.tell(knowledge, context))
    }

    fn shutdown(&mut self, knowledge: &mut dyn Knowledge, context: &mut Context<'_>) -> Result<(), Failure> {
        self.step(self.class.table.shutdown, knowledge, context)
    }
}

impl Drop for ImportedLoop {
    fn drop(&mut self) {
        // SAFETY: the instance is the one that `construct` gave, and is given back once.
        unsafe { (self.class.table.destroy)(self.instance) }
    }
}
