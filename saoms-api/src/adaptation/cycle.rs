use crate::host::{DerivedLoop, DynEntries, Phase, Snapshot, Subject};
use crate::{Context, Failure, Knowledge, LoopClass, Properties, Recordable, Saved};

/// A MAPE-K loop: one concern of a component that adapts itself.
///
/// In each execution of its component, after all loops have [monitored](Loop::monitor), each loop in its order
/// [analyzes](Loop::analyze); where it finds a symptom it [plans](Loop::plan), and where it comes to a decision it
/// [executes](Loop::execute). The host writes symptom and decision to the journal, and what entries of the knowledge
/// changed; an effect beyond that is reported with [`Context::effect`].
///
/// A simple one is a [`SimpleLoop`](crate::SimpleLoop), which is one function.
pub trait Loop: DerivedLoop + Send + Sized + 'static {
    /// Properties that the composite sets.
    type Properties: Properties;
    /// Knowledge that it works on: the component's own struct, or `dyn Knowledge`.
    type Knowledge: Subject + ?Sized;
    /// Result of the analysis.
    type Symptom: Recordable;
    /// Result of the planning.
    type Decision: Recordable;

    /// Makes the loop; it does no work, as [`Component::new`](crate::Component::new). By itself it has the values of
    /// the composite in the fields with `#[property]` and `#[properties]`, and everything else is its `Default`.
    ///
    /// # Errors
    /// The values do not fit together.
    fn new(properties: Self::Properties) -> Result<Self, Failure> {
        <Self as DerivedLoop>::made::<true>(properties)
    }

    /// The loop that [`new`](Loop::new) makes by itself: for a `new` that checks values.
    ///
    /// # Errors
    /// None by itself.
    fn made(properties: Self::Properties) -> Result<Self, Failure> {
        <Self as DerivedLoop>::made::<true>(properties)
    }

    /// Begins the work. The handles in fields (`#[senses]` and the like) are bound before; others are asked for here.
    ///
    /// # Errors
    /// The component cannot start.
    fn initialize(&mut self, knowledge: &mut Self::Knowledge, context: &mut Context<'_>) -> Result<(), Failure> {
        let _ = (knowledge, context);
        Ok(())
    }

    /// Takes in what arrived and what can be measured. Before any loop analyzes, all have monitored.
    ///
    /// # Errors
    /// The component has failed.
    fn monitor(&mut self, knowledge: &mut Self::Knowledge, context: &mut Context<'_>) -> Result<(), Failure> {
        let _ = (knowledge, context);
        Ok(())
    }

    /// Looks for a reason to act.
    ///
    /// # Errors
    /// The component has failed.
    fn analyze(
        &mut self,
        knowledge: &mut Self::Knowledge,
        context: &mut Context<'_>,
    ) -> Result<Option<Self::Symptom>, Failure>;

    /// Decides what to do about it; `None` where nothing is to be done.
    ///
    /// # Errors
    /// The component has failed.
    fn plan(
        &mut self,
        symptom: Self::Symptom,
        knowledge: &mut Self::Knowledge,
        context: &mut Context<'_>,
    ) -> Result<Option<Self::Decision>, Failure>;

    /// Does it.
    ///
    /// # Errors
    /// The component has failed.
    fn execute(
        &mut self,
        decision: Self::Decision,
        knowledge: &mut Self::Knowledge,
        context: &mut Context<'_>,
    ) -> Result<(), Failure>;

    /// Ends the work; messages sent here are still delivered.
    ///
    /// # Errors
    /// The component could not end properly.
    fn shutdown(&mut self, knowledge: &mut Self::Knowledge, context: &mut Context<'_>) -> Result<(), Failure> {
        let _ = (knowledge, context);
        Ok(())
    }

    /// Saves what the loop knows beside the knowledge, as [`Component::save`](crate::Component::save) does and with the
    /// same rules: a component that saves asks its loops for it. By default nothing is saved. Only of loops that are
    /// built together with their component; the others keep in entries what has to last.
    ///
    /// # Errors
    /// The component has failed, or cannot be replaced now.
    fn save(&mut self) -> Result<Saved, Failure> {
        Ok(Saved::default())
    }

    /// Goes on from what [`save`](Loop::save) gave, after `initialize`. Not called where nothing was saved.
    ///
    /// # Errors
    /// It cannot go on from that.
    fn restore(&mut self, saved: &Saved) -> Result<(), Failure> {
        let _ = saved;
        Err("the loop saved its state, and this one does not implement `restore`".into())
    }
}

