//! The state of one component, which the phases of a check fill.

use std::rc::Rc;

use crate::assembly::TaskProperties;
use crate::check::fleet::Member;
use crate::check::loops;
use crate::check::properties::findings::{Renamed, Subject};
use crate::check::properties::given_values::PropertyValues;

/// Everything that is found out about one component.
#[derive(Default)]
pub(crate) struct ComponentCheck<'a> {
    pub(crate) state: ComponentState,
    /// The values of its properties; nothing for a component without a class.
    pub(crate) given: PropertyValues,
    /// Its loops; `None` where they have a fault, which is reported.
    pub(crate) loops: Option<loops::Resolved<'a>>,
    /// Its task; `None` for a passive component.
    pub(crate) task: Option<TaskProperties>,
    /// The topics to which it gives new names.
    pub(crate) renamed: Rc<[Renamed]>,
}

/// Soundness of a component.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum ComponentState {
    /// It has no class here.
    #[default]
    WithoutClass,
    /// It has a class, and a fault that is reported: what follows from the fault is not.
    Faulty,
    /// Its class can construct it.
    Sound,
}

impl<'a> ComponentCheck<'a> {
    /// The component with these values and loops, whose task is not known yet.
    pub(crate) fn new((given, loops): (PropertyValues, Option<loops::Resolved<'a>>)) -> Self {
        Self { given, loops, ..Self::default() }
    }

    /// True for a component that can be constructed.
    pub(crate) fn is_sound(&self) -> bool {
        self.state == ComponentState::Sound
    }

    /// The component as findings are about it.
    pub(crate) fn subject<'s>(&'s self, member: &'s Member<'_>) -> Subject<'s> {
        let (name, given) = (&member.component.name, &self.given);
        let (values, places, element) = (given.own(), given.places(), Some(member.component));
        Subject {
            what: "component",
            name,
            at: name.location,
            element,
            renamed: &self.renamed,
            values,
            places,
            site: &member.site,
        }
    }
}
