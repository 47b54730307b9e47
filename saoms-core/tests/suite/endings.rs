use saoms_api::extension::{RunSummary, submit};
use saoms_core::report::RunStatus;
use serde_json::json;

use crate::fleet::{check, of, outcome, run, simulated, start};

#[test]
fn the_run_ends_when_all_who_voted_see_no_work_left() {
    check(
        "A actor period=10 each=[0: open; 3: done] last=[log last]
         B actor period=10 each=[1: done]
         C actor period=10 each=[3: log never] last=[log last]",
        1000,
        "[0.030 s] C: last
         [0.030 s] A: last
         Done after 0.03 s",
    );
}

#[test]
fn a_run_does_not_end_before_the_last_event_of_who_has_no_work_left_is_read() {
    check(
        "A actor period=10 publishes=TALK each=[0: open; 2: say last words; 2: done]
         B actor period=20 delay=5 subscribes=TALK each=[1: hear]",
        1000,
        "[0.025 s] B: hears [last words]
         Done after 0.08 s",
    );
    // Who goes on to talk keeps no run from its end.
    check(
        "A actor period=10 publishes=TALK each=[say again; done]
         B actor period=10 subscribes=TALK each=[0: hear]",
        1000,
        "[0.000 s] B: hears [again]
         Done after 0.03 s",
    );
    // An event that nobody reads keeps no run from its end.
    check("A actor period=10 publishes=TALK each=[0: open; 2: say last words; 2: done]", 1000, "Done after 0.02 s");
    // A state is no event: the newest one is kept, and nobody has to read it.
    check(
        "A actor period=10 publishes=TABLE each=[2: put 1 10; 2: done]
         B actor period=10 subscribes=TABLE",
        1000,
        "Done after 0.02 s",
    );
}

#[test]
fn who_sees_work_again_takes_its_vote_back() {
    check(
        "A actor period=10 each=[0: done; 2: done]
         B actor period=10 first=[open] each=[1: done; 1: open; 4: done]",
        1000,
        "Done after 0.04 s",
    );
}

#[test]
fn a_run_in_which_work_was_given_up_is_incomplete_whatever_ends_it() {
    for (fleet, end) in [
        ("A actor period=10 each=[0: open; 1: gave-up; 3: done]", "0.03 s"),
        ("A actor period=10 each=[0: open; 1: gave-up]", "0.05 s"),
        // Who only says that, has no vote about what is left.
        ("A actor period=10 each=[1: gave-up]\nB actor period=10 each=[0: open; 3: done]", "0.03 s"),
        ("A actor period=10 each=[gave-up]", "0.05 s"),
    ] {
        check(fleet, 50, &format!("Incomplete after {end}\n- work was given up, reported by `A`"));
    }
    check(
        "A actor period=10 each=[0: open; 1: gave-up; 2: fail now]",
        50,
        "[0.020 s] A: failed: now
         Failed after 0.02 s
         - component `A` failed: now
         - component `A` ended before it reported that its work is done",
    );
    let (report, _) = run("A actor period=10 each=[0: done; 0: gave-up]\nB actor", simulated(50));
    let votes = json!({"done": 1, "open": [], "given_up": ["A"]});
    assert_eq!(serde_json::to_value(&report.votes).unwrap(), votes);
    assert_eq!(serde_json::to_value(report.outcome.status).unwrap(), json!("incomplete"));
}

#[test]
fn a_vote_in_initialize_counts_when_the_fleet_has_started() {
    check("A actor first=[done] each=[log never]", 1000, "Done after 0 s");
}

#[test]
fn who_is_unscheduled_has_no_vote() {
    check(
        "A actor period=10 each=[0: open]
         B actor period=10 task=A each=[0: done; 3: unschedule]",
        1000,
        "Done after 0.03 s",
    );
}

#[test]
fn nobody_voting_is_no_end() {
    check("A actor period=10", 50, "Elapsed after 0.05 s");
}

#[test]
fn in_virtual_time_a_fleet_without_scheduled_components_ends() {
    let (fleet, diary) =
        start("A actor period=10 task=A each=[3: unschedule]\nB callee", saoms_core::schedule::Settings::simulated(1));
    let report = fleet.unwrap().run_to_end();
    assert_eq!(
        outcome(&report),
        "Done after 0.03 s\n- no component is scheduled, and in virtual time nothing else happens"
    );
    assert_eq!(diary.lines(), "");
}

#[test]
fn a_fleet_that_nobody_starts_is_not_done() {
    let (fleet, _) = start(
        "A actor startup=false\nB actor startup=false\nC callee\nD actor startup=false\nE actor startup=false",
        saoms_core::schedule::Settings::simulated(1),
    );
    assert_eq!(
        outcome(&fleet.unwrap().run_to_end()),
        "Incomplete after 0 s\n- no component is scheduled, and in virtual time nothing else happens: nobody starts \
         `A`, `B`, `D` and 1 more"
    );
}

#[test]
fn a_fleet_of_passive_components_lasts_until_it_is_stopped() {
    let (fleet, diary) = start("A callee last=[log last]", saoms_core::schedule::Settings::default());
    let fleet = fleet.unwrap();
    let handle = fleet.handle();
    let stopper = std::thread::spawn(move || {
        std::thread::sleep(std::time::Duration::from_millis(30));
        handle.stop();
    });
    let report = fleet.run_to_end();
    assert_eq!(report.outcome.status, RunStatus::Interrupted);
    assert!(diary.lines().ends_with("A: last\n"));
    stopper.join().unwrap();
}

#[test]
fn in_virtual_time_nothing_happens_to_passive_components_and_the_run_ends() {
    let (fleet, diary) = start("A callee last=[log last]", saoms_core::schedule::Settings::simulated(1));
    let report = fleet.unwrap().run_to_end();
    assert_eq!(report.outcome.status, RunStatus::Done);
    assert!(diary.lines().ends_with("A: last\n"));
}

