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
/// | `knowledge = RobotKnowledge`, `knowledge = "saoms.Robot"` | the [knowledge](crate::host::KnowledgeClass) it works on; without it, that of its type, or any that has the entries |
///
/// The fields say the rest, each in one attribute:
///
/// | field | what it is |
/// | --- | --- |
/// | `#[senses] battery: Entry<f64>` | an entry that it reads, named like the field in lowerCamelCase; `#[senses("charge")]` gives another name |
/// | `#[effects] charge_at: Effector<f64>` | an entry that it changes |
/// | `#[entry(unit = "%", default = 100.0)] lowest: Effector<f64>` | an entry of its own, which it adds to the knowledge, with its first value and all that [`Entries`](crate::Entries) says |
/// | `#[publishes(A)] a: Publisher<A>`, `#[subscribes(B)] b: Subscription<B>` | a [`Topic`](crate::Topic) |
/// | `#[reference] gps: GpsReference` | a service of another component that it calls, as of a [class](crate::Class) |
/// | `#[property(default = 1.0)] limit: f64`, `#[properties] properties: DimmerProperties` | what a composite sets, as of a class |
///
/// What is not kept in a field is declared in `#[looping(...)]`, too, and requested in
/// [`initialize`](Loop::initialize): `senses("battery", "block")`, `effects("next")`, `entries(Saving)` (a struct that
/// derives [`Entries`](crate::Entries) and `Default`), `publishes(A, B)`, `subscribes(A, B)`, `reference("gps": Gps)`.
/// A loop that works on a component's own struct names so what it senses and effects.
///
/// Topics and references of a loop count as those of the component that has the loop; where both have a reference of
/// one name, it is one.
///
/// Linked loops register themselves: [`LoopRegistration::linked`] lists them. [`SimpleLoop`](crate::SimpleLoop) has an
/// example.
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
