//! The status of a running fleet.

use std::time::Duration;

use saoms_api::Time;
use saoms_core::schedule::{RunningFleet, Settings};
use saoms_core::status::{ComponentState, ComponentStatus, FleetPhase};
use serde_json::json;

use crate::fleet::{real, run, simulated, start};

/// A fleet that runs, in virtual time until it has reached these milliseconds.
fn running(fleet: &str, settings: Settings, until: u64) -> RunningFleet {
    let (fleet, _) = start(fleet, settings);
    let fleet = fleet.unwrap();
    fleet.run_until(Time::START + Duration::from_millis(until));
    fleet
}

/// Each component with its state, its executions, and what it says.
fn lines(components: &[ComponentStatus]) -> Vec<String> {
    let line = |one: &ComponentStatus| {
        let (name, state, executions) = (&one.report.name, one.state.name(), one.report.executions);
        let (waits, values) = (one.waits_for.as_deref().unwrap_or("-"), json!(*one.values));
        format!("{name} {state} {executions} {waits} {values}")
    };
    components.iter().map(line).collect()
}

const FLEET: &str = "A actor period=10 waits=[parcels]
B actor period=20 startup=false
C actor period=10 each=[3: fail]
E callee";

#[test]
fn components_are_shown_with_their_states_and_what_they_say() {
    let fleet = running(FLEET, simulated(1000), 100);
    let status = fleet.handle().status();
    assert_eq!((status.time_s, status.phase), (0.1, FleetPhase::Running));
    assert_eq!(
        lines(&status.components),
        [
            "A running 10 parcels {\"waits\":\"parcels\"}",
            "B idle 0 - {}",
            "C failed 4 - {}",
            "E running 0 - {\"waits\":\"\"}",
        ]
    );
    assert_eq!((status.components[0].values_s, status.components[1].values_s), (Some(0.1), None));
    let written = serde_json::to_value(&status).unwrap();
    assert_eq!(written["components"][0]["executions"], 10);
    assert_eq!(written["components"][0]["state"], "running");
    let _ = fleet.run_to_end();
}

#[test]
fn a_run_does_not_change_by_being_asked() {
    let settings = || Settings { limit: Some(Duration::from_millis(300)), ..Settings::simulated(7) };
    let fleet = "A actor period=10 publishes=TALK each=[say hello]\nB actor period=15 subscribes=TALK each=[hear]";
    let asked = running(fleet, settings(), 0);
    let handle = asked.handle();
    for until in [50, 105, 110, 250] {
        asked.run_until(Time::START + Duration::from_millis(until));
        // So that all are asked again.
        std::thread::sleep(Duration::from_millis(110));
        assert_eq!(handle.status().components[0].values_s, Some(until as f64 / 1000.0));
    }
    let (report, _) = run(fleet, settings());
    assert_eq!(asked.run_to_end().trace_hash, report.trace_hash);
}

#[test]
fn a_component_that_hangs_is_shown_as_it_was_and_the_others_answer() {
    let fleet = running("A actor period=10 each=[3: sleep 700]\nB actor period=10 waits=[news]", real(2000), 100);
    let handle = fleet.handle();
    let status = handle.status();
    assert_eq!(status.components[0].state, ComponentState::Running);
    assert!(status.components[0].in_code_s.unwrap() > 0.0, "{status:?}");
    assert_eq!(status.components[0].values_s, None);
    assert_eq!(status.components[1].waits_for.as_deref(), Some("news"));
    fleet.run_until(Time::START + Duration::from_millis(1200));
    // It runs on a worker thread from now on, and is asked there.
    let status = handle.status();
    assert!(status.components[0].values_s.unwrap() > 0.7, "{status:?}");
    // Beside other work it may be in its next execution, for a moment.
    assert!(status.components[0].in_code_s.is_none_or(|time| time < 0.5), "{status:?}");
    let _ = fleet.run_to_end();
}
