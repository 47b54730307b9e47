//! What a thread waited for.

/// Number of times that the calling thread gave up the processor to wait for something. That the system took it for
/// another thread does not count.
pub(super) fn waits() -> i64 {
    // SAFETY: all of the struct are numbers, for which zero is a value.
    let mut usage: libc::rusage = unsafe { std::mem::zeroed() };
    // SAFETY: `usage` is valid and writable for the length of the call, which keeps no pointer to it.
    unsafe { libc::getrusage(libc::RUSAGE_THREAD, &raw mut usage) };
    usage.ru_nvcsw
}
