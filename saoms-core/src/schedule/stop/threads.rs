use std::collections::VecDeque;
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::thread;
use std::time::Duration;

use super::{RegisteredStop, Stops, lock};

/// Greatest number of threads: as many functions can hang before others have to wait.
const THREADS: usize = 64;

/// The threads that call functions which stop hardware. They end when nothing is left to do.
#[derive(Default)]
pub(super) struct StopThreads {
    state: Mutex<State>,
    returned: Condvar,
}

#[derive(Default)]
struct State {
    requested: VecDeque<Arc<RegisteredStop>>,
    /// Names of the components whose functions run.
    running: Vec<Arc<str>>,
    threads: usize,
}

impl StopThreads {
    /// Calls these functions soon. One that is requested again before it has begun is called once.
    pub(super) fn request(&self, stops: &Arc<Stops>, functions: &[Arc<RegisteredStop>]) {
        let mut state = lock(&self.state);
        for function in functions {
            if state.requested.iter().any(|requested| Arc::ptr_eq(requested, function)) {
                continue;
            }
            state.requested.push_back(Arc::clone(function));
            let stops = Arc::clone(stops);
            // Without a thread it stays requested: the next one calls it, or `wait` names it.
            if state.threads < THREADS
                && thread::Builder::new().name("saoms-stop".to_owned()).spawn(move || work(&stops)).is_ok()
            {
                state.threads += 1;
            }
        }
    }

    /// Waits until all that were requested have returned; gives the components of those that have not.
    pub(super) fn wait(&self, patience: Duration) -> Vec<Arc<str>> {
        let is_busy = |state: &mut State| state.threads > 0;
        let waited = self.returned.wait_timeout_while(lock(&self.state), patience, is_busy);
        let state = waited.unwrap_or_else(PoisonError::into_inner).0;
        let requested = state.requested.iter().map(|one| &one.name);
        let mut names: Vec<_> = state.running.iter().chain(requested).map(Arc::clone).collect();
        names.sort();
        names.dedup();
        names
    }
}

/// Calls requested functions until there are no more.
fn work(stops: &Arc<Stops>) {
    let threads = &stops.threads;
    let mut state = lock(&threads.state);
    while let Some(function) = state.requested.pop_front() {
        let name = Arc::clone(&function.name);
        state.running.push(Arc::clone(&name));
        drop(state);
        stops.call(&function);
        // Without the lock: the last owner frees the state, which is code of the component, too.
        drop(function);
        state = lock(&threads.state);
        if let Some(place) = state.running.iter().position(|running| *running == name) {
            state.running.swap_remove(place);
        }
    }
    state.threads -= 1;
    threads.returned.notify_all();
}
