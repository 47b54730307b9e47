use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

use saoms_api::host::contain::contained;
use saoms_api::host::present::about;
use saoms_api::host::{DynComponent, Host, Invocation, SharedMessage};
use saoms_api::{CallError, Cause, Context, Failure, Time};
use saoms_lang::assembly::ComponentSpec;

use super::effects::Effects;
use super::host::ComponentHost;
use super::part::Part;
use super::taped::TapedHost;
use crate::fault::TaskFault;
use crate::schedule::shared::Shared;
use crate::status::{Description, named_values};

/// The part of a component that leaves the engine while the component's code runs, so that the engine stays free for
/// others.
pub(crate) struct Body {
    pub(crate) instance: Option<Box<dyn DynComponent>>,
    /// The messages of the present period, one list for each subscription.
    pub(crate) inboxes: Vec<Vec<SharedMessage>>,
    /// The same for reactions: the messages of topics that trigger the component.
    pub(crate) reactions: Vec<Vec<SharedMessage>>,
    pub(crate) part: Part,
}

/// Jobs of a component.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Job {
    /// Construct and initialize.
    Start,
    /// Execute once.
    Execute,
    /// React to messages.
    React,
    /// Say what it waits for.
    Ask,
    /// Say what an operator wants to know.
    Describe,
    /// The same for a sample: a run is as it would be without, so that nothing comes of a failure.
    Sample,
    /// Carry out an order of an operator.
    Order,
    /// Save the state, so that it outlives the program.
    Save,
    /// Shut down.
    Shutdown,
}

impl Job {
    /// What runs, for messages.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Job::Start => "`initialize`",
            Job::Execute => "an execution",
            Job::React => "a reaction",
            Job::Ask | Job::Describe | Job::Sample => "`status`",
            Job::Order => "an order of an operator, or a call of another program",
            Job::Save => "`save`",
            Job::Shutdown => "`shutdown`",
        }
    }
}

impl Body {
    pub(crate) fn new(
        index: u32,
        spec: Arc<ComponentSpec>,
        name: Arc<str>,
        period: u64,
        cancelled: Arc<AtomicBool>,
    ) -> Body {
        let part = Part::new(index, spec, name, period, cancelled);
        Body { instance: None, inboxes: Vec::new(), reactions: Vec::new(), part }
    }

