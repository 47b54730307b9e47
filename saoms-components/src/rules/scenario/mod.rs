//! Rules about the events of scenarios.

pub(super) mod broken_twice;
pub(super) mod early_end;
mod event_block;
pub(super) mod luggage;
pub(crate) mod no_work;
pub(super) mod strain;
pub(super) mod unknown_robot;
pub(super) mod unserved;

pub(crate) use luggage::judge_luggage;
pub(crate) use strain::judge_outage;
pub(crate) use unknown_robot::judge_robot;
