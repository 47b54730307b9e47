//! Sockets of fleets that start and end while others look for them.

use std::process;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;

use saoms_control::{Listener, default_socket, running};

#[test]
fn a_socket_is_not_taken_for_that_of_a_program_that_has_ended_while_it_is_made() {
    let path = default_socket("made", process::id());
    let has_ended = AtomicBool::new(false);
    thread::scope(|scope| {
        scope.spawn(|| {
            while !has_ended.load(Ordering::Relaxed) {
                running();
            }
        });
        let made = (0..10_000).filter(|_| Listener::bind(&path).is_ok_and(|_listener| path.exists())).count();
        has_ended.store(true, Ordering::Relaxed);
        assert_eq!(made, 10_000);
    });
}
