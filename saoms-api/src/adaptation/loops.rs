use std::fmt;

use super::extras::Writable;
use crate::host::{DynLoop, EntryDeclaration, Snapshot};
use crate::{Context, Failure, Knowledge};

/// Loops with the names that composites use, in their order.
pub type NamedLoops = Vec<(String, Box<dyn DynLoop>)>;

/// The loops of a component in their order.
#[derive(Default)]
pub struct Loops {
    loops: Vec<Named>,
    snapshot: Snapshot,
}

struct Named {
    name: String,
    instance: Box<dyn DynLoop>,
    writable: Writable,
}

impl Named {
    /// Says whose failure it is.
    fn of_loop(&self, result: Result<(), Failure>) -> Result<(), Failure> {
        result.map_err(|failure| failure.at(format_args!("loop `{}`", self.name)))
    }
}

impl Loops {
    /// These loops, by the names that composites use.
    pub fn of(loops: impl IntoIterator<Item = (String, Box<dyn DynLoop>)>) -> Loops {
        let named = |(name, instance)| Named { name, instance, writable: Writable::default() };
        Loops { loops: loops.into_iter().map(named).collect(), snapshot: Snapshot::default() }
    }

    /// The names in order.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.loops.iter().map(|named| named.name.as_str())
    }

    /// Adds the entries of all loops to the knowledge, then initializes all.
    ///
    /// # Errors
    /// The first failure of a loop; or two of them, or one and the component, have an entry of the same name.
    pub fn initialize(&mut self, knowledge: &mut dyn Knowledge, context: &mut Context<'_>) -> Result<(), Failure> {
        let built_in: &'static [EntryDeclaration] = knowledge.declared();
        for named in &mut self.loops {
            named.writable.effects = named.instance.effects();
            if let Some(entries) = named.instance.entries() {
                named.writable.own = entries.declared();
                let added = knowledge.extras_mut().add(entries, built_in);
                named.of_loop(added)?;
            }
        }
        for (place, named) in self.placed() {
            context.name_loop(place, &named.name);
            context.enter_loop(place);
            knowledge.extras_mut().permit(named.writable);
            let result = named.instance.initialize(knowledge, context);
            knowledge.extras_mut().permit(Writable::default());
            named.of_loop(result)?;
        }
        context.leave_loops();
        Ok(())
    }

    /// Lets all take in what arrived.
    ///
    /// # Errors
    /// The first failure of a loop.
    pub fn monitor(&mut self, knowledge: &mut dyn Knowledge, context: &mut Context<'_>) -> Result<(), Failure> {
        for (place, named) in self.placed() {
            context.enter_loop(place);
            let result = named.instance.monitor(knowledge, context);
            named.of_loop(result)?;
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
        for (place, named) in (0..).zip(&mut self.loops) {
            context.enter_loop(place);
            self.snapshot.permit(named.writable);
            let result = named.instance.adapt(knowledge, &mut self.snapshot, context);
            named.of_loop(result)?;
        }
        context.leave_loops();
        Ok(())
    }

    /// Runs code as the loop that effects the entry of this name: what the code writes to the journal is that loop's,
    /// and follows from its decision. For components that carry out the orders which loops write into entries. Without
    /// such a loop it is the component's own.
    pub fn act_for<T>(&self, entry: &str, context: &mut Context<'_>, code: impl FnOnce(&mut Context<'_>) -> T) -> T {
        let place = self.loops.iter().position(|named| named.writable.has(entry));
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
        for named in &mut self.loops {
            let result = code(&named.name, &mut *named.instance);
            named.of_loop(result)?;
        }
        Ok(())
    }

    /// The loops with the numbers of their places.
    fn placed(&mut self) -> impl Iterator<Item = (u32, &mut Named)> {
        (0..).zip(&mut self.loops)
    }

    /// Ends all.
    ///
    /// # Errors
    /// The first failure of a loop; the others are ended all the same.
    pub fn shutdown(&mut self, knowledge: &mut dyn Knowledge, context: &mut Context<'_>) -> Result<(), Failure> {
        self.loops
            .iter_mut()
            .map(|named| {
                let result = named.instance.shutdown(knowledge, context);
                named.of_loop(result)
            })
            .fold(Ok(()), Result::and)
    }
}

impl fmt::Debug for Loops {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.debug_list().entries(self.names()).finish()
    }
}
