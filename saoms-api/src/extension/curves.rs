use crate::Time;
use crate::host::{SharedMessage, TopicDeclaration};

/// The curves of a run: figures over time, from the messages of the fleet.
///
/// Messages are those that were sent, before any fault acts on their ways; they come in the order in which they were
/// sent.
pub trait RunCurves: Send {
    /// True if the messages of a topic are needed, which its publishers declare so and call `name` after renaming.
    /// Asked before the first message of the topic.
    fn wants_topic(&mut self, name: &str, declared: &TopicDeclaration<'_>) -> bool;

    /// Takes in a message that a component sent on such a topic; `component` is the path of the component.
    fn message(&mut self, topic: &str, component: &str, message: &SharedMessage);

    /// The figure of each curve at this time, in the order of the [registration](CurvesRegistration); NaN where it is
    /// not known. What shut down at this very time still counts: so a run does not end with a fleet that is gone.
    fn figures(&self, now: Time) -> Vec<f64>;
}

/// A curve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Curve {
    /// What it shows, such as `awake`.
    pub name: &'static str,
    /// The heading under which it is drawn, with its unit; curves of one panel have the same unit.
    pub panel: &'static str,
    /// True if it counts finished pieces of work, so that it only grows: its slope is the throughput.
    pub is_work: bool,
}

/// The registration of curves.
#[derive(Clone, Copy, Debug)]
pub struct CurvesRegistration {
    /// The curves.
    pub curves: &'static [Curve],
    /// Makes the state of one run.
    pub new: fn() -> Box<dyn RunCurves>,
}

inventory::collect!(CurvesRegistration);

impl CurvesRegistration {
    /// The curves that are linked into this program, by the name of their first panel.
    pub fn linked() -> Vec<&'static CurvesRegistration> {
        let mut all: Vec<&CurvesRegistration> = inventory::iter::<CurvesRegistration>().collect();
        all.sort_by_key(|one| one.curves.first().map(|curve| (curve.panel, curve.name)));
        all
    }
}
