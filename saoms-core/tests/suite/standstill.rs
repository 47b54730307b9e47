//! Fleets in which nothing happens although work is left.

use std::time::Duration;

use saoms_core::schedule::Settings;

use serde_json::json;

use crate::fault::faults as faults_of;
use crate::fleet::{check, outcome, real, run, simulated, start};

/// The outcome and the diary of a fleet that runs without a limit.
fn endless(fleet: &str) -> (String, String) {
    let (fleet, diary) = start(fleet, Settings::simulated(7));
    (outcome(&fleet.unwrap().run_to_end()), diary.lines())
}

const OPEN: &str = "A actor period=10 each=[0: open] waits=[parcels]";

#[test]
fn a_run_in_which_nothing_can_happen_any_more_ends_and_says_who_waits_for_what() {
    let fleet = format!(
        "{OPEN}\nB actor period=20 delay=400 waits=[news]\nC actor period=10 waits=[news]\nD actor startup=false\nE callee"
    );
    let told = "nothing has happened since 0.000 s, and nothing more can: `A` waits for parcels; `D` is not started; `B` and 1 more wait for news";
    let (outcome, diary) = endless(&fleet);
    assert_eq!(outcome, format!("Incomplete after 60 s\n- {told}"));
    assert_eq!(diary, "");
}

#[test]
fn what_may_still_happen_keeps_a_run_going() {
    // B is silent for hours, and does not say that it waits: that is told once.
    let (outcome, diary) = endless(
        "A actor period=60000 each=[0: open; 201: done] waits=[parcels]
         B actor period=60000 each=[100: say one; 200: say two] publishes=TALK",
    );
    assert_eq!(outcome, "Done after 12060 s");
    assert_eq!(diary, "[3600.000 s] nothing has happened since 0.000 s: `A` waits for parcels\n");
}

#[test]
fn with_a_limit_a_standstill_is_told_and_the_run_goes_on() {
    check(
        OPEN,
        90_000,
        "[60.000 s] nothing has happened since 0.000 s: `A` waits for parcels
         Elapsed after 90 s",
    );
    check("A actor period=10 waits=[parcels]\nB actor period=10 waits=[news]", 90_000, "Elapsed after 90 s");
    let (report, _) = run(OPEN, simulated(90_000));
    let waiting = json!([{"component": "A", "runs": true, "waits_for": "parcels"}]);
    assert_eq!(
        serde_json::to_value(report.standstill).unwrap(),
        json!({"since_s": 0.0, "ends": false, "waiting": waiting})
    );
}

#[test]
fn a_standstill_ends_a_run_with_a_limit_where_the_settings_say_so() {
    let ending = |limit: u64| Settings { ends_at_standstill: true, ..simulated(limit) };
    let told = "nothing has happened since 0.000 s, and nothing more can: `A` waits for parcels";
    assert_eq!(outcome(&run(OPEN, ending(90_000)).0), format!("Incomplete after 60 s\n- {told}"));
    assert_eq!(outcome(&run(OPEN, ending(50_000)).0), "Elapsed after 50 s");
}

#[test]
fn a_fault_that_ends_or_is_still_to_come_may_let_a_fleet_go_on() {
    let fleet = "A actor period=10 publishes=TALK each=[0: open] waits=[parcels]
                 B actor period=10 subscribes=TALK each=[hear] waits=[news]";
    for (faults, end) in [
        (&["0 for 200s part A from B"][..], 260),
        (&["100000 for 30s lose 20 %"], 190),
        (&["100000 crash B restart 50s"], 210),
        // One that never ends heals nothing.
        (&["0 part A from B"], 60),
    ] {
        let settings = Settings { faults: faults_of(faults), ..Settings::simulated(7) };
        let (fleet, _) = start(fleet, settings);
        let outcome = outcome(&fleet.unwrap().run_to_end());
        assert!(outcome.starts_with(&format!("Incomplete after {end}")), "{faults:?}: {outcome}");
    }
}

#[test]
fn who_has_not_heard_the_last_message_or_leaves_by_itself_may_act() {
    // B hears what A says only after two minutes, and answers.
    let (outcome, _) = endless(
        "A actor period=10 publishes=TALK each=[0: open; 1: say parcel; 13000: done] waits=[parcels]
         B actor period=120000 delay=120000 publishes=TALK subscribes=TALK each=[hear; say yes] waits=[news]",
    );
    assert_eq!(outcome, "Done after 130 s");
    let (outcome, _) = endless(
        "A actor period=10 task=B each=[0: open; 1: schedule-for 100000; 13000: done] waits=[parcels]
         B actor period=10 startup=false waits=[news]",
    );
    assert_eq!(outcome, "Done after 130 s");
}

#[test]
fn who_is_not_started_is_told_although_nobody_votes() {
    let told = "nothing has happened since 0.000 s, and nothing more can: `B` is not started; `A` waits for news";
    let (outcome, diary) = endless("A actor period=10 waits=[news]\nB actor startup=false");
    assert_eq!((outcome.as_str(), diary.as_str()), (&*format!("Incomplete after 60 s\n- {told}"), ""));
    // A says nothing of itself: it may still act, and an end is the user's.
    check(
        "A actor period=60000\nB actor startup=false",
        7_200_000,
        "[3600.000 s] nothing has happened since 0.000 s: `B` is not started
         Elapsed after 7200 s",
    );
}

#[test]
fn components_on_worker_threads_say_what_they_wait_for_there() {
    // A runs on a worker thread after its second execution, which takes longer than the budget.
    let fleet = "A actor period=10 each=[0: open; 1: sleep 50] waits=[parcels]\nB actor period=10 waits=[news]";
    let settings = Settings { quiet: Duration::from_millis(200), ..real(1000) };
    let (report, diary) = run(fleet, settings);
    assert_eq!(outcome(&report), "Elapsed after 1 s");
    let told = "`A` waits for parcels; `B` waits for news";
    assert!(diary.lines().contains(told), "{}", diary.lines());
    assert_eq!(diary.lines().matches("nothing has happened").count(), 1, "{}", diary.lines());
}
