use super::Change;
use crate::host::DerivedLoop;
use crate::{Context, Effector, Failure, Field, Knowledge, Loop, Properties, Record, Recordable};

/// A loop that is one function: from the knowledge to a symptom, a decision and what this changes.
///
/// It works on any knowledge that has the entries that its fields name. A loop that monitors, that does more than to
/// set entries, or that works on the struct of a component is a [`Loop`].
///
/// ```
/// use saoms_api::{Adaptation, Context, Effector, Entry, Failure, Knowledge, LoopClass, Own, SimpleLoop, record};
///
/// /// Takes no new job while the battery is rather empty.
/// #[derive(LoopClass)]
/// #[looping(name = "example.BatterySaver")]
/// struct BatterySaver {
///     /// Below this charge the robot saves.
///     #[property(default = 50.0, range = 0.0..=100.0, unit = "%")]
///     threshold: f64,
///     #[senses]
///     battery: Entry<f64>,
///     #[effects]
///     busy: Effector<bool>,
/// }
///
/// impl SimpleLoop for BatterySaver {
///     type Properties = Own<Self>;
///
///     fn adapt(&mut self, robot: &dyn Knowledge, _: &mut Context<'_>) -> Result<Option<Adaptation>, Failure> {
///         let battery = self.battery.get(robot)?;
///         if battery >= self.threshold || self.busy.get(robot)? {
///             return Ok(None);
///         }
///         let low = Adaptation::of(record!(low_battery: "battery is low: {battery} %", battery));
///         Ok(Some(low.decides(record!(takes_no_job: "takes no job")).sets(&self.busy, true)))
///     }
/// }
/// ```
pub trait SimpleLoop: DerivedLoop + Send + Sized + 'static {
    /// As [`Loop::Properties`].
    type Properties: Properties;

    /// Makes the loop, as [`Loop::new`].
    ///
    /// # Errors
    /// The values do not fit together.
    fn new(properties: Self::Properties) -> Result<Self, Failure> {
        <Self as DerivedLoop>::made::<true>(properties)
    }

    /// Looks for a reason to act, and returns what to do about it; called once in each execution of the component.
    ///
    /// # Errors
    /// The component has failed.
    fn adapt(&mut self, knowledge: &dyn Knowledge, context: &mut Context<'_>) -> Result<Option<Adaptation>, Failure>;
}

/// What a [`SimpleLoop`] found, decided and changes.
#[derive(Clone, Debug)]
pub struct Adaptation {
    symptom: Record,
    decision: Option<Record>,
    changes: Vec<Change>,
}

/// The second half of an [`Adaptation`].
#[derive(Clone, Debug)]
pub struct Decided {
    decision: Record,
    changes: Vec<Change>,
}

impl Adaptation {
    /// A symptom about which nothing is done.
    #[must_use]
    pub fn of(symptom: Record) -> Adaptation {
        Adaptation { symptom, decision: None, changes: Vec::new() }
    }

    /// The same symptom, about which this is done.
    #[must_use]
    pub fn decides(self, decision: Record) -> Adaptation {
        Adaptation { decision: Some(decision), ..self }
    }

    /// The same decision, by which this entry becomes this value. Without a decision nothing changes.
    #[must_use]
    pub fn sets<T: Field>(mut self, effector: &Effector<T>, value: T) -> Adaptation {
        self.changes.push(effector.change(&value));
        self
    }
}

impl Recordable for Adaptation {
    fn record(&self) -> Record {
        self.symptom
    }

    fn lend<'a>(&'a self, _: &'a mut Option<Record>) -> &'a Record {
        &self.symptom
    }
}

impl Recordable for Decided {
    fn record(&self) -> Record {
        self.decision
    }

    fn lend<'a>(&'a self, _: &'a mut Option<Record>) -> &'a Record {
        &self.decision
    }
}

impl<L: SimpleLoop> Loop for L {
    type Properties = <L as SimpleLoop>::Properties;
    type Knowledge = dyn Knowledge;
    type Symptom = Adaptation;
    type Decision = Decided;

    fn new(properties: Self::Properties) -> Result<Self, Failure> {
        <L as SimpleLoop>::new(properties)
    }

    fn analyze(
        &mut self,
        knowledge: &mut dyn Knowledge,
        context: &mut Context<'_>,
    ) -> Result<Option<Adaptation>, Failure> {
        self.adapt(knowledge, context)
    }

    fn plan(
        &mut self,
        symptom: Adaptation,
        _: &mut dyn Knowledge,
        _: &mut Context<'_>,
    ) -> Result<Option<Decided>, Failure> {
        let Adaptation { decision, changes, .. } = symptom;
        Ok(decision.map(|decision| Decided { decision, changes }))
    }

    fn execute(&mut self, decided: Decided, knowledge: &mut dyn Knowledge, _: &mut Context<'_>) -> Result<(), Failure> {
        decided.changes.iter().try_for_each(|change| change.make(knowledge))
    }
}
