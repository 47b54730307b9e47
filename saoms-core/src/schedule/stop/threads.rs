use std::collections::VecDeque;
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::thread;
use std::time::Duration;

use saoms_api::StopFunction;

use super::{RegisteredStop, Stops, lock, release};

/// Greatest number of threads: as many functions can hang before others have to wait.
const THREADS: usize = 64;

/// The threads that call and release functions which stop hardware. They end when nothing is left to do.
#[derive(Default)]
pub(super) struct StopThreads {
    state: Mutex<State>,
    returned: Condvar,
}

#[derive(Default)]
struct State {
    requested: VecDeque<Arc<RegisteredStop>>,
    /// Functions whose state is to be freed, with the names of their components.
    released: Vec<(Arc<str>, StopFunction)>,
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
            // Without a thread it stays requested: the next one calls it, or `wait` names it.
            state.start_thread(stops);
        }
    }

    /// Frees the state of a function soon.
    pub(super) fn release(&self, stops: &Arc<Stops>, name: &Arc<str>, function: StopFunction) {
        let mut state = lock(&self.state);
        state.start_thread(stops);
        if state.threads > 0 {
            return state.released.push((Arc::clone(name), function));
        }
        drop(state);
        release(function);
    }

    /// Waits until all that were requested have returned; gives the components of those that have not.
    pub(super) fn wait(&self, patience: Duration) -> Vec<Arc<str>> {
        let is_busy = |state: &mut State| state.threads > 0;
        let waited = self.returned.wait_timeout_while(lock(&self.state), patience, is_busy);
        let state = waited.unwrap_or_else(PoisonError::into_inner).0;
        let requested = state.requested.iter().map(|one| &one.name).chain(state.released.iter().map(|(name, _)| name));
        let mut names: Vec<_> = state.running.iter().chain(requested).map(Arc::clone).collect();
        names.sort();
        names.dedup();
        names
    }
}

impl State {
    /// Starts one more thread, unless there are enough or the system gives none.
    fn start_thread(&mut self, stops: &Arc<Stops>) {
        let stops = Arc::clone(stops);
        if self.threads < THREADS
            && thread::Builder::new().name("saoms-stop".to_owned()).spawn(move || work(&stops)).is_ok()
        {
            self.threads += 1;
        }
    }

    /// What is to be done next.
    fn next(&mut self) -> Option<Task> {
        let stop = self.requested.pop_front().map(Task::Stop);
        stop.or_else(|| self.released.pop().map(|(name, function)| Task::Release(name, function)))
    }
}

/// What a thread does, without the lock: it is code of a component.
enum Task {
    Stop(Arc<RegisteredStop>),
    Release(Arc<str>, StopFunction),
}

/// Calls requested functions and frees released ones until there are no more.
fn work(stops: &Arc<Stops>) {
    let threads = &stops.threads;
    let mut state = lock(&threads.state);
    while let Some(task) = state.next() {
        let name = match &task {
            Task::Stop(function) => Arc::clone(&function.name),
            Task::Release(name, _) => Arc::clone(name),
        };
        state.running.push(Arc::clone(&name));
        drop(state);
        match task {
            Task::Stop(function) => {
                stops.call(&function);
                function.release_here();
            }
            Task::Release(_, function) => release(function),
        }
        state = lock(&threads.state);
        if let Some(place) = state.running.iter().position(|running| *running == name) {
            state.running.swap_remove(place);
        }
    }
    state.threads -= 1;
    threads.returned.notify_all();
}
