use std::fmt;

use super::extras::Writable;
use crate::host::{DynLoop, EntryDeclaration, Snapshot, prefetch};
use crate::{Context, Failure, Knowledge};

/// Loops with the names that composites use, in their order.
pub type NamedLoops = Vec<(String, Box<dyn DynLoop>)>;

/// The loops of a component in their order. What an execution needs of them is close together in memory.
#[derive(Default)]
pub struct Loops {
    instances: Vec<Box<dyn DynLoop>>,
    /// What each may change.
    writable: Vec<Writable>,
    names: Vec<String>,
    snapshot: Snapshot,
}

/// Says whose failure it is.
fn of_loop(name: &str, result: Result<(), Failure>) -> Result<(), Failure> {
    result.map_err(|failure| failure.at(format_args!("loop `{name}`")))
}

impl Loops {
    /// These loops, by the names that composites use.
    pub fn of(loops: impl IntoIterator<Item = (String, Box<dyn DynLoop>)>) -> Loops {
        let (names, instances): (Vec<_>, Vec<_>) = loops.into_iter().unzip();
        Loops { writable: vec![Writable::default(); names.len()], instances, names, snapshot: Snapshot::default() }
    }

    /// The names in order.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.names.iter().map(String::as_str)
    }

    /// Asks the processor to load all, before an execution.
    #[inline]
    pub fn prefetch(&self) {
        self.instances.iter().for_each(|instance| prefetch(&**instance));
    }

    /// Adds the entries of all loops to the knowledge, then initializes all.
    ///
    /// # Errors
    /// The first failure of a loop; or two of them, or one and the component, have an entry of the same name.
    pub fn initialize(&mut self, knowledge: &mut dyn Knowledge, context: &mut Context<'_>) -> Result<(), Failure> {
        let built_in: &'static [EntryDeclaration] = knowledge.declared();
        let Loops { instances, writable, names, .. } = self;
        for ((instance, writable), name) in instances.iter_mut().zip(&mut *writable).zip(&*names) {
            writable.effects = instance.effects();
            if let Some(entries) = instance.entries() {
                writable.own = entries.declared();
                of_loop(name, knowledge.extras_mut().add(entries, built_in))?;
            }
        }
        for (place, ((instance, writable), name)) in (0..).zip(instances.iter_mut().zip(writable).zip(names)) {
            context.name_loop(place, name);
            context.enter_loop(place);
            knowledge.extras_mut().permit(*writable);
            let result = instance.initialize(knowledge, context);
            knowledge.extras_mut().permit(Writable::default());
            of_loop(name, result)?;
        }
        context.leave_loops();
        Ok(())
    }

    /// Lets all take in what arrived.
    ///
    /// # Errors
    /// The first failure of a loop.
    pub fn monitor(&mut self, knowledge: &mut dyn Knowledge, context: &mut Context<'_>) -> Result<(), Failure> {
        for (place, instance) in self.instances.iter_mut().enumerate() {
            context.enter_loop(place as u32);
            if let Err(failure) = instance.monitor(knowledge, context) {
                return of_loop(&self.names[place], Err(failure));
            }
        }
        context.leave_loops();
        Ok(())
    }

    /// Lets each loop analyze, plan and execute. Changes of the knowledge by planning and execution are written to the
    /// journal.
    ///
    /// # Errors
    /// The first failure of a loop; one that changes an effector which it does not declare has failed.
    pub fn adapt(&mut self, knowledge: &mut dyn Knowledge, context: &mut Context<'_>) -> Result<(), Failure> {
        for (place, (instance, writable)) in self.instances.iter_mut().zip(&self.writable).enumerate() {
            context.enter_loop(place as u32);
            self.snapshot.permit(*writable);
            if let Err(failure) = instance.adapt(knowledge, &mut self.snapshot, context) {
                return of_loop(&self.names[place], Err(failure));
            }
        }
        context.leave_loops();
        Ok(())
    }

    /// Runs code as the loop that effects the entry of this name: what the code writes to the journal is that loop's,
    /// and follows from its decision. For components that carry out the orders which loops write into entries. Without
    /// such a loop it is the component's own.
    pub fn act_for<T>(&self, entry: &str, context: &mut Context<'_>, code: impl FnOnce(&mut Context<'_>) -> T) -> T {
        let place = self.writable.iter().position(|writable| writable.has(entry));
        if let Some(place) = place {
            context.enter_loop(place as u32);
        }
        let result = code(context);
        context.leave_loops();
        result
    }

    /// Calls this code with the name of each loop, and the loop.
    pub(super) fn for_each(
        &mut self,
        mut code: impl FnMut(&str, &mut dyn DynLoop) -> Result<(), Failure>,
    ) -> Result<(), Failure> {
        for (name, instance) in self.names.iter().zip(&mut self.instances) {
            of_loop(name, code(name, &mut **instance))?;
        }
        Ok(())
    }

    /// Ends all.
    ///
    /// # Errors
    /// The first failure of a loop; the others are ended all the same.
    pub fn shutdown(&mut self, knowledge: &mut dyn Knowledge, context: &mut Context<'_>) -> Result<(), Failure> {
        self.names
            .iter()
            .zip(&mut self.instances)
            .map(|(name, instance)| of_loop(name, instance.shutdown(knowledge, context)))
            .fold(Ok(()), Result::and)
    }
}

impl fmt::Debug for Loops {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.debug_list().entries(self.names()).finish()
    }
}