#[test]
fn a_fleet_that_is_dropped_shuts_down() {
    for settings in [simulated(1000), crate::fleet::real(60_000)] {
        let (fleet, diary) = start("A actor each=[log a] last=[log last]", settings);
        drop(fleet);
        assert!(diary.lines().ends_with("A: last\n"), "{}", diary.lines());
    }
}

#[test]
fn a_stop_before_time_begins_ends_the_run_at_once() {
    let (fleet, diary) = start("A actor each=[log never] last=[log last]", simulated(1000));
    let fleet = fleet.unwrap();
    fleet.handle().stop();
    assert_eq!(outcome(&fleet.run_to_end()), "Interrupted after 0 s");
    assert_eq!(diary.lines(), "[0.000 s] A: last\n");
}

#[test]
fn a_component_that_does_not_return_ends_a_virtual_run_and_is_named() {
    let settings =
        saoms_core::schedule::Settings { virtual_watchdog: std::time::Duration::from_millis(60), ..simulated(1000) };
    let (report, diary) = run(
        "A actor period=10 last=[log last]
         B actor period=10 each=[2: sleep 1500] last=[log never]
         C actor period=10 last=[log last]",
        settings,
    );
    assert_eq!(outcome(&report), "Failed after 0.02 s\n- component `B` did not return within 60ms");
    assert_eq!(
        diary.lines(),
        "[0.020 s] B: did not end in time and is abandoned\n[0.020 s] C: last\n[0.020 s] A: last\n"
    );
}

submit! {
    RunSummary {
        counts: &["parcels.requested", "parcels.delivered", "lost"],
        result: |_| None,
        progress: |count| Some(format!("{} delivered", count("parcels.delivered"))),
        voters: "a depot",
    }
}

#[test]
fn reports_have_what_components_contribute_and_nothing_that_they_must_not() {
    let (report, diary) = run(
        "A actor period=10 each=[count parcels.delivered 2; count mine.number 1; report map.size 11; 0: count seed 5; 0: report outcome.x 5]
         B actor period=10 each=[count parcels.delivered -1; report map.size 12; done]",
        simulated(1000),
    );
    assert_eq!(
        diary.lines(),
        "[0.000 s] A: `seed` of the report belongs to the program, and is not changed\n\
         [0.000 s] A: `outcome.x` of the report belongs to the program, and is not changed\n"
    );
    assert_eq!(of(&report, "A").class, "actor");
    let json = serde_json::to_value(&report).unwrap();
    assert_eq!(
        json,
        json!({
            "seed": 7, "time_s": 0.0, "periods": 2,
            "parcels": {"requested": 0, "delivered": 1}, "lost": 0,
            "mine": {"number": 1}, "map": {"size": 12},
            "components": [
                {"name": "A", "id": "A", "class": "actor", "executions": 1, "missed": 0, "reactions": 0, "late_us": {"p50": 0, "p99": 0, "max": 0},
                 "deadline_misses": 0, "slow": 0, "busy": 0, "restarts": 0, "replaced": 0, "failures": 0, "dropped": 0, "messages": {"sent": 0, "received": 0}},
                {"name": "B", "id": "B", "class": "actor", "executions": 1, "missed": 0, "reactions": 0, "late_us": {"p50": 0, "p99": 0, "max": 0},
                 "deadline_misses": 0, "slow": 0, "busy": 0, "restarts": 0, "replaced": 0, "failures": 0, "dropped": 0, "messages": {"sent": 0, "received": 0}},
            ],
            "journal": {"records": 0, "overwritten": 0, "lost": 0, "loops": [], "entries": []},
            "votes": {"done": 1, "open": [], "given_up": []},
            "standstill": null,
            "outcome": {"status": "done", "reasons": []},
            "trace_hash": report.trace_hash,
        })
    );
    assert_eq!(serde_json::from_value::<saoms_core::report::RunReport>(json).unwrap(), report);
    assert_eq!((report.count("parcels.delivered"), report.count("lost"), report.count("map.colour")), (1, 0, 0));
}

#[test]
fn what_is_sent_at_the_end_overflows_no_queue() {
    let senders: String =
        (0..20).map(|n| format!("A{n} actor publishes=TALK subscribes=TALK queue=4 last=[say bye]\n")).collect();
    let (report, _) = run(&senders, simulated(50));
    assert_eq!(outcome(&report), "Elapsed after 0.05 s");
    assert!(report.components.iter().all(|component| component.dropped == 0 && component.messages.sent == 1));
}

#[test]
fn a_program_that_listens_slowly_does_not_make_a_component_look_stuck() {
    struct Slow(std::sync::atomic::AtomicUsize);
    impl saoms_core::observe::Observer for Slow {
        fn event(&self, _: &saoms_core::observe::RunEvent) {
            if self.0.fetch_add(1, std::sync::atomic::Ordering::Relaxed) == 0 {
                std::thread::sleep(std::time::Duration::from_millis(1500));
            }
        }
    }
    let settings =
        saoms_core::schedule::Settings { virtual_watchdog: std::time::Duration::from_secs(1), ..simulated(70_000) };
    let assembly = crate::fleet::assembly("A actor period=1 each=[log a]");
    let slow = std::sync::Arc::new(Slow(std::sync::atomic::AtomicUsize::new(0)));
    let fleet = saoms_core::schedule::RunningFleet::start(assembly, settings, vec![slow.clone()]).unwrap();
    assert_eq!(outcome(&fleet.run_to_end()), "Elapsed after 70 s");
    assert_eq!(slow.0.load(std::sync::atomic::Ordering::Relaxed), 70_002);
}
