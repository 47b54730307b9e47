use std::fmt;
use std::fs::{self, File};
use std::io::{self, Write as _};

use super::sys;

/// The priority of the timer among real-time threads: in the middle, below what Linux uses for its own interrupt
/// threads.
pub(crate) const TIMER_PRIORITY: i32 = 49;
/// Priority of the spare thread: above the timer, so that it runs when the timer's thread spins.
pub(crate) const SPARE_PRIORITY: i32 = 50;

/// Error: real-time scheduling is not possible. The message names the missing permission.
#[derive(Debug)]
pub struct RealtimeError {
    what: Requirement,
    source: io::Error,
}

#[derive(Clone, Copy, Debug)]
enum Requirement {
    Scheduling,
    Memory,
}

impl fmt::Display for RealtimeError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.what {
            Requirement::Scheduling => write!(
                formatter,
                "real-time scheduling (SCHED_FIFO) is not permitted: {}. Grant the capability CAP_SYS_NICE \
                 (`sudo setcap cap_sys_nice,cap_ipc_lock+ep PROGRAM`), or allow the priority {SPARE_PRIORITY} (`ulimit -r {SPARE_PRIORITY}`, \
                 `rtprio` in /etc/security/limits.conf), or run without `--realtime`",
                self.source
            ),
            Requirement::Memory => write!(
                formatter,
                "locking memory is not permitted: {}. Grant the capability CAP_IPC_LOCK \
                 (`sudo setcap cap_sys_nice,cap_ipc_lock+ep PROGRAM`), or allow any amount (`ulimit -l unlimited`, `memlock` in \
                 /etc/security/limits.conf), or run without `--realtime`",
                self.source
            ),
        }
    }
}

impl std::error::Error for RealtimeError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        Some(&self.source)
    }
}

/// Locks the memory of the process, and makes sure that its threads may become real-time threads.
pub(crate) fn enter() -> Result<(), RealtimeError> {
    let scheduling = |source| RealtimeError { what: Requirement::Scheduling, source };
    let memory = |source| RealtimeError { what: Requirement::Memory, source };
    let thread = sys::thread_id();
    sys::set_fifo(thread, SPARE_PRIORITY).map_err(scheduling)?;
    sys::set_normal(thread).map_err(scheduling)?;
    // With a limit, later allocations would fail and end the process.
    if let Some(limit) = sys::lockable_memory()
        && !may_lock_any_memory()
    {
        return Err(memory(io::Error::other(format!("at most {} kB may be locked", limit / 1024))));
    }
    sys::lock_memory().map_err(memory)
}

/// Keeps the processors out of their deep idle states as long as the file is open: waking from those takes tens of
/// microseconds, most of the lateness of a few tasks. This is the kernel's interface for it
/// (Documentation/power/pm_qos_interface.rst).
pub(crate) fn keep_awake() -> io::Result<File> {
    let mut file = fs::OpenOptions::new().write(true).open("/dev/cpu_dma_latency")?;
    file.write_all(&0_i32.to_ne_bytes())?;
    Ok(file)
}

/// True if the process has the capability CAP_IPC_LOCK, which is number 14.
fn may_lock_any_memory() -> bool {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let effective = status.lines().find_map(|line| line.strip_prefix("CapEff:"));
    effective.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).is_some_and(|mask| mask & (1 << 14) != 0)
}
