//! Rules about worlds.

pub(super) mod forgets;
pub(super) mod mixed;
pub(super) mod slow;
pub(super) mod unused;

pub(crate) use forgets::judge_crash;
