use crate::CallError;
use crate::service::{Operation, ServiceCall};

/// How components call a service in another program without waiting: through a proxy in their own one.
///
/// Each target of a reference has a proxy of its own. It outlives failures of the component, as the service does.
/// Without a proxy for its interface, a service is called over a network by classes that are `apart` alone, which wait
/// for the answer.
#[derive(Clone, Copy, Debug)]
pub struct RemoteProxy {
    /// The name of the interface.
    pub interface: &'static str,
    /// Makes a proxy.
    pub make: fn() -> Box<dyn CallProxy>,
}

inventory::collect!(RemoteProxy);

impl RemoteProxy {
    /// The proxy of an interface, if one is linked into this program.
    pub fn of(interface: &str) -> Option<&'static RemoteProxy> {
        inventory::iter::<RemoteProxy>().find(|proxy| proxy.interface == interface)
    }
}

/// A proxy of a service in another program.
pub trait CallProxy: Send {
    /// Serves a call, and does not wait. It makes calls over the line, and looks what came of earlier ones.
    ///
    /// # Errors
    /// As calls in one program; [`CallError::Busy`] says that the answer is not known yet.
    fn call(&mut self, line: &mut dyn CallLine, call: &mut dyn ServiceCall) -> Result<(), CallError>;
}

/// The line from a proxy to its service. Calls are made one after the other, each at most once. They have no deadline:
/// a call waits until its program answers, or is gone.
pub trait CallLine {
    /// Makes a call once those before it have an outcome. With a `program` it is for that one alone, which gave an
    /// earlier reply. Gives the number of the call.
    fn start(&mut self, operation: Operation, arguments: Vec<u8>, program: Option<u64>) -> u64;

    /// What came of a call, once that is known. It is given once.
    fn outcome(&mut self, call: u64) -> Option<CallOutcome>;

    /// The path of the component that offers the service.
    fn provider(&self) -> &str;

    /// True if the caller ends: who answers [`CallError::Busy`] is not asked again.
    fn is_ending(&self) -> bool;
}

/// What came of a call over a [`CallLine`].
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum CallOutcome {
    /// A reply.
    Reply {
        /// The program that gave it: another number after each start.
        program: u64,
        /// The reply in CDR.
        bytes: Vec<u8>,
    },
    /// The component did not serve the call.
    Refused(CallError),
    /// The program has ended or has begun anew: it ran at most once there.
    Gone,
    /// It was overtaken by a stop of the hardware: it ran at most once.
    Stopped,
}
