//! The replay of a component: the code that is there today gets what the component got on its tape, and what it does is
//! compared with what was done.
//!
//! Neither an engine nor a clock takes part: each step of the tape is a call of the component's code, with a host that
//! answers from that step. So a replay is as fast as the code, and bit for bit the same each time.

mod answers;
mod given;
mod host;
mod told;

use std::collections::BTreeMap;

use saoms_api::host::contain::contained;
use saoms_api::host::{DynComponent, Invocation, PropertyValue, SmolStr};
use saoms_api::{Context, Failure, Saved, Time};
use saoms_lang::assembly::ComponentSpec;
use saoms_lang::registry::Registry;

use self::given::{ServedCall, Setting};
use self::host::ReplayHost;
use crate::tape::{ActKind, Step, StepKind, answered, values_of_bytes};

pub use self::told::{Difference, Side};

/// The replay of one component, which takes the steps of its tape one by one.
pub struct Replay {
    registry: Registry,
    /// What a composite of today says of the component.
    spec: Option<ComponentSpec>,
    host: ReplayHost,
    instance: Option<Box<dyn DynComponent>>,
    /// The class and the values of the instance, and the values that it had on the tape.
    setting: Setting,
    /// The number that the next step should have.
    next: Option<u64>,
    counts: ReplayCounts,
}

/// What came of the steps so far.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ReplayCounts {
    /// Steps of the tape.
    pub steps: u64,
    /// Those that were replayed.
    pub replayed: u64,
    /// Those in which the component does something else than then.
    pub differing: u64,
    /// Where the replay could not go on, until the component started anew.
    pub ends: Vec<ReplayEnd>,
    /// The time of the last step.
    pub time: Time,
}

/// Where a replay could not go on.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ReplayEnd {
    /// The time of the run.
    pub time: Time,
    /// Why.
    pub why: String,
}

impl Replay {
    /// The replay of the component of this path, with these classes.
    pub fn new(component: &str, registry: Registry) -> Replay {
        Replay {
            registry,
            spec: None,
            host: ReplayHost::new(component),
            instance: None,
            setting: Setting::default(),
            next: None,
            counts: ReplayCounts::default(),
        }
    }

    /// Has the component have the class, the values and the loops that a composite gives it today.
    #[must_use]
    pub fn with(self, spec: ComponentSpec) -> Replay {
        Replay { spec: Some(spec), ..self }
    }

    /// What came of the steps so far.
    pub fn counts(&self) -> &ReplayCounts {
        &self.counts
    }

    /// Takes the next step of the tape. Gives the difference, if the component does something else than then.
    pub fn step(&mut self, step: &Step) -> Option<Difference> {
        self.counts.steps += 1;
        self.counts.time = Time::from_nanos(step.time);
        let missing = self.next.map_or(0, |next| step.number.saturating_sub(next));
        self.next = Some(step.number + 1);
        if missing > 0 && step.kind != StepKind::Start {
            self.end(step, format!("the recording lacks {missing} of its steps, which were lost"));
        }
        match step.kind {
            StepKind::Start => self.instance = None,
            StepKind::Replaced => {
                self.end(step, "a change of the fleet put another instance in its place".to_owned());
                return None;
            }
            _ if self.instance.is_none() => {
                if self.counts.replayed == 0 && self.counts.ends.is_empty() {
                    self.end(step, "the recording begins in the middle of its run".to_owned());
                }
                return None;
            }
            _ => {}
        }
        self.counts.replayed += 1;
        self.host.begin(step);
        if step.act(ActKind::Fault).is_some() && step.failure.is_some() {
            // Then its code did not run either, and the instance is gone.
            self.instance = None;
            return None;
        }
        let failure = self.run(step).err();
        let difference = self.host.difference(step, failure.as_ref());
        self.host.end(failure.is_none());
        self.counts.differing += u64::from(difference.is_some());
        if let (Some(failure), None) = (&failure, &step.failure) {
            self.end(step, format!("it fails now: {failure}"));
        } else if step.kind == StepKind::Shutdown && failure.is_none() {
            self.instance = None;
        }
        difference
    }

