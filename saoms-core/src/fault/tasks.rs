//! Faults of components: of their next execution, and of their clocks.

use std::time::Duration;

use saoms_api::{Cause, Failure};

/// A fault of one execution of a component.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum TaskFault {
    /// It takes longer by this duration: on the machine's clock, or in virtual time on that of the run. Meanwhile it is
    /// busy for callers, and its due executions are late.
    Stall(Duration),
    /// It returns an error.
    Fail,
    /// The component ends instead, and starts again after this time, or never.
    Crash { restart: Option<Duration> },
}

impl TaskFault {
    /// Lets it happen to the execution that begins.
    #[cold]
    pub(crate) fn happen(self) -> Result<(), Failure> {
        match self {
            TaskFault::Fail => Err(Failure::new("this execution fails by fault injection")),
            TaskFault::Crash { .. } => Err(Failure::new("it crashes by fault injection")),
            TaskFault::Stall(time) => {
                std::thread::sleep(time);
                Ok(())
            }
        }
    }
}

/// A clock that goes wrong.
#[derive(Clone, Copy, Debug)]
struct Drift {
    component: u32,
    /// By so many millionths too fast.
    by: i64,
    until: u64,
}

/// The faults of components that are not over.
#[derive(Debug, Default)]
pub(super) struct TaskFaults {
    /// By component, with the record of the journal that says it.
    waiting: Vec<(u32, TaskFault, Cause)>,
    /// The records of the faults of the executions that began last.
    played: Vec<(u32, Cause)>,
    drifts: Vec<Drift>,
}

const MILLION: i64 = 1_000_000;

impl TaskFaults {
    pub(super) fn add(&mut self, component: u32, fault: TaskFault, cause: Cause) {
        self.waiting.push((component, fault, cause));
    }

    pub(super) fn drift(&mut self, component: u32, by: i32, until: u64) {
        self.drifts.push(Drift { component, by: i64::from(by), until });
    }

    /// The fault of an execution of a component that begins. Each comes once.
    pub(super) fn take(&mut self, component: u32) -> Option<TaskFault> {
        self.played.retain(|(concerned, _)| *concerned != component);
        let place = self.waiting.iter().position(|(concerned, ..)| *concerned == component)?;
        let (_, fault, cause) = self.waiting.remove(place);
        self.played.push((component, cause));
        Some(fault)
    }

    /// The record of the fault of a component's last execution; none without a fault.
    pub(super) fn cause(&self, component: u32) -> Cause {
        self.played.iter().find(|(concerned, _)| *concerned == component).map(|(_, cause)| *cause).unwrap_or_default()
    }

    /// A time of a component's own clock, on that of the run.
    pub(super) fn on_run(&mut self, component: u32, time: u64, now: u64) -> u64 {
        self.drifts.retain(|drift| drift.until > now);
        let by: i64 = self.drifts.iter().filter(|drift| drift.component == component).map(|drift| drift.by).sum();
        let speed = u128::from((MILLION + by).max(1).unsigned_abs());
        u64::try_from(u128::from(time) * MILLION.unsigned_abs() as u128 / speed).unwrap_or(u64::MAX)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_fault_comes_once_and_a_clock_goes_right_again() {
        let mut faults = TaskFaults::default();
        faults.add(1, TaskFault::Fail, Cause(7));
        faults.add(1, TaskFault::Stall(Duration::from_secs(1)), Cause(8));
        assert_eq!(faults.take(2), None);
        assert_eq!(faults.take(1), Some(TaskFault::Fail));
        assert_eq!((faults.cause(1), faults.cause(2)), (Cause(7), Cause::default()));
        assert_eq!(faults.take(1), Some(TaskFault::Stall(Duration::from_secs(1))));
        assert_eq!((faults.cause(1), faults.take(1)), (Cause(8), None));
        assert_eq!(faults.cause(1), Cause::default(), "its next execution has none");
        faults.drift(1, 250_000, 100);
        assert_eq!((faults.on_run(1, 1000, 99), faults.on_run(2, 1000, 99)), (800, 1000));
        faults.drift(2, -500_000, u64::MAX);
        assert_eq!((faults.on_run(1, 1000, 100), faults.on_run(2, u64::MAX, 100)), (1000, u64::MAX));
    }
}
