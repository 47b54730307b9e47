//! The machine: its description, and its load by other work.

use std::fs;
use std::io;
use std::process::Command;
use std::time::Duration;

/// One line with the machine and the date of a result.
pub(crate) fn description() -> String {
    let cpu = fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let model = cpu
        .lines()
        .find_map(|line| line.strip_prefix("model name"))
        .map_or("unknown processor", |rest| rest.trim_start_matches([' ', '\t', ':']));
    let cores = std::thread::available_parallelism().map_or(0, usize::from);
    let kernel = fs::read_to_string("/proc/sys/kernel/osrelease").unwrap_or_default();
    let idle = fs::read_to_string("/sys/devices/system/cpu/cpuidle/current_driver").unwrap_or_default();
    let date = Command::new("date").args(["-u", "+%Y-%m-%d %H:%M UTC"]).output();
    let date = date.map(|output| String::from_utf8_lossy(&output.stdout).trim().to_owned()).unwrap_or_default();
    format!("{model}, {cores} cores, Linux {}, idle driver {}, {date}", kernel.trim(), idle.trim())
}

/// The processor time that all processes of the machine have used together since it started.
#[derive(Clone, Copy)]
pub(crate) struct Busy {
    used: Duration,
    stolen: Duration,
}

impl Busy {
    /// Reads the first line of `/proc/stat` (proc_stat(5)), which counts in ticks of 10 ms.
    pub(crate) fn now() -> io::Result<Self> {
        let text = fs::read_to_string("/proc/stat")?;
        let line = text.lines().next().unwrap_or_default();
        let ticks: Vec<u64> = line.split_whitespace().skip(1).map(|field| field.parse().unwrap_or(0)).collect();
        let tick = |index: usize| Duration::from_millis(10 * ticks.get(index).copied().unwrap_or(0));
        // user, nice, system, irq, softirq; idle and iowait (3 and 4) are no work, steal (7) is the host's.
        Ok(Self { used: tick(0) + tick(1) + tick(2) + tick(5) + tick(6), stolen: tick(7) })
    }

    /// Time that was used since `earlier`.
    pub(crate) fn used_since(&self, earlier: &Self) -> Duration {
        self.used.saturating_sub(earlier.used)
    }

    /// Time that the host took away since `earlier`.
    pub(crate) fn stolen_since(&self, earlier: &Self) -> Duration {
        self.stolen.saturating_sub(earlier.stolen)
    }
}
