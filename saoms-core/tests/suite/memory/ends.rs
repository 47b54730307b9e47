//! Ends that a memory goes through: of a run while something belongs together, of a component that an operator stops,
//! and of a program while a component is in its delay.

use std::thread::sleep;
use std::time::Duration;

use saoms_core::schedule::{Handle, InjectError, InjectedContent, Injection, Order, Settings};
use saoms_core::status::FleetPhase;
use serde_json::json;

use super::apart::copy;
use super::{FLEET, behind, run};
use crate::fleet::real;

const PATIENCE: Duration = Duration::from_secs(10);

fn say_number(handle: &Handle, value: u64) -> Result<(), InjectError> {
    let content = InjectedContent::Fields(json!({"value": value}));
    handle.inject(Injection { topic: "NUMBERS".to_owned(), content, at: None, text: format!("{value}") })
}

/// Settings of a run whose end waits for so many milliseconds for what belongs together.
fn waiting(milliseconds: u64) -> Settings {
    Settings { together: Duration::from_millis(milliseconds), ..real(20_000) }
}

#[test]
fn what_belongs_together_is_together_at_the_end_of_a_run() {
    let folder = tempfile::tempdir().unwrap();
    run(FLEET, waiting(60_000), folder.path(), |handle| {
        let together = handle.together();
        assert!(!together.is_too_late());
        say_number(handle, 1).unwrap();
        handle.stop();
        while handle.phase() == FleetPhase::Running {
            sleep(Duration::from_millis(1));
        }
        // The last moment is still to come, and has the rest, too.
        sleep(Duration::from_millis(20));
        say_number(handle, 2).unwrap();
        let [component, property, value] = ["T", "mood", "late"].map(str::to_owned);
        let set = || Order::Set { component: component.clone(), property: property.clone(), value: value.clone() };
        handle.order(set(), None).unwrap();
        handle.set_counter("numbers", 2);
        drop(together);
        let late = handle.together();
        assert!(late.is_too_late());
        assert!(say_number(handle, 3).is_err() && handle.order(set(), None).is_err());
        handle.commit(PATIENCE).unwrap();
    });
    run(FLEET, real(60), folder.path(), |handle| assert_eq!(handle.counter("numbers"), 2));
    let (_, told) = run(FLEET, real(60), folder.path(), |_| {});
    assert!(told.contains("[1, 2]"), "{told}");
    assert!(behind(&told, "T: has said ").ends_with(", late"), "{told}");
}

#[test]
fn a_run_ends_without_what_is_never_complete() {
    let folder = tempfile::tempdir().unwrap();
    run(FLEET, waiting(20), folder.path(), |handle| {
        handle.set_counter("numbers", 1);
        handle.commit(PATIENCE).unwrap();
        let _together = handle.together();
        say_number(handle, 2).unwrap();
        handle.set_counter("numbers", 2);
        handle.stop();
        let told = handle.commit(PATIENCE).unwrap_err().to_string();
        assert!(told.contains("the run ended while something that belongs together was not complete"), "{told}");
    });
    run(FLEET, real(60), folder.path(), |handle| assert_eq!(handle.counter("numbers"), 1));
    let (_, told) = run(FLEET, real(60), folder.path(), |_| {});
    assert!(told.contains("[]") && !told.contains("gap"), "{told}");
}

#[test]
fn who_was_stopped_has_its_last_word_in_the_next_program() {
    let folder = tempfile::tempdir().unwrap();
    let fleet = "A actor period=5 publishes=TALK last=[say 1]\nH hearer period=3";
    let mut crash = None;
    run(fleet, real(20_000), folder.path(), |handle| {
        handle.pause().unwrap();
        let stop = Order::Stop { component: "A".to_owned() };
        handle.order(stop, None).unwrap().wait(PATIENCE).unwrap();
        handle.commit(PATIENCE).unwrap();
        assert!(!handle.is_running("A").unwrap());
        // Answered and committed, and its code for the end has not run.
        crash = Some(copy(folder.path()));
        handle.stop();
    });
    let crash = crash.unwrap();
    // It is still paused.
    run(fleet, real(100), crash.path(), |handle| handle.resume().unwrap());
    let (report, told) = run(fleet, real(60), crash.path(), |handle| assert!(!handle.is_running("A").unwrap()));
    assert!(behind(&told, "H: has heard up to ").starts_with('1') && !told.contains("gap"), "{told}");
    assert_eq!(crate::fleet::of(&report, "A").executions, 0);
}

