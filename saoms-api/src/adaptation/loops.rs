use std::fmt;

use crate::{Context, DynLoop, Failure, Knowledge};

/// The loops of a component in their order.
#[derive(Default)]
pub struct Loops {
    loops: Vec<Named>,
}

struct Named {
    name: String,
    instance: Box<dyn DynLoop>,
}

impl Loops {
    /// These loops, by the names that composites use.
    pub fn of(loops: impl IntoIterator<Item = (String, Box<dyn DynLoop>)>) -> Loops {
        Loops { loops: loops.into_iter().map(|(name, instance)| Named { name, instance }).collect() }
    }

    /// The names in order.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.loops.iter().map(|named| named.name.as_str())
    }

    /// Initializes all.
    ///
    /// # Errors
    /// The first failure of a loop.
    pub fn initialize(
        &mut self,
        knowledge: &mut dyn Knowledge,
        context: &mut Context<'_>,
    ) -> Result<(), Failure> {
        for (place, named) in self.placed() {
            context.name_loop(place, &named.name);
            context.enter_loop(place);
            named.instance.initialize(knowledge, context)?;
        }
        context.leave_loops();
        Ok(())
    }

    /// Lets all take in what arrived.
    ///
    /// # Errors
    /// The first failure of a loop.
    pub fn monitor(
        &mut self,
        knowledge: &mut dyn Knowledge,
        context: &mut Context<'_>,
    ) -> Result<(), Failure> {
        for (place, named) in self.placed() {
            context.enter_loop(place);
            named.instance.monitor(knowledge, context)?;
        }
        context.leave_loops();
        Ok(())
    }

    /// Lets each analyze, plan and execute.
    ///
    /// # Errors
    /// The first failure of a loop.
    pub fn adapt(&mut self, knowledge: &mut dyn Knowledge, context: &mut Context<'_>) -> Result<(), Failure> {
        for (place, named) in self.placed() {
            context.enter_loop(place);
            named.instance.adapt(knowledge, context)?;
        }
        context.leave_loops();
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
    pub fn shutdown(
        &mut self,
        knowledge: &mut dyn Knowledge,
        context: &mut Context<'_>,
    ) -> Result<(), Failure> {
        self.loops
            .iter_mut()
            .map(|named| named.instance.shutdown(knowledge, context))
            .fold(Ok(()), Result::and)
    }
}

impl fmt::Debug for Loops {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.debug_list().entries(self.names()).finish()
    }
}
