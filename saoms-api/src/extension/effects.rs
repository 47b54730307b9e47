use crate::service::Operation;

/// The operations of a service that has effects outside of the program, such as hardware.
///
/// Where the fleet has a state folder, an effect begins once it is committed that the caller wants it. So a program
/// that goes on after a crash knows of each that may have begun.
///
/// The caller gets the reply `waiting` at once, and asks for the progress until the effect is over, as it does in any
/// case: the first time that it asks after the commit, the effect begins.
#[derive(Clone, Copy, Debug)]
pub struct ServiceEffects {
    /// The name of the interface.
    pub interface: &'static str,
    /// The operation that begins an effect.
    pub begin: Operation,
    /// The operation that asks for its progress.
    pub poll: Operation,
    /// The operations after which an effect that waits does not begin.
    pub end: &'static [Operation],
    /// The reply of both while the effect waits, in CDR.
    pub waiting: fn() -> Vec<u8>,
    /// The reply to who asks for an effect that never began, since its caller was stopped, in CDR.
    pub failed: fn() -> Vec<u8>,
}

inventory::collect!(ServiceEffects);

impl ServiceEffects {
    /// The effects of an interface, if it declares some.
    pub fn of(interface: &str) -> Option<&'static ServiceEffects> {
        inventory::iter::<ServiceEffects>().find(|effects| effects.interface == interface)
    }
}
