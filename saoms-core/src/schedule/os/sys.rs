//! The system calls that the standard library does not offer: the monotonic clock in nanoseconds, a sleep until an
//! absolute time that another thread can end, scheduling classes and locked memory. All the `unsafe` of the scheduler
//! is here.

use std::io;
use std::ptr;
use std::sync::atomic::{AtomicU32, Ordering};

/// `CLOCK_MONOTONIC` in nanoseconds.
pub(crate) fn monotonic() -> u64 {
    let mut now = libc::timespec { tv_sec: 0, tv_nsec: 0 };
    // SAFETY: `now` is a valid, writable timespec for the length of the call, which keeps no pointer to it.
    unsafe { libc::clock_gettime(libc::CLOCK_MONOTONIC, &raw mut now) };
    now.tv_sec as u64 * 1_000_000_000 + now.tv_nsec as u64
}

/// The local date and time of day in nanoseconds since 1970-01-01 00:00.
pub(crate) fn local_date() -> u64 {
    let mut now = libc::timespec { tv_sec: 0, tv_nsec: 0 };
    // SAFETY: `now` is a valid, writable timespec for the length of the call, which keeps no pointer to it.
    unsafe { libc::clock_gettime(libc::CLOCK_REALTIME, &raw mut now) };
    // SAFETY: all of the struct are numbers and a pointer, for which zero is a value.
    let mut local: libc::tm = unsafe { std::mem::zeroed() };
    // SAFETY: both point to valid values for the length of the call, which keeps neither pointer. It reads the
    // environment, as does every caller of `std::env`; nothing in this process writes to it.
    unsafe { libc::localtime_r(&raw const now.tv_sec, &raw mut local) };
    (now.tv_sec + local.tm_gmtoff) as u64 * 1_000_000_000 + now.tv_nsec as u64
}

/// Gate at which one thread sleeps until an absolute time, and others wake it.
///
/// A futex wait with an absolute deadline has no drift, respects the thread's timer slack, and costs nothing to those
/// who do not wake.
#[derive(Debug, Default)]
pub(crate) struct Gate(AtomicU32);

impl Gate {
    /// The present state; a [`wake`](Gate::wake) after this ends a following [`wait`](Gate::wait) with it at once.
    pub(crate) fn ticket(&self) -> u32 {
        self.0.load(Ordering::Acquire)
    }

    /// Sleeps until the gate is woken after `ticket` was drawn, or `CLOCK_MONOTONIC` has reached `deadline` (`None`:
    /// without end). May return early.
    pub(crate) fn wait(&self, ticket: u32, deadline: Option<u64>) {
        let until = deadline.map(|nanos| libc::timespec {
            tv_sec: (nanos / 1_000_000_000) as libc::time_t,
            tv_nsec: (nanos % 1_000_000_000) as libc::c_long,
        });
        let until_pointer = until.as_ref().map_or(ptr::null(), ptr::from_ref);
        // SAFETY: the futex word lives as long as `self`; the timespec, where there is one, outlives the call; the
        // kernel keeps neither.
        unsafe {
            libc::syscall(
                libc::SYS_futex,
                self.0.as_ptr(),
                libc::FUTEX_WAIT_BITSET | libc::FUTEX_PRIVATE_FLAG,
                ticket,
                until_pointer,
                ptr::null::<u32>(),
                libc::FUTEX_BITSET_MATCH_ANY,
            );
        }
    }

    /// Ends the waits at this gate. Only an atomic operation and a system call, so that a signal handler may call it.
    pub(crate) fn wake(&self) {
        self.0.fetch_add(1, Ordering::Release);
        // SAFETY: the futex word lives as long as `self`; waking touches no other memory.
        unsafe {
            libc::syscall(
                libc::SYS_futex,
                self.0.as_ptr(),
                libc::FUTEX_WAKE | libc::FUTEX_PRIVATE_FLAG,
                libc::c_int::MAX,
            );
        }
    }
}

/// The kernel's number of the calling thread.
pub(crate) fn thread_id() -> i32 {
    // SAFETY: gettid takes nothing and cannot fail.
    unsafe { libc::gettid() }
}

/// Sets the maximum delay that the kernel may add to the sleeps of the calling thread, to join them with others. Zero
/// would mean the default, so the minimum is 1 ns. Real-time threads have no slack.
pub(crate) fn set_timer_slack(nanos: u64) {
    let nanos = libc::c_ulong::try_from(nanos.max(1)).unwrap_or(libc::c_ulong::MAX);
    // SAFETY: PR_SET_TIMERSLACK takes one integer and concerns the calling thread alone.
    unsafe { libc::prctl(libc::PR_SET_TIMERSLACK, nanos, 0, 0, 0) };
}

/// Gives a thread of this process the scheduling class `SCHED_FIFO` with this priority.
pub(crate) fn set_fifo(thread: i32, priority: i32) -> io::Result<()> {
    set_scheduler(thread, libc::SCHED_FIFO, priority)
}

/// Takes real-time priority from a thread of this process.
pub(crate) fn set_normal(thread: i32) -> io::Result<()> {
    set_scheduler(thread, libc::SCHED_OTHER, 0)
}

fn set_scheduler(thread: i32, policy: libc::c_int, priority: i32) -> io::Result<()> {
    let parameters = libc::sched_param { sched_priority: priority };
    // SAFETY: `parameters` is valid for the length of the call; a thread number that is gone is an error, not a fault.
    match unsafe { libc::sched_setscheduler(thread, policy, &raw const parameters) } {
        0 => Ok(()),
        _ => Err(io::Error::last_os_error()),
    }
}

/// Locks the memory of the process, present and future, so that no page fault delays an execution.
pub(crate) fn lock_memory() -> io::Result<()> {
    // SAFETY: mlockall takes flags only.
    match unsafe { libc::mlockall(libc::MCL_CURRENT | libc::MCL_FUTURE) } {
        0 => Ok(()),
        _ => Err(io::Error::last_os_error()),
    }
}

/// Number of bytes that the process may lock; `None` is without limit.
pub(crate) fn lockable_memory() -> Option<u64> {
    let mut limit = libc::rlimit { rlim_cur: 0, rlim_max: 0 };
    // SAFETY: `limit` is a valid, writable rlimit for the length of the call.
    unsafe { libc::getrlimit(libc::RLIMIT_MEMLOCK, &raw mut limit) };
    (limit.rlim_cur != libc::RLIM_INFINITY).then_some(limit.rlim_cur)
}
