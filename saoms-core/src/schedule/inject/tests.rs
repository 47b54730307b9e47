use std::sync::Arc;
use std::thread;

use super::{Due, Injections, add_commits};
use crate::schedule::engine::RunPhase;
use crate::schedule::engine::ending::EndCause;
use crate::schedule::os::clock::Clock;
use crate::schedule::settings::Settings;
use crate::schedule::shared::Shared;

/// The batch of none of the fleet: a component that is not there is of no use to a commit.
const NOBODY: u32 = u32::MAX;

#[test]
fn commits_keep_their_order_while_messages_wait_for_room() {
    let mut injections = Injections::default();
    injections.add(1, Due::Settled);
    injections.commit_at(1, 7, 1);
    injections.postpone(5, 20);
    injections.commit_at(6, 8, 2);
    assert_eq!(injections.take_commits(), [(7, 1), (8, 2)]);
    assert_eq!(injections.earliest(), Some(20));
}

#[test]
fn no_commit_is_left_behind_when_the_run_ends_while_it_comes() {
    let shared = Arc::new(Shared::new(Settings::default(), Clock::real(), Vec::new()));
    shared.lock().phase = RunPhase::Running;
    let batches: Vec<(u32, u64)> = (1..=200_000).map(|number| (NOBODY, number)).collect();
    let own = Arc::clone(&shared);
    let store = thread::spawn(move || add_commits(&own, &batches));
    loop {
        let mut engine = shared.lock();
        if engine.injections.commits > 0 {
            engine.begin_stop(EndCause::Done, 0);
            break;
        }
        drop(engine);
        thread::yield_now();
    }
    store.join().unwrap();
    assert_eq!(shared.lock().injections.take_commits(), []);
}
