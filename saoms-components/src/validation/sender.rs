//! Who sent a message, and which numbers components of the fleet have.

use saoms_api::Context;

use super::Validate;

/// The sender of a message.
#[derive(Clone, Copy)]
pub(crate) struct Sender<'a> {
    /// The index of the component, as in the header of the message.
    pub(super) component: u32,
    /// The component of the fleet that speaks by a number on the topic of the message.
    speaker: &'a dyn Fn(u32) -> Option<u32>,
}

impl<'a> Sender<'a> {
    /// A sender in a fleet that knows these speakers.
    #[cfg(test)]
    pub(super) fn among(speaker: &'a dyn Fn(u32) -> Option<u32>, component: u32) -> Sender<'a> {
        Sender { component, speaker }
    }

    /// Judges a message of a component: `judge` gets it as the sender. The fleet is asked only where that is needed.
    #[inline]
    pub(super) fn judge<M: Validate, T>(
        component: u32,
        context: &Context<'_>,
        judge: impl FnOnce(Sender<'_>) -> T,
    ) -> T {
        let speaker = |number| M::SPOKEN_ON.and_then(|topic| context.speaker(&topic, number));
        judge(Sender { component, speaker: &speaker })
    }

    /// The component of the fleet that speaks by a number.
    pub(super) fn speaker(&self, number: u32) -> Option<u32> {
        (self.speaker)(number)
    }
}

/// A sender in a fleet that knows no speakers.
impl From<u32> for Sender<'_> {
    fn from(component: u32) -> Self {
        Sender { component, speaker: &|_| None }
    }
}
