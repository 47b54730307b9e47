use std::time::Duration;

use crate::fault::TimedFault;

/// Settings of a run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Settings {
    /// Clock that the components see.
    pub clock: ClockKind,
    /// The seed of all chance.
    pub seed: u64,
    /// Latest end of the run, in its own time. Executions due at that very instant are not run any more.
    pub limit: Option<Duration>,
    /// Budget of an execution: after it, another thread takes over the other components. At least 10 us. Real time
    /// only.
    pub budget: Duration,
    /// Maximum delay that the kernel may add to the timer's sleeps to save energy. It should be small against the
    /// shortest period; 1 ns is the least. Real time only, and without effect under `realtime`.
    pub timer_slack: Duration,
    /// True if the timer runs under `SCHED_FIFO`, with all memory locked and, where that is permitted, the processors
    /// kept out of their deep idle states. Real time only. It is for fleets that leave the processor much time: one
    /// that never pauses loses its priority, and the kernel lets real-time threads have 95 % of the time at most.
    pub realtime: bool,
    /// Maximum time for the shutdown of a component, since the last one that ended; one that takes longer is abandoned.
    pub grace: Duration,
    /// Maximum duration of an execution in virtual time, on the machine's clock; beyond it the run ends as failed. At
    /// least 10 ms.
    pub virtual_watchdog: Duration,
    /// Time in which nothing happens, although work is left, after which components are asked what they wait for. If
    /// all of them wait, the run stands still: that is told, or ends it.
    pub quiet: Duration,
    /// True if a standstill ends a run in virtual time that has a [`limit`](Settings::limit), too. One without a limit
    /// it ends in any case.
    pub ends_at_standstill: bool,
    /// Number of journal records in memory, divided evenly among the components; each keeps its newest 128 at least.
    /// Records that are older are overwritten and counted.
    pub journal: usize,
    /// In virtual time, the time from the end of an execution until what it [keeps](saoms_api::Context::keep) is
    /// committed, as a disk takes it.
    pub commit_delay: Duration,
    /// Longest time for which the end of a run waits for what [belongs together](super::Handle::together).
    pub together: Duration,
    /// Faults that are put into the run on purpose.
    pub faults: Vec<TimedFault>,
}

/// Clock of a fleet.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ClockKind {
    /// The time of the machine.
    #[default]
    Real,
    /// A time that jumps from one due execution to the next: the same seed gives the same run, as fast as the machine
    /// goes.
    Virtual,
}

impl Default for Settings {
    fn default() -> Settings {
        Settings {
            clock: ClockKind::Real,
            seed: 0,
            limit: None,
            budget: Duration::from_millis(1),
            timer_slack: Duration::from_micros(50),
            realtime: false,
            grace: Duration::from_secs(2),
            virtual_watchdog: Duration::from_secs(10),
            quiet: Duration::from_secs(60),
            ends_at_standstill: false,
            journal: 65_536,
            commit_delay: Duration::from_millis(5),
            together: Duration::from_secs(1),
            faults: Vec::new(),
        }
    }
}

impl Settings {
    /// The usual settings in virtual time with this seed.
    pub fn simulated(seed: u64) -> Settings {
        Settings { clock: ClockKind::Virtual, seed, ..Settings::default() }
    }
}

impl Settings {
    /// The settings with values raised to their minimum.
    pub(super) fn checked(mut self) -> Settings {
        self.budget = self.budget.max(Duration::from_micros(10));
        self.virtual_watchdog = self.virtual_watchdog.max(Duration::from_millis(10));
        self
    }
}

/// Nanoseconds, as times are counted; more than 584 years is without end.
pub(super) fn nanos(duration: Duration) -> u64 {
    u64::try_from(duration.as_nanos()).unwrap_or(u64::MAX)
}
