use crate::Time;
use crate::event::fault::FaultCall;
use crate::host::{SharedMessage, TopicDeclaration};

use super::Counts;

/// What has to hold in each run of a fleet, whatever is done to it: judged by the messages that components send.
///
/// Messages are those that components of this program sent, before any fault acts on their ways; they come in the order
/// in which they were sent. Other programs judge what theirs send.
pub trait RunInvariants: Send {
    /// True if the messages of a topic are judged, which its publishers declare so and call `name` after renaming.
    /// Asked before the first message of the topic.
    fn wants_topic(&mut self, name: &str, declared: &TopicDeclaration<'_>) -> bool;

    /// Takes in that the run goes on from what an earlier program left, before the first message: what came before is
    /// not known.
    fn goes_on(&mut self) {}

    /// Takes in a message that a component of this program sent on such a topic.
    fn message(&mut self, topic: &str, message: &SharedMessage);

    /// Takes in a fault that begins. `concerned` are the components that a fault of components names, those of other
    /// programs included; without any for a fault of messages.
    fn fault(&mut self, at: Time, call: &FaultCall, concerned: &[ConcernedComponent]);

    /// Takes in the end of the run.
    fn end(&mut self, at: Time, end: RunEnd, counts: &Counts<'_>);

    /// The violations since the last call.
    fn violations(&mut self) -> Vec<Violation>;

    /// What the run came to, after its end.
    fn measures(&self) -> Vec<Measure>;

    /// How much was simulated, after the end of the run: hours of something, all in all, such as robot-hours. Divided
    /// by the processor time, that is the performance of the simulation.
    fn simulated(&self) -> Option<Measure> {
        None
    }
}

/// Ways in which a run ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RunEnd {
    /// No work is left, or it has failed.
    Own,
    /// Something from outside ended it, such as a time limit.
    CutOff,
    /// Nothing can happen any more, although work is left: what has not happened never does.
    Standstill,
}

/// A component that a fault concerns.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ConcernedComponent {
    /// Its path.
    pub path: String,
    /// The topics on which it may send.
    pub publishes: Vec<ConcernedTopic>,
    /// True if it begins anew after a failure.
    pub restarts: bool,
}

/// A topic on which a component that a fault concerns may send.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ConcernedTopic {
    /// Its name after renaming, with the site before it.
    pub name: String,
    /// The name of the type of its messages.
    pub message: String,
}

/// A violation of an invariant.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Violation {
    /// The invariant, as its number and a few words: `1 no two robots in a block`.
    pub invariant: &'static str,
    /// When it was seen, in the time of the run.
    pub at: Time,
    /// What was found.
    pub text: String,
}

/// A figure of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Measure {
    /// Its name, with its unit.
    pub name: &'static str,
    /// The figure.
    pub value: f64,
    /// The greatest that it could be, where that is known; such figures are added up over runs, and others are
    /// averaged.
    pub of: Option<f64>,
}

/// The registration of invariants. Real fleets, tests and `saoms simulate` are held to all that are linked in.
#[derive(Clone, Copy, Debug)]
pub struct InvariantsRegistration {
    /// Makes the state of one run.
    pub new: fn() -> Box<dyn RunInvariants>,
}

inventory::collect!(InvariantsRegistration);

impl InvariantsRegistration {
    /// The invariants that are linked into this program, for one run.
    pub fn linked() -> Vec<Box<dyn RunInvariants>> {
        inventory::iter::<InvariantsRegistration>().map(|one| (one.new)()).collect()
    }
}