#[test]
fn what_nobody_had_read_is_heard_again_after_a_failure_in_the_next_program() {
    let folder = tempfile::tempdir().unwrap();
    let fleet = "N patient period=3 restart=1ms/5";
    let mut crash = None;
    run(fleet, real(20_000), folder.path(), |handle| {
        handle.pause().unwrap();
        say_number(handle, 42).unwrap();
        handle.commit(PATIENCE).unwrap();
        crash = Some(copy(folder.path()));
        handle.stop();
    });
    let (_, told) = run(fleet, real(100), crash.unwrap().path(), |handle| handle.resume().unwrap());
    assert!(told.contains("it is ill"), "{told}");
    assert_eq!(told.matches("N: has heard 42").count(), 1, "{told}");
}

#[test]
fn who_is_started_again_while_it_ends_runs_in_the_next_program() {
    let folder = tempfile::tempdir().unwrap();
    let fleet = "A actor period=5 last=[log ends; sleep 400]\nH hearer period=3";
    let mut crash = None;
    run(fleet, real(20_000), folder.path(), |handle| {
        // It is over before it is started again.
        let order = |order: Order| handle.order(order, None).unwrap().wait(PATIENCE).unwrap();
        let start =
            |lasting: u64| Order::Start { component: "A".to_owned(), lasting: Some(Duration::from_millis(lasting)) };
        order(start(1));
        while handle.is_running("A").unwrap() {
            sleep(Duration::from_millis(1));
        }
        order(start(60_000));
        handle.commit(PATIENCE).unwrap();
        crash = Some(copy(folder.path()));
        handle.stop();
    });
    run(fleet, real(50), crash.unwrap().path(), |handle| assert!(handle.is_running("A").unwrap()));
}

#[test]
fn who_has_begun_is_not_in_its_delay_any_more() {
    let folder = tempfile::tempdir().unwrap();
    let fleet = "D teller period=3600000 delay=40\nH hearer period=3";
    let (report, told) = run(fleet, real(20_000), folder.path(), |handle| {
        while handle.status().components.iter().any(|one| one.report.name == "D" && one.report.executions == 0) {
            sleep(Duration::from_millis(1));
        }
        handle.stop();
    });
    assert_eq!(crate::fleet::of(&report, "D").executions, 1, "{told}");
    for _ in 0..3 {
        // Its next execution is an hour later.
        let (report, told) = run(fleet, real(100), folder.path(), |_| {});
        assert_eq!(crate::fleet::of(&report, "D").executions, 0, "{told}");
    }
}

#[test]
fn a_component_goes_on_with_the_rest_of_its_delay() {
    let folder = tempfile::tempdir().unwrap();
    let fleet = "D actor period=5 delay=600 each=[0: time]\nT teller period=2";
    let (report, told) = run(fleet, real(20), folder.path(), |_| {});
    assert!(!told.contains("due"), "{told}");
    let first = report.time_s;
    let (report, told) = run(fleet, real(20), folder.path(), |_| {});
    assert!(!told.contains("due") && report.time_s > first, "{told}");
    let (_, told) = run(fleet, real(20_000), folder.path(), |handle| {
        while handle.status().components.iter().any(|one| one.report.name == "D" && one.report.executions == 0) {
            sleep(Duration::from_millis(5));
        }
        handle.stop();
    });
    let due: f64 = behind(&told, " due ").split(' ').next().unwrap().parse().unwrap();
    assert!(due < report.time_s + 0.6, "it waits no longer than it would have: {told}");
    // With a shorter delay it waits for that.
    let folder = tempfile::tempdir().unwrap();
    run(&fleet.replace("600", "600000"), real(20), folder.path(), |_| {});
    let (_, told) = run(fleet, real(20_000), folder.path(), |handle| {
        while handle.status().components.iter().any(|one| one.report.name == "D" && one.report.executions == 0) {
            sleep(Duration::from_millis(5));
        }
        handle.stop();
    });
    assert!(told.contains(" due "), "{told}");
}