    /// The replay cannot go on before the component starts anew.
    fn end(&mut self, step: &Step, why: String) {
        if self.instance.take().is_some() || self.counts.replayed == 0 {
            self.counts.ends.push(ReplayEnd { time: Time::from_nanos(step.time), why });
        }
    }

    fn run(&mut self, step: &Step) -> Result<(), Failure> {
        match step.kind {
            StepKind::Start => self.start(step),
            StepKind::Execute => self.call(|instance, context| instance.execute(context)),
            StepKind::React => self.call(|instance, context| instance.react(context)),
            StepKind::Shutdown => self.call(|instance, context| instance.shutdown(context)),
            StepKind::Serve => self.serve(step),
            StepKind::Update => {
                let values = step.act(ActKind::Values).and_then(|act| values_of_bytes(&act.bytes));
                let taken = values.ok_or_else(damaged)?;
                let values = self.setting.updated(&taken);
                if step.failure.is_none() {
                    self.setting.recorded = taken;
                }
                let Some(instance) = &mut self.instance else { return Ok(()) };
                contained(|| instance.update(&values)).and_then(|updated| updated)?;
                self.setting.values = values;
                Ok(())
            }
            StepKind::Replaced => Ok(()),
        }
    }

    /// Starts an instance as that on the tape was.
    fn start(&mut self, step: &Step) -> Result<(), Failure> {
        self.setting = Setting::of(step, self.spec.as_ref()).ok_or_else(damaged)?;
        let Setting { class, values, loops, .. } = &self.setting;
        let found = self.registry.get(class).ok_or_else(|| no_class(&self.registry, class))?;
        self.host.set_up(found, loops, &self.registry);
        let constructed = contained(|| found.construct(values)).and_then(|made| made)?;
        let instance = self.instance.insert(constructed);
        let host = &mut self.host;
        let initialized = contained(|| instance.initialize(&mut Context::new(host, &[]))).and_then(|made| made);
        self.host.is_initializing = false;
        initialized.map_err(|failure| self.host.of_loop(failure))?;
        if let Some(saved) = step.act(ActKind::Restored) {
            let saved = Saved::from_bytes(saved.bytes.clone());
            let restored = contained(|| instance.restore(&saved)).and_then(|restored| restored);
            restored.map_err(|failure| Failure::new(format!("could not continue with its saved state: {failure}")))?;
        }
        Ok(())
    }

    fn serve(&mut self, step: &Step) -> Result<(), Failure> {
        let act = step.act(ActKind::Service).ok_or_else(damaged)?;
        let mut call = ServedCall::of(act);
        let mut served = None;
        self.call(|instance, context| {
            let mut invocation = Invocation { service: &act.name, call: &mut call };
            served = Some(instance.serve(&mut invocation, context));
            Ok(())
        })?;
        if let Some(served) = served {
            self.host.note(answered(ActKind::Replied, &served.map(|()| call.reply)));
        }
        Ok(())
    }

    /// Calls the code of the instance with what the step gives it.
    fn call(
        &mut self,
        code: impl FnOnce(&mut dyn DynComponent, &mut Context<'_>) -> Result<(), Failure>,
    ) -> Result<(), Failure> {
        let Some(instance) = &mut self.instance else { return Ok(()) };
        let inboxes = std::mem::take(&mut self.host.inboxes);
        let has_departed = self.host.has_departed();
        let mut context = Context::new(&mut self.host, &inboxes);
        if has_departed {
            context = context.with_departed();
        }
        match contained(|| code(instance.as_mut(), &mut context)) {
            Ok(result) => result,
            Err(panic) => Err(self.host.of_loop(panic)),
        }
    }
}

#[cold]
fn damaged() -> Failure {
    Failure::new("the step cannot be read: it is of another version of the program")
}

#[cold]
fn no_class(registry: &Registry, class: &str) -> Failure {
    let near = registry.nearest(class).first().map(|near| format!("; did you mean `{near}`?")).unwrap_or_default();
    Failure::new(format!("there is no class `{class}`: name its library by `--plugin`{near}"))
}

/// Values by their names.
type Values = Vec<(SmolStr, PropertyValue)>;
/// Deeds of one kind that the host refused, by their places among those of the kind.
type Refusals = BTreeMap<(ActKind, usize), String>;
