//! Usage of one process, read from outside or by itself.

use std::fs;
use std::io;
use std::time::Duration;

/// The processor time of all threads of the process `pid` so far, to the nanosecond.
///
/// The clock is that of clock_getcpuclockid(3): the sum that getrusage(2) reports, readable for another process too.
pub(crate) fn cpu_time(pid: u32) -> io::Result<Duration> {
    let mut clock: libc::clockid_t = 0;
    // SAFETY: `clock` is a valid place for the one value that the call writes.
    let code = unsafe { libc::clock_getcpuclockid(pid.cast_signed(), &raw mut clock) };
    if code != 0 {
        return Err(io::Error::from_raw_os_error(code));
    }
    let mut time = libc::timespec { tv_sec: 0, tv_nsec: 0 };
    // SAFETY: `time` is a valid place for the one value that the call writes.
    if unsafe { libc::clock_gettime(clock, &raw mut time) } != 0 {
        return Err(io::Error::last_os_error());
    }
    Ok(Duration::new(time.tv_sec.unsigned_abs(), u32::try_from(time.tv_nsec).unwrap_or(0)))
}

/// The memory of one process.
#[derive(Clone, Copy, Default)]
pub(crate) struct Memory {
    /// Resident now, in kB.
    pub(crate) resident_kb: u64,
    /// Maximum that was ever resident, in kB.
    pub(crate) peak_kb: u64,
}

/// Reads the memory of the process `pid` (proc_pid_status(5)).
///
/// Not getrusage: its maximum survives execve, so a small program started by a large one would show the large one's.
pub(crate) fn memory(pid: u32) -> io::Result<Memory> {
    let text = fs::read_to_string(format!("/proc/{pid}/status"))?;
    let field = |name: &str| {
        let line = text.lines().find_map(|line| line.strip_prefix(name));
        line.and_then(|rest| rest.split_whitespace().next()?.parse().ok()).unwrap_or(0)
    };
    Ok(Memory { resident_kb: field("VmRSS:"), peak_kb: field("VmHWM:") })
}
