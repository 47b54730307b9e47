//! The state of one component, which the phases of a check fill.

use saoms_api::host::PropertyValue;
use smol_str::SmolStr;

use crate::assembly::TaskProperties;
use crate::check::fleet::Member;
use crate::check::loops;
use crate::check::properties::given_values::{PropertyValues, ValueOrigin};
use crate::check::report::findings::Subject;
use crate::source::Location;

/// Everything that is found out about one component.
#[derive(Default)]
pub(crate) struct ComponentCheck<'a> {
    pub(crate) state: State,
    /// The values that it gives; nothing for a component without a class.
    pub(crate) given: PropertyValues,
    /// Its loops; `None` where they have a fault, which is reported.
    pub(crate) loops: Option<loops::Resolved<'a>>,
    /// The values of the class's own properties, as its constructor takes them.
    pub(crate) values: Vec<(SmolStr, PropertyValue)>,
    /// The origins of those values that are not one text in the composite.
    pub(crate) origins: Vec<ValueOrigin>,
    /// Its task; `None` for a passive component.
    pub(crate) task: Option<TaskProperties>,
    /// The new names of its topics, with their places.
    pub(crate) renamed: Vec<(String, Location)>,
    /// The place of its `queue`.
    pub(crate) queue: Option<Location>,
}

/// The knowledge about a component.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum State {
    /// It has no class here.
    #[default]
    WithoutClass,
    /// It has a class, and a fault that is reported: what follows from the fault is not told.
    Faulty,
    /// Its class can construct it.
    Sound,
}

impl ComponentCheck<'_> {
    /// True for a component that can be constructed.
    pub(crate) fn is_sound(&self) -> bool {
        self.state == State::Sound
    }

    /// The component as findings are about it.
    pub(crate) fn subject<'s>(&'s self, member: &Member<'s>) -> Subject<'s> {
        Subject::of(member, &self.values, &self.origins)
    }
}
