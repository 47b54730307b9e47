use crate::Time;
use crate::host::TopicDeclaration;

/// A message that the fleet gets when a component fails and loses what it knew, so that others act in its place.
///
/// A component that goes on from its saved state has lost nothing, and nobody is told. One that is shut down in order
/// speaks for itself.
#[derive(Clone, Copy, Debug)]
pub struct FailureNotice {
    /// A topic: the messages are about the components that publish on it, and that have a number by which they speak.
    pub about: TopicDeclaration<'static>,
    /// The topic of the messages. Its readers in the site of the component get them.
    pub topic: TopicDeclaration<'static>,
    /// Makes the message about the component with this number, in CDR (see [`crate::host::cdr`]), and the text for the
    /// journal.
    pub message: fn(Outage) -> (Vec<u8>, String),
}

/// A component that failed and lost what it knew.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Outage {
    /// Number by which it speaks in messages.
    pub number: u32,
    /// Time of the failure.
    pub since: Time,
    /// True if it is started again, and begins anew then; `false` if it stays out until somebody starts it.
    pub restarts: bool,
}

inventory::collect!(FailureNotice);

impl FailureNotice {
    /// The notices that are linked into this program, in no particular order.
    pub fn linked() -> impl Iterator<Item = &'static FailureNotice> {
        inventory::iter::<FailureNotice>()
    }
}
