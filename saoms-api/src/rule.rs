//! Rules over a whole fleet, for authors of components: what no component can see alone.

pub(crate) mod nearest;

use std::any::{Any, TypeId};
use std::cell::RefCell;
use std::rc::Rc;
use std::time::Duration;

pub use nearest::nearest;

use crate::event::Event;
use crate::host::{PropertyValue, SmolStr};
use crate::property::values_of;
use crate::{Class, Finding, Properties};

/// The severity of a finding.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Severity {
    /// Worth knowing.
    Note,
    /// Probably not meant; nothing is stopped by it.
    Warning,
    /// Nothing starts.
    Error,
}

impl Severity {
    /// Its name in lower case, as in the output for machines.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Note => "note",
            Self::Warning => "warning",
            Self::Error => "error",
        }
    }
}

/// A kind of diagnostic.
#[derive(Debug, PartialEq, Eq)]
pub struct Code {
    /// The stable code, as `S0101`.
    pub id: &'static str,
    /// A stable name, as `unknown-attribute`.
    pub name: &'static str,
    /// Meaning in one sentence.
    pub meaning: &'static str,
    /// Default severity.
    pub severity: Severity,
    /// The rule of the SCA specification it enforces, when there is just one.
    pub rule: Option<&'static str>,
}

/// A rule over a whole fleet, which a crate of components adds to the checker: what no component can see alone.
///
/// It is asked before anything runs, and is pure: the same fleet, the same findings. Where a component has a fault of
/// its own, only the rules are asked that can judge the others without it (see [`FleetRule::judges_parts`]).
///
/// ```
/// use saoms_api::rule::{Code, FleetRule, FleetView, Severity};
/// use saoms_api::{Finding, Place};
///
/// /// One clock is enough.
/// fn one_clock(fleet: &FleetView<'_>) -> Vec<Finding> {
///     let components = fleet.components().iter().enumerate();
///     let clocks = components.filter(|(_, component)| component.class.name == "example.Clock");
///     let finding = |index| Finding::new(Place::component(index), "this is a second clock").help("keep one");
///     clocks.skip(1).map(|(index, _)| finding(index)).collect()
/// }
///
/// static ONE_CLOCK: FleetRule = FleetRule {
///     code: Code {
///         id: "X0001",
///         name: "one-clock",
///         meaning: "A fleet has several clocks.",
///         severity: Severity::Warning,
///         rule: None,
///     },
///     judges_parts: true,
///     prevents_start: false,
///     check: one_clock,
/// };
/// saoms_api::fleet_rules!(ONE_CLOCK);
/// ```
#[derive(Debug)]
pub struct FleetRule {
    /// The code of its findings.
    pub code: Code,
    /// True if its findings hold whatever the components are that [`FleetView::misses`] reports. A rule that looks for
    /// something that should be there can only judge whole fleets.
    pub judges_parts: bool,
    /// True if a fleet with its errors cannot start, as with robots on blocked blocks: the severity of such errors
    /// cannot be lowered.
    pub prevents_start: bool,
    /// Function that finds the faults of a fleet.
    pub check: fn(&FleetView<'_>) -> Vec<Finding>,
}

/// Registration of a rule that is linked in.
#[doc(hidden)]
#[derive(Debug)]
pub struct LinkedRule(pub &'static FleetRule);

inventory::collect!(LinkedRule);

impl FleetRule {
    /// The rules that are linked into this program, in no particular order.
    pub fn linked() -> impl Iterator<Item = &'static FleetRule> {
        inventory::iter::<LinkedRule>().map(|linked| linked.0)
    }
}

/// Makes rules known to the checker of every program that this crate is linked into: the paths of `static`
/// [`FleetRule`]s.
#[macro_export]
macro_rules! fleet_rules {
    ($($rule:path),* $(,)?) => {
        $(const _: () = {
            $crate::generated::inventory::submit! { $crate::generated::LinkedRule(&$rule) }
        };)*
    };
}

/// All components of a fleet, as rules see them.
#[derive(Debug)]
pub struct FleetView<'a> {
    components: &'a [ComponentView<'a>],
    missing: &'a [Option<Vec<&'a str>>],
    is_site_of_several: bool,
    facts: RefCell<Vec<(TypeId, Rc<dyn Any>)>>,
}