    /// Performs a job, and contains panics of the component's code. A failure or a shutdown drops the instance.
    #[inline]
    pub(crate) fn perform(&mut self, shared: &Arc<Shared>, job: Job) -> Result<(), Failure> {
        self.part.begin(Cause::default());
        if job == Job::Shutdown {
            // Before its code runs, which may hang.
            shared.stops.request(&self.part.stops);
        }
        let before = if matches!(job, Job::Execute | Job::React) { self.save_touched() } else { Ok(()) };
        if self.part.tape.is_some() && before.is_ok() {
            self.begin_step_of(job);
        }
        let mut result = match job {
            _ if before.is_err() => before,
            Job::Execute => {
                let fault = self.part.fault.take();
                if let Some(TaskFault::Crash { restart }) = fault {
                    self.part.crash = Some(restart);
                }
                if fault.is_some() {
                    self.part.note_fault();
                }
                let execute = |instance: &mut dyn DynComponent, context: &mut Context<'_>| {
                    fault.map_or(Ok(()), TaskFault::happen)?;
                    instance.execute(context)
                };
                self.call(shared, execute).unwrap_or_else(Err)
            }
            Job::React => {
                let react = |instance: &mut dyn DynComponent, context: &mut Context<'_>| instance.react(context);
                call(&mut self.instance, &mut self.part, (&self.reactions, u64::MAX), shared, react).unwrap_or_else(Err)
            }
            Job::Ask => self.call(shared, |instance, _| instance.waits_for()).unwrap_or_else(Err).map(|waits_for| {
                self.part.waits_for = waits_for;
            }),
            Job::Describe => self.describe(shared),
            Job::Sample => {
                self.part.undescribed = self.describe(shared).err();
                return Ok(());
            }
            Job::Order => self.carry_out(shared),
            Job::Save => self.save_for_later(),
            Job::Start => self.start(shared),
            Job::Shutdown => self.call(shared, |instance, context| instance.shutdown(context)).unwrap_or_else(Err),
        };
        self.part.end_step(shared, result.as_ref().err());
        // First of all: nobody may write without end and answer that another component is busy.
        result = self.part.spent.is_within().and(result);
        if let Err(failure) = &result
            && self.part.keeps_instance(job, failure)
        {
            self.part.departed.iter_mut().for_each(Vec::clear);
            self.part.has_departed = false;
            self.part.lasting.touch();
            if self.part.lasting.saves_at_once {
                // What it cannot save now, it saves after the next execution, or fails then.
                let _ = self.save_for_later();
            }
            return result;
        }
        if result.is_ok() && job == Job::Execute && self.part.beats() {
            let period = self.part.period;
            let elsewhere = self.part.heartbeats_elsewhere.iter().flatten();
            elsewhere.for_each(|hardware| hardware.beat(&self.part.name, period));
            let beaten = shared.stops.beat(&self.part.heartbeats, Duration::from_nanos(self.part.period));
            result = beaten.map_err(|(component, failure)| {
                self.part.blamed = Some(component);
                failure
            });
        }
        if result.is_ok() && matches!(job, Job::Execute | Job::React) {
            self.part.lasting.note_heard();
            if self.part.lasting.is_saved() {
                result = self.save();
            }
        }
        if result.is_ok() || !self.part.lasting.hears_again(!self.part.stored.entries().is_empty()) {
            match job {
                Job::Execute => self.part.collection.filled.clear(&mut self.inboxes),
                Job::React => self.reactions.iter_mut().for_each(Vec::clear),
                Job::Start | Job::Ask | Job::Describe | Job::Sample | Job::Order | Job::Save | Job::Shutdown => {}
            }
        }
        if result.is_err() {
            shared.stops.request(&self.part.stops);
            self.part.take_back_counts(&mut shared.sections());
        }
        if self.part.has_departed {
            self.part.departed.iter_mut().for_each(Vec::clear);
            self.part.has_departed = false;
        }
        if let Err(failure) = &result {
            self.tell(shared, job, failure);
        }
        if result.is_err() || job == Job::Shutdown {
            self.discard();
        }
        result
    }

    fn describe(&mut self, shared: &Arc<Shared>) -> Result<(), Failure> {
        let told = self.call(shared, |instance, _| Ok::<_, Failure>((instance.waits_for()?, instance.status()?)));
        let (waits_for, values) = told??;
        let values = named_values(&values)?;
        let at = Time::from_nanos(if shared.clock.is_virtual() { self.part.now } else { shared.clock.now() });
        self.part.described = Some(Arc::new(Description { at, waits_for, values: Arc::new(values) }));
        Ok(())
    }

    pub(crate) fn construct(&mut self) -> Result<(), Failure> {
        let spec = &self.part.spec;
        let construct = || about(&subject(&self.part.name), || spec.class.construct(&spec.values));
        self.instance = Some(contained(construct)??);
        Ok(())
    }

    fn start(&mut self, shared: &Arc<Shared>) -> Result<(), Failure> {
        self.part.begin_tape(shared);
        self.construct()?;
        self.part.initializing = true;
        self.part.recorder.reset();
        self.part.lasting.begin();
        if !self.part.lasting.goes_on() {
            self.part.alerts.clear();
            self.part.effects = Effects::default();
        }
        let result = self.call(shared, |instance, context| instance.initialize(context));
        self.part.initializing = false;
        result??;
        self.part.has_registered_stop()?;
        self.go_on()
    }

    /// Serves a call to one of the component's services, for a caller with this cause. The outer error is a panic,
    /// which drops the instance.
    pub(crate) fn serve(
        &mut self,
        shared: &Arc<Shared>,
        invocation: &mut Invocation<'_>,
        cause: Cause,
    ) -> Result<Result<(), CallError>, Failure> {
        self.part.begin(cause);
        let before = self.save_touched();
        let result = match before {
            Err(failure) => Err(failure),
            Ok(()) if self.part.tape.is_some() => self.serve_taped(shared, invocation, cause),
            Ok(()) => self.call(shared, |instance, context| instance.serve(invocation, context)),
        };
        let mut result = self.part.spent.is_within().and(result);
        self.part.lasting.touch();
        if self.part.lasting.saves_at_once {
            result = result.and_then(|served| self.save_for_later().map(|()| served));
        }
        if let Err(failure) = &result {
            shared.stops.request(&self.part.stops);
            self.part.take_back_counts(&mut shared.sections());
            self.tell(shared, Job::Execute, failure);
            self.discard();
        }
        result
    }

    #[inline]
    pub(crate) fn call<T>(
        &mut self,
        shared: &Arc<Shared>,
        code: impl FnOnce(&mut dyn DynComponent, &mut Context<'_>) -> T,
    ) -> Result<T, Failure> {
        let filled = self.part.collection.filled.bits();
        call(&mut self.instance, &mut self.part, (&self.inboxes, filled), shared, code)
    }

    /// Makes room for the messages of each subscription.
    pub(crate) fn fit_inboxes(&mut self) {
        for inboxes in [&mut self.inboxes, &mut self.reactions] {
            inboxes.resize_with(self.part.subscriptions.len(), Vec::new);
        }
    }

    /// Forgets the messages of all subscriptions.
    pub(crate) fn clear_inboxes(&mut self) {
        self.inboxes.clear();
        self.reactions.clear();
    }

    /// Tells a failure before the instance is dropped, whose destructor may hang.
    #[cold]
    fn tell(&mut self, shared: &Shared, job: Job, failure: &Failure) {
        let now = if shared.clock.is_virtual() { self.part.now } else { shared.clock.now() };
        let mut engine = shared.lock();
        engine.tell_early(&mut self.part, job, failure, now);
        shared.release(engine);
    }

    /// Drops the instance. A panic of its destructor is contained, too.
    pub(crate) fn discard(&mut self) {
        if let Some(instance) = self.instance.take() {
            // A panic here is ignored: the failure or the shutdown before it has been reported.
            let _ = contained(|| drop(instance));
        }
        self.part.stops.clear();
    }
}

