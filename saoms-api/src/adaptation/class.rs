use crate::host::declaration::ConstText;
use crate::host::{DynEntries, DynLoop, PropertyValue, SmolStr};
use crate::{Failure, Loop, Properties};

/// The declaration of a loop, which `#[derive(LoopClass)]` writes.
///
/// The doc of the struct becomes that of the loop. `#[looping(...)]` takes, in any order and in one or several
/// attributes:
///
/// | attribute | meaning |
/// | --- | --- |
/// | `name = "saoms.CollisionMS"` | the name that composite files use; what follows the last dot names the loop within a component |
/// | `knowledge = RobotKnowledge`, `knowledge = "saoms.Robot"` | the [knowledge](crate::host::KnowledgeClass) it works on; without it, any that has the entries |
/// | `senses("battery", "block")` | the entries it reads |
/// | `effects("next")` | the entries it changes |
/// | `entries(Saving)` | entries of its own, a struct that derives [`Entries`](crate::Entries) and `Default`; they are added to the knowledge |
/// | `publishes(A, B)`, `subscribes(A, B)` | paths to constants of type [`Topic`](crate::Topic) |
/// | `reference("gps": Gps)`, `reference("gps": Gps, optional)` | a service of another component that it calls |
///
/// Topics and references of a loop count as those of the component that has the loop; where both have a reference of
/// one name, it is one.
///
/// Linked loops register themselves: [`LoopRegistration::linked`] lists them.
///
/// ```
/// use saoms_api::{Context, Failure, Loop, LoopClass, Entry, Effector, Knowledge, Properties, Record, record};
///
/// /// What a composite can set.
/// #[derive(Properties)]
/// struct SaverProperties {
///     /// Below this charge the robot saves.
///     #[property(default = 50.0, range = 0.0..=100.0, unit = "%")]
///     threshold: f64,
/// }
///
/// /// Takes no new job while the battery is rather empty.
/// #[derive(LoopClass)]
/// #[looping(name = "example.BatterySaver", senses("battery"), effects("busy"))]
/// struct BatterySaver {
///     properties: SaverProperties,
///     battery: Entry<f64>,
///     busy: Effector<bool>,
/// }
///
/// impl Loop for BatterySaver {
///     type Properties = SaverProperties;
///     type Knowledge = dyn Knowledge;
///     type Symptom = Record;
///     type Decision = Record;
///
///     fn new(properties: SaverProperties) -> Result<Self, Failure> {
///         Ok(BatterySaver { properties, battery: Entry::default(), busy: Effector::default() })
///     }
///
///     fn initialize(&mut self, knowledge: &mut dyn Knowledge, _: &mut Context<'_>) -> Result<(), Failure> {
///         self.battery = knowledge.entry("battery")?;
///         self.busy = knowledge.effector("busy")?;
///         Ok(())
///     }
///
///     fn analyze(&mut self, knowledge: &mut dyn Knowledge, _: &mut Context<'_>) -> Result<Option<Record>, Failure> {
///         let battery = self.battery.get(knowledge)?;
///         let is_low = battery < self.properties.threshold;
///         Ok(is_low.then(|| record!(low_battery: "battery is low: {battery} %", battery)))
///     }
///
///     fn plan(
///         &mut self,
///         _: Record,
///         knowledge: &mut dyn Knowledge,
///         _: &mut Context<'_>,
///     ) -> Result<Option<Record>, Failure> {
///         Ok((!self.busy.get(knowledge)?).then(|| record!(takes_no_job: "takes no job")))
///     }
///
///     fn execute(&mut self, _: Record, knowledge: &mut dyn Knowledge, _: &mut Context<'_>) -> Result<(), Failure> {
///         self.busy.set(knowledge, true)
///     }
/// }
/// ```
pub trait LoopClass: Loop {
    /// The name that composite files use.
    const NAME: &'static str;
    /// Everything that the loop declares, as JSON; its shape is described in [`crate::host::declaration`].
    const DECLARATION: &'static str;
    /// The knowledge it works on; `None` for any.
    const KNOWLEDGE: Option<&'static str>;
    /// The entries it changes, beside its own.
    const EFFECTS: &'static [&'static str];

    /// The entries that it adds to the knowledge.
    fn entries() -> Option<Box<dyn DynEntries>> {
        None
    }
}

/// For generated code: a member of a JSON object, with its label, or nothing.
pub const fn member(label: &'static str, text: Option<&'static str>) -> [ConstText; 2] {
    match text {
        Some(text) => [ConstText::Plain(label), ConstText::Quoted(text)],
        None => [ConstText::EMPTY, ConstText::EMPTY],
    }
}

/// For generated code: whether a loop that works on `knowledge`, or on any, fits a class with the knowledge `of`.
pub const fn fits(knowledge: Option<&str>, of: &str) -> bool {
    match knowledge {
        Some(knowledge) => crate::property::equal(knowledge.as_bytes(), of.as_bytes()),
        None => true,
    }
}

/// The function that makes a loop from the values of its properties.
type Construct = fn(&[(SmolStr, PropertyValue)]) -> Result<Box<dyn DynLoop>, Failure>;

/// Registration of a loop: its declaration as text, and its constructor. `#[derive(LoopClass)]` submits one for every
/// loop that is linked in, and each class brings those of its own loops.
#[derive(Clone, Copy, Debug)]
pub struct LoopRegistration {
    name: &'static str,
    declaration: &'static str,
    construct: Construct,
}

impl LoopRegistration {
    /// The registration of a loop.
    pub const fn of<L: LoopClass>() -> LoopRegistration {
        LoopRegistration {
            name: L::NAME,
            declaration: L::DECLARATION,
            construct: |values| Ok(Box::new(L::new(L::Properties::from_values(values)?)?)),
        }
    }

    /// The name that composite files use.
    pub const fn name(&self) -> &'static str {
        self.name
    }

    /// The loop's declaration, in the shape of [`crate::host::declaration`].
    pub const fn declaration(&self) -> &'static str {
        self.declaration
    }

    /// Constructs a loop from the values that its composite gives; absent ones take their defaults.
    ///
    /// # Errors
    /// A value is missing or wrong (the checker finds these before, with their place), or the values do not fit
    /// together.
    pub fn construct(&self, values: &[(SmolStr, PropertyValue)]) -> Result<Box<dyn DynLoop>, Failure> {
        (self.construct)(values)
    }

    /// The loops that are linked into this program, in no particular order.
    pub fn linked() -> impl Iterator<Item = &'static LoopRegistration> {
        inventory::iter::<LoopRegistration>()
    }
}

inventory::collect!(LoopRegistration);
