//! Clocks, sleeping, threads and priorities of the operating system.

pub(super) mod clock;
pub(super) mod realtime;
pub(super) mod sys;
pub(super) mod thread;