/// A value derived from a fleet that several rules of a crate share, computed once by [`FleetView::fact`].
///
/// ```
/// use saoms_api::rule::{Fact, FleetView};
///
/// struct Clocks(Vec<usize>);
///
/// impl Fact for Clocks {
///     fn of(fleet: &FleetView<'_>) -> Clocks {
///         let all = fleet.components().iter().enumerate();
///         let clocks = all.filter(|(_, component)| component.class.name == "example.Clock");
///         Clocks(clocks.map(|(index, _)| index).collect())
///     }
/// }
///
/// let fleet = FleetView::new(&[]);
/// assert!(fleet.fact::<Clocks>().0.is_empty());
/// ```
pub trait Fact: 'static {
    /// Looks at the fleet.
    fn of(fleet: &FleetView<'_>) -> Self;
}

impl<'a> FleetView<'a> {
    /// For hosts: a view of these components.
    pub fn new(components: &'a [ComponentView<'a>]) -> FleetView<'a> {
        FleetView { components, missing: &[], is_site_of_several: false, facts: RefCell::default() }
    }

    /// For hosts: the same view, from which components with faults of their own are left out: the declarations of their
    /// classes and of those that these extend, as far as they are known. Where faults leave wires open, the classes of
    /// components that these may start from are among them, too.
    #[must_use]
    pub fn without(self, missing: &'a [Option<Vec<&'a str>>]) -> FleetView<'a> {
        FleetView { missing, ..self }
    }

    /// For hosts: the same view, of one of several sites that have nothing to do with each other.
    #[must_use]
    pub fn of_several(self, is_site_of_several: bool) -> FleetView<'a> {
        FleetView { is_site_of_several, ..self }
    }

    /// True if these are the components of a site, and other sites, which have nothing to do with it, have others.
    pub fn is_site_of_several(&self) -> bool {
        self.is_site_of_several
    }

    /// For hosts: the components that [`without`](FleetView::without) left out.
    #[doc(hidden)]
    pub fn missing(&self) -> &'a [Option<Vec<&'a str>>] {
        self.missing
    }

    /// True if a component that is, or may be, of this class or one that extends it is left out for a fault of its own,
    /// or has references whose wires are not known for a fault.
    pub fn misses<C: Class>(&self) -> bool {
        self.missing.iter().any(|declaration| declaration.as_ref().is_none_or(|all| all.contains(&C::DECLARATION)))
    }

    /// The components in document order; the place of one here is its index.
    pub fn components(&self) -> &'a [ComponentView<'a>] {
        self.components
    }

    /// The indices of the components of a class, and of those that extend it.
    pub fn indices<C: Class>(&self) -> impl Iterator<Item = usize> + use<'a, C> {
        self.kin::<C>().map(|(index, ..)| index)
    }

    /// The components of a class, and of those that extend it, with their indices and properties.
    pub fn all<C: Class>(&self) -> impl Iterator<Item = (usize, C::Properties)> + use<'a, C> {
        self.kin::<C>().filter_map(|(index, component, kinship)| Some((index, component.read::<C>(kinship)?)))
    }

    fn kin<C: Class>(&self) -> impl Iterator<Item = (usize, &'a ComponentView<'a>, Kinship)> + use<'a, C> {
        // Components of one class lend the same text of its declaration, so that few of these long texts are compared.
        let mut last: Option<(&'a ComponentView<'a>, Kinship)> = None;
        self.components.iter().enumerate().filter_map(move |(index, component)| {
            let kinship = match last {
                Some((known, kinship)) if std::ptr::eq(known.class.declaration, component.class.declaration) => kinship,
                _ => component.kinship::<C>(),
            };
            last = Some((component, kinship));
            (kinship != Kinship::None).then_some((index, component, kinship))
        })
    }

    /// A fact about the fleet: it is computed for the first rule that requests it, and shared by all rules of the
    /// crate.
    pub fn fact<F: Fact>(&self) -> Rc<F> {
        let key = TypeId::of::<F>();
        let known = self.facts.borrow().iter().find(|(of, _)| *of == key).map(|(_, fact)| Rc::clone(fact));
        if let Some(Ok(known)) = known.map(Rc::downcast) {
            return known;
        }
        // Facts may rest on others, so nothing is borrowed here.
        let fact = Rc::new(F::of(self));
        self.facts.borrow_mut().push((key, Rc::clone(&fact) as Rc<dyn Any>));
        fact
    }
}