/// A loop of any type, as components hold it.
pub trait DynLoop: Send {
    /// See [`LoopClass::EFFECTS`].
    fn effects(&self) -> &'static [&'static str];
    /// See [`LoopClass::entries`].
    fn entries(&self) -> Option<Box<dyn DynEntries>>;
    /// See [`Loop::initialize`].
    ///
    /// # Errors
    /// As there.
    fn initialize(&mut self, knowledge: &mut dyn Knowledge, context: &mut Context<'_>) -> Result<(), Failure>;
    /// See [`Loop::monitor`].
    ///
    /// # Errors
    /// As there.
    fn monitor(&mut self, knowledge: &mut dyn Knowledge, context: &mut Context<'_>) -> Result<(), Failure>;
    /// [Analyzes](Loop::analyze), [plans](Loop::plan) and [executes](Loop::execute) as far as there is reason to. The
    /// snapshot shows what plan and execution changed.
    ///
    /// # Errors
    /// As there, and where the loop changes an effector that it does not declare.
    fn adapt(
        &mut self,
        knowledge: &mut dyn Knowledge,
        snapshot: &mut Snapshot,
        context: &mut Context<'_>,
    ) -> Result<(), Failure>;
    /// See [`Loop::shutdown`].
    ///
    /// # Errors
    /// As there.
    fn shutdown(&mut self, knowledge: &mut dyn Knowledge, context: &mut Context<'_>) -> Result<(), Failure>;
    /// See [`Loop::save`].
    ///
    /// # Errors
    /// As there.
    fn save(&mut self) -> Result<Saved, Failure> {
        Ok(Saved::default())
    }
    /// See [`Loop::restore`].
    ///
    /// # Errors
    /// As there.
    fn restore(&mut self, saved: &Saved) -> Result<(), Failure> {
        let _ = saved;
        Ok(())
    }
}

impl<L: LoopClass> DynLoop for L {
    fn effects(&self) -> &'static [&'static str] {
        L::EFFECTS
    }

    fn entries(&self) -> Option<Box<dyn DynEntries>> {
        <L as LoopClass>::entries()
    }

    fn initialize(&mut self, knowledge: &mut dyn Knowledge, context: &mut Context<'_>) -> Result<(), Failure> {
        self.bind(knowledge, context)?;
        Loop::initialize(self, subject::<L>(knowledge)?, context)
    }

    fn monitor(&mut self, knowledge: &mut dyn Knowledge, context: &mut Context<'_>) -> Result<(), Failure> {
        Loop::monitor(self, subject::<L>(knowledge)?, context)
    }

    fn adapt(
        &mut self,
        knowledge: &mut dyn Knowledge,
        snapshot: &mut Snapshot,
        context: &mut Context<'_>,
    ) -> Result<(), Failure> {
        let Some(symptom) = self.analyze(subject::<L>(knowledge)?, context)? else { return Ok(()) };
        context.journal(Phase::Symptom, symptom.lend(&mut None));
        snapshot.take(knowledge);
        let Some(decision) = self.plan(symptom, subject::<L>(knowledge)?, context)? else { return Ok(()) };
        context.journal(Phase::Decision, decision.lend(&mut None));
        let result = self.execute(decision, subject::<L>(knowledge)?, context);
        result.and(snapshot.record(knowledge, context))
    }

    fn shutdown(&mut self, knowledge: &mut dyn Knowledge, context: &mut Context<'_>) -> Result<(), Failure> {
        Loop::shutdown(self, subject::<L>(knowledge)?, context)
    }

    fn save(&mut self) -> Result<Saved, Failure> {
        Loop::save(self)
    }

    fn restore(&mut self, saved: &Saved) -> Result<(), Failure> {
        Loop::restore(self, saved)
    }
}

fn subject<L: Loop>(knowledge: &mut dyn Knowledge) -> Result<&mut L::Knowledge, Failure> {
    L::Knowledge::of(knowledge)
        .ok_or_else(|| Failure::new("this loop works on the knowledge of another class of components"))
}
