use std::sync::Arc;
use std::thread;
use std::time::Duration;

use super::engine::queue::Queue;
use super::engine::slot::Isolation;
use super::os::sys::{self, Gate};
use saoms_api::host::contain::{contained, install_hook};

#[test]
fn a_component_comes_back_after_it_behaved_and_has_to_behave_longer_each_time() {
    let mut isolation = Isolation::default();
    for needed in [100, 200, 400] {
        isolation.isolate();
        isolation.count_execution(false);
        isolation.count_execution(true);
        for execution in 1..=needed {
            assert!(isolation.active, "back after {execution} of {needed}");
            isolation.count_execution(false);
        }
        assert!(!isolation.active, "{needed}");
    }
}

#[test]
fn what_is_due_comes_by_time_and_then_by_component() {
    let mut queue = Queue::default();
    for (when, component) in [(5, 1), (3, 2), (5, 0), (9, 0), (3, 1)] {
        queue.push(when, component);
    }
    queue.retain(|when, component| (when, component) != (3, 2));
    assert_eq!(queue.earliest(), Some(3));
    let due: Vec<_> = std::iter::from_fn(|| queue.pop_due(5)).collect();
    assert_eq!(due, [(3, 1), (5, 0), (5, 1)]);
    assert_eq!(queue.len(), 1);
}

#[test]
fn a_gate_opens_for_a_wake_and_at_its_time() {
    let gate = Arc::new(Gate::default());
    let ticket = gate.ticket();
    gate.wake();
    gate.wait(ticket, None);
    gate.wait(gate.ticket(), Some(sys::monotonic()));
    let (ticket, waker) = (gate.ticket(), Arc::clone(&gate));
    let other = thread::spawn(move || {
        thread::sleep(Duration::from_millis(5));
        waker.wake();
    });
    while gate.ticket() == ticket {
        gate.wait(ticket, None);
    }
    other.join().unwrap();
    let until = sys::monotonic() + 2_000_000;
    let ticket = gate.ticket();
    while sys::monotonic() < until {
        gate.wait(ticket, Some(until));
    }
}

#[test]
fn panics_are_contained_with_message_and_place() {
    install_hook();
    assert_eq!(contained(|| 5), Ok(5));
    let text = |failure: Result<(), saoms_api::Failure>| failure.unwrap_err().to_string();
    let plain = text(contained(|| panic!("plain")));
    assert!(plain.starts_with("panicked at ") && plain.contains("tests.rs:") && plain.ends_with(": plain"), "{plain}");
    let number = 5;
    assert!(text(contained(|| panic!("number {number}"))).ends_with(": number 5"));
    let inner = text(contained(|| {
        let _ = contained(|| panic!("inner"));
        panic!("outer")
    }));
    assert!(inner.ends_with(": outer"), "{inner}");
    assert!(text(contained(|| std::panic::panic_any(5))).ends_with("panicked without a message"));
}
