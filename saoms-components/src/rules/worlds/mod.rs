//! Rules about worlds.

pub(super) mod mixed;
pub(super) mod slow;
pub(super) mod unused;
