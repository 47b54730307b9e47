//! Commands that reach a running fleet: each is a client of the server in the program that runs it.

mod alerts;
mod change;
mod emergency;
mod fleet;
mod journal;
mod logs;
mod orders;
mod over_network;
mod ps;
mod status;
mod table;
mod time;
mod top;
mod topic;

pub(super) use alerts::{AlertsArguments, alerts};
pub(super) use change::{ApplyArguments, PlanArguments, apply, plan};
pub(super) use emergency::{EmergencyStopArguments, ReleaseArguments, estop, release};
pub(super) use fleet::{RunningFleetArguments, escape};
pub(super) use journal::{JournalArguments, journal};
pub(super) use logs::{LogsArguments, logs};
pub(super) use orders::{
    CallArguments, DownArguments, SendArguments, SetArguments, StartArguments, StopArguments, call, down, send, set,
    start, stop,
};
pub(super) use ps::{PsArguments, ps};
pub(super) use status::{StatusArguments, status};
pub(super) use table::Table;
pub(super) use time::{PauseArguments, ResumeArguments, SpeedArguments, StepArguments, pause, resume, speed, step};
pub(super) use top::{TopArguments, top};
pub(super) use topic::{TopicArguments, topic};
