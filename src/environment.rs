//! What libraries read from the environment alone.

use std::env;

/// Settings of libraries that plugins bring, by their variables. A user's own ones count.
///
/// Zenoh reads the network with two threads, one of which wakes the other for each message. One is enough for what a
/// fleet says, and a message takes a tenth less time with it ([benchmarks](../benches/README.md)).
const SETTINGS: [(&str, &str); 1] = [("ZENOH_RUNTIME", "(rx: (worker_threads: 1))")];

/// Sets what the user did not set.
///
/// # Safety
/// This process has no other thread yet.
pub(crate) unsafe fn prepare() {
    for (variable, value) in SETTINGS {
        if env::var_os(variable).is_none() {
            // SAFETY: no other thread reads or writes the environment meanwhile.
            unsafe { env::set_var(variable, value) };
        }
    }
}
