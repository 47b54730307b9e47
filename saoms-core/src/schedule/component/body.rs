use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use saoms_api::host::{DynComponent, Invocation, SharedMessage};
use saoms_api::{CallError, Cause, Chance, Context, Departed, Failure, Time};

use super::collection::Collection;
use super::effects::Effects;
use super::host::ComponentHost;
use super::lasting::Lasting;
use super::remote::{RemoteHeartbeat, Remotes};
use super::spent::Spent;
use super::stored::{Stored, StoredChange};
use super::unheard::Unheard;
use crate::bus::{TopicId, TopicReader};
use crate::fault::TaskFault;
use crate::journal::Recorder;
use crate::schedule::engine::failing::Told;
use crate::schedule::engine::memory::AlertForm;
use crate::schedule::engine::votes::Ballot;
use crate::schedule::order::InCode;
use crate::schedule::shared::Shared;
use crate::schedule::stop::RegisteredStop;
use crate::status::{Description, named_values};
use saoms_api::host::contain::contained;
use saoms_api::host::present::about;
use saoms_lang::assembly::ComponentSpec;
use saoms_lang::schema::Schema;

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

/// The part of a body that the component's context works with.
pub(crate) struct Part {
    pub(crate) index: u32,
    pub(crate) name: Arc<str>,
    /// The functions of the instance that stop its hardware.
    pub(crate) stops: Vec<Arc<RegisteredStop>>,
    /// Components whose hardware hears of each of its executions.
    pub(crate) heartbeats: Vec<u32>,
    /// The same of other programs, and what it calls there.
    pub(crate) heartbeats_elsewhere: Option<Box<[RemoteHeartbeat]>>,
    pub(crate) remotes: Option<Box<Remotes>>,
    pub(crate) publishers: Vec<TopicId>,
    /// Schemas of the topics on which messages were sent as bytes.
    pub(crate) schemas: Vec<(TopicId, Arc<Schema>)>,
    pub(crate) subscriptions: Vec<TopicReader>,
    /// The last collection of all subscriptions.
    pub(crate) collection: Collection,
    /// Messages that left the regions of subscriptions, for the present execution or reaction.
    pub(crate) departed: Vec<Vec<Departed>>,
    pub(crate) has_departed: bool,
    /// Subscriptions of a failed instance, for the instance that replaces it.
    pub(crate) kept: Vec<TopicReader>,
    pub(crate) outbox: Vec<(TopicId, SharedMessage)>,
    /// True if there is an event in the outbox.
    pub(crate) has_raised: bool,
    /// What the present code keeps once it has finished, and what is kept.
    pub(crate) to_keep: Vec<StoredChange>,
    pub(crate) stored: Stored,
    /// What a restart goes on from.
    pub(crate) lasting: Lasting,
    /// What it wants outside of the program, and has not begun.
    pub(crate) effects: Effects,
    /// The alerts that it has raised and that are not over.
    pub(crate) alerts: Vec<AlertForm>,
    /// Bytes in the outbox from code of libraries.
    pub(crate) sent_bytes: usize,
    /// What the present code has written.
    pub(crate) spent: Spent,
    pub(crate) unheard: Unheard,
    /// True once the report had no room for what it contributes.
    pub(crate) is_report_full: bool,
    /// Number of calls within which its code runs.
    pub(crate) call_depth: u32,
    pub(crate) chance: Chance,
    pub(crate) cancelled: Arc<AtomicBool>,
    /// True while it is stopped in an emergency: its hardware hears no heartbeat.
    pub(crate) emergency: Arc<AtomicBool>,
    pub(crate) vote: Option<Ballot>,
    /// Answer to the question what it waits for.
    pub(crate) waits_for: Option<String>,
    /// Answer to the question what an operator wants to know.
    pub(crate) described: Option<Arc<Description>>,
    /// The order, or the call of another program, that it carries out.
    pub(crate) order: Option<Box<InCode>>,
    /// In virtual time, the time at which the present code runs.
    pub(crate) now: u64,
    pub(crate) due: u64,
    pub(crate) execution: u64,
    pub(crate) period: u64,
    pub(crate) initializing: bool,
    /// True in the shutdown at the end of the run.
    pub(crate) is_ending: bool,
    /// True if a shutdown that finds another component busy is tried again.
    pub(crate) retries_shutdown: bool,
    /// The component whose code made the present execution fail, if that is another one.
    pub(crate) blamed: Option<u32>,
    /// What was told of the failure of the present code, before the instance was dropped.
    pub(crate) told: Option<Told>,
    /// The fault of the present execution.
    pub(crate) fault: Option<TaskFault>,
    /// The crash of the present execution, with the time to its restart.
    pub(crate) crash: Option<Option<Duration>>,
    /// Records for the journal.
    pub(crate) recorder: Recorder,
    /// Specification of the component; the targets of its wires are slot numbers.
    pub(crate) spec: Arc<ComponentSpec>,
    /// True if the instance is part of a change that is not committed: its messages are held back.
    pub(crate) held: bool,
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
            Job::Ask | Job::Describe => "`status`",
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
        let part = Part {
            index,
            name,
            stops: Vec::new(),
            heartbeats: Vec::new(),
            heartbeats_elsewhere: None,
            remotes: None,
            publishers: Vec::new(),
            schemas: Vec::new(),
            subscriptions: Vec::new(),
            collection: Collection::default(),
            departed: Vec::new(),
            has_departed: false,
            kept: Vec::new(),
            outbox: Vec::new(),
            has_raised: false,
            to_keep: Vec::new(),
            stored: Stored::default(),
            lasting: Lasting::default(),
            effects: Effects::default(),
            alerts: Vec::new(),
            sent_bytes: 0,
            spent: Spent::default(),
            unheard: Unheard::default(),
            is_report_full: false,
            call_depth: 0,
            chance: Chance::new(0),
            cancelled,
            emergency: Arc::default(),
            vote: None,
            waits_for: None,
            described: None,
            order: None,
            now: 0,
            due: 0,
            execution: 0,
            period,
            initializing: false,
            is_ending: false,
            retries_shutdown: false,
            blamed: None,
            told: None,
            fault: None,
            crash: None,
            recorder: Recorder::default(),
            spec,
            held: true,
        };
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
        let mut result = match job {
            _ if before.is_err() => before,
            Job::Execute => {
                let fault = self.part.fault.take();
                if let Some(TaskFault::Crash { restart }) = fault {
                    self.part.crash = Some(restart);
                }
                let execute = |instance: &mut dyn DynComponent, context: &mut Context<'_>| {
                    fault.map_or(Ok(()), inject_fault)?;
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
            Job::Order => self.carry_out(shared),
            Job::Save => self.save_for_later(),
            Job::Start => self.start(shared),
            Job::Shutdown => self.call(shared, |instance, context| instance.shutdown(context)).unwrap_or_else(Err),
        };
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
                Job::Start | Job::Ask | Job::Describe | Job::Order | Job::Save | Job::Shutdown => {}
            }
        }
        if result.is_err() {
            shared.stops.request(&self.part.stops);
            self.part.lasting.take_back(&mut shared.sections());
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
        self.part.described = Some(Arc::new(Description { at, waits_for, values }));
        Ok(())
    }

    pub(crate) fn construct(&mut self) -> Result<(), Failure> {
        let spec = &self.part.spec;
        let construct = || about(&subject(&self.part.name), || spec.class.construct(&spec.values));
        self.instance = Some(contained(construct)??);
        Ok(())
    }

    fn start(&mut self, shared: &Arc<Shared>) -> Result<(), Failure> {
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
        let result = before.and_then(|()| self.call(shared, |instance, context| instance.serve(invocation, context)));
        let mut result = self.part.spent.is_within().and(result);
        self.part.lasting.touch();
        if self.part.lasting.saves_at_once {
            result = result.and_then(|served| self.save_for_later().map(|()| served));
        }
        if let Err(failure) = &result {
            shared.stops.request(&self.part.stops);
            self.part.lasting.take_back(&mut shared.sections());
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
    let mut host = ComponentHost { shared, part };
    let mut context = Context::new(&mut host, inboxes).with_filled(filled);
    if has_departed {
        context = context.with_departed();
    }
    let result = contained(|| code(instance.as_mut(), &mut context));
    if !host.part.unheard.is_empty() {
        host.tell_unheard();
    }
    result.map_err(|panic| part.of_loop(panic))
}

/// What is constructed, by the name of its component.
pub(crate) fn subject(name: &str) -> String {
    format!("component `{name}`")
}

/// Carries out the injected fault of an execution.
#[cold]
fn inject_fault(fault: TaskFault) -> Result<(), Failure> {
    match fault {
        TaskFault::Fail => Err(Failure::new("this execution fails by fault injection")),
        TaskFault::Crash { .. } => Err(Failure::new("it crashes by fault injection")),
        TaskFault::Stall(time) => {
            std::thread::sleep(time);
            Ok(())
        }
    }
}

impl Part {
    /// Begins an execution, or a call whose caller has this cause.
    #[inline]
    fn begin(&mut self, because: Cause) {
        self.recorder.begin(because);
        self.spent = Spent::default();
        (self.blamed, self.told) = (None, None);
    }

    /// Holds a class that declares it to the registration of a function that stops hardware.
    pub(crate) fn has_registered_stop(&self) -> Result<(), Failure> {
        if self.stops.is_empty() && self.spec.class.declaration().stops {
            return Err(Failure::new(format!(
                "class `{}` declares that it `stops` its hardware, but `initialize` registered no function for that: \
                 call `Context::register_stop`",
                self.spec.class.name()
            )));
        }
        Ok(())
    }

    /// True if the instance tries again, with the same messages.
    #[cold]
    fn keeps_instance(&self, job: Job, failure: &Failure) -> bool {
        let tries_again = matches!(job, Job::Execute | Job::React) || job == Job::Shutdown && self.retries_shutdown;
        tries_again && self.busy_provider(failure).is_some()
    }

    /// The other component whose code was running when this one called it, if that is why it failed. A component that
    /// finds itself busy is part of a cycle of calls, and never becomes free.
    #[cold]
    pub(crate) fn busy_provider<'a>(&self, failure: &'a Failure) -> Option<&'a str> {
        failure.busy_provider().filter(|provider| **provider != *self.name)
    }

    /// Names the loop whose code panicked, if it was one.
    #[cold]
    fn of_loop(&self, panic: Failure) -> Failure {
        match self.recorder.present().and_then(|place| self.spec.loops.get(usize::from(place))) {
            Some(one) => Failure::new(format!("loop `{}`: {panic}", one.name)),
            None => panic,
        }
    }

    /// True if hardware hears that it has executed.
    fn beats(&self) -> bool {
        (!self.heartbeats.is_empty() || self.heartbeats_elsewhere.is_some()) && !self.emergency.load(Ordering::Relaxed)
    }

    pub(crate) fn is_cancelled(&self) -> bool {
        self.cancelled.load(Ordering::Relaxed)
    }
}