/// Runs code of an instance with its context, over these messages.
#[inline]
fn call<T>(
    instance: &mut Option<Box<dyn DynComponent>>,
    part: &mut Part,
    (inboxes, filled): (&[Vec<SharedMessage>], u64),
    shared: &Arc<Shared>,
    code: impl FnOnce(&mut dyn DynComponent, &mut Context<'_>) -> T,
) -> Result<T, Failure> {
    let Some(instance) = instance else {
        return Err(Failure::new("there is no component to run"));
    };
    let has_departed = part.has_departed;
    let run = |host: &mut dyn Host| {
        let mut context = Context::new(host, inboxes).with_filled(filled);
        if has_departed {
            context = context.with_departed();
        }
        contained(|| code(instance.as_mut(), &mut context))
    };
    let tape = part.tape.take_if(|tape| tape.is_open());
    let mut host = ComponentHost { shared, part };
    let result = match tape {
        None => run(&mut host),
        Some(tape) => {
            let mut taped = TapedHost::new(host, tape);
            let result = run(&mut taped);
            host = taped.into_host();
            result
        }
    };
    if !host.part.unheard.is_empty() {
        host.tell_unheard();
    }
    result.map_err(|panic| part.of_loop(panic))
}

/// What is constructed, by the name of its component.
pub(crate) fn subject(name: &str) -> String {
    format!("component `{name}`")
}
