use std::io;
use std::sync::mpsc;
use std::thread::{Builder, JoinHandle};

/// Starts a thread, and waits until its code runs: what the system needs for that cannot be had any more where code of
/// a library lowers the limits of the process, or holds the loader's lock for ever.
///
/// # Errors
/// The system cannot create a thread.
pub fn start_thread<T: Send + 'static>(
    name: &str,
    code: impl FnOnce() -> T + Send + 'static,
) -> io::Result<JoinHandle<T>> {
    let (runs, has_begun) = mpsc::channel();
    let begin = move || {
        // Whoever started it waits.
        let _ = runs.send(());
        code()
    };
    let thread = Builder::new().name(name.to_owned()).spawn(begin)?;
    has_begun.recv().map_err(io::Error::other)?;
    Ok(thread)
}
