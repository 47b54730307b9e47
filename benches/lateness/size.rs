//! One size of the measurement: a number of tasks and their period.

use std::fmt;
use std::str::FromStr;
use std::time::Duration;

/// A number of tasks of one period, their phases spread evenly over it.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) struct Size {
    pub(crate) tasks: u32,
    pub(crate) period: Duration,
}

impl Size {
    /// Time from the common start to the first start of task `index`.
    pub(crate) fn delay(&self, index: u32) -> Duration {
        self.period * index / self.tasks
    }

    /// Executions that are due in a time that is a whole number of periods long.
    pub(crate) fn due_in(&self, time: Duration) -> u64 {
        u64::from(self.tasks) * u64::try_from(time.as_nanos() / self.period.as_nanos()).unwrap_or(u64::MAX)
    }

    /// `time` rounded up to a whole number of periods, so that each task has the same number of executions in it.
    pub(crate) fn whole_periods(&self, time: Duration) -> Duration {
        let periods = time.as_nanos().div_ceil(self.period.as_nanos());
        self.period * u32::try_from(periods).unwrap_or(u32::MAX)
    }
}

impl fmt::Display for Size {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let us = self.period.as_micros();
        if us.is_multiple_of(1000) {
            write!(f, "{}x{}ms", self.tasks, us / 1000)
        } else {
            write!(f, "{}x{us}us", self.tasks)
        }
    }
}

impl FromStr for Size {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || format!("`{text}` is not a size: expected TASKSxPERIOD with ms or us, such as 100x10ms");
        let (tasks, period) = text.split_once('x').ok_or_else(wrong)?;
        let (number, unit) = match period.strip_suffix("ms") {
            Some(number) => (number, 1000),
            None => (period.strip_suffix("us").ok_or_else(wrong)?, 1),
        };
        let tasks: u32 = tasks.parse().map_err(|_| wrong())?;
        let number: u64 = number.parse().map_err(|_| wrong())?;
        if tasks == 0 || number == 0 {
            return Err(wrong());
        }
        Ok(Self { tasks, period: Duration::from_micros(number.saturating_mul(unit)) })
    }
}