/// Relation between the classes of two components.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kinship {
    Same,
    Extends,
    None,
}

/// A class with loops, as rules see it.
#[derive(Clone, Debug)]
pub struct ClassView<'a> {
    /// Its name, as declared.
    pub name: &'a str,
    /// Its declaration.
    pub declaration: &'a str,
    /// The declarations of the classes that it extends, the nearest first.
    pub extends: Vec<&'a str>,
    /// The topics that it and the loops publish, by their names before any `topicRename`.
    pub publishes: Vec<&'a str>,
    /// The topics that it and the loops read, by their names before any `topicRename`. A rule of a library gets none.
    pub subscribes: Vec<&'a str>,
    /// The classes of the loops, in their order.
    pub loops: Vec<&'a str>,
    /// The events that it takes. A rule of a library gets none.
    pub takes: Vec<Event>,
}

/// A component of a fleet, as rules see it.
#[derive(Clone, Debug)]
pub struct ComponentView<'a> {
    /// Its path in the composite.
    pub path: &'a str,
    /// Its class, which it shares with others of the same loops.
    pub class: Rc<ClassView<'a>>,
    /// The values of the class's own properties, presets included; absent ones have their default.
    pub values: &'a [(SmolStr, PropertyValue)],
    /// From one execution to the next, where it is periodic.
    pub period: Option<Duration>,
    /// False if it does not start with the fleet, but waits until another component schedules it.
    pub starts: bool,
    /// True if it starts again after a failure (`restart`). A rule of a library gets false.
    pub restarts: bool,
    /// The node that runs it; empty in a fleet without nodes, and for a rule of a library.
    pub node: &'a str,
    /// True if its messages go to a broker, which may have users outside this fleet: a fleet that names its nodes has
    /// none.
    pub has_broker: bool,
    /// The topics that have another name on the bus than in the declaration of its class: that one, and the one on the
    /// bus.
    pub renamed: &'a [(&'a str, &'a str)],
    /// Its references that are wired, and the index of the component that each leads to.
    pub wires: &'a [(&'a str, usize)],
}

impl ComponentView<'_> {
    /// Its properties, where it is of this class. Of a component whose class extends this one they are those that the
    /// two have in common.
    pub fn properties<C: Class>(&self) -> Option<C::Properties> {
        self.read::<C>(self.kinship::<C>())
    }

    fn kinship<C: Class>(&self) -> Kinship {
        match self.class.declaration == C::DECLARATION {
            true => Kinship::Same,
            false if self.class.extends.contains(&C::DECLARATION) => Kinship::Extends,
            false => Kinship::None,
        }
    }

    fn read<C: Class>(&self, kinship: Kinship) -> Option<C::Properties> {
        match kinship {
            Kinship::Same => C::Properties::from_values(self.values).ok(),
            Kinship::Extends => C::Properties::from_values(&values_of(self.values, C::Properties::NAMES)).ok(),
            Kinship::None => None,
        }
    }

    /// The name on the bus of a topic that its class declares under this name.
    pub fn topic<'t>(&'t self, declared: &'t str) -> &'t str {
        self.renamed.iter().find(|(old, _)| *old == declared).map_or(declared, |(_, new)| new)
    }

    /// The index of the component that this reference leads to.
    pub fn target(&self, reference: &str) -> Option<usize> {
        self.wires.iter().find(|(name, _)| *name == reference).map(|(_, target)| *target)
    }
}
