//! In real time. No test here asserts how long something took: machines are noisy.

use std::thread;
use std::time::{Duration, Instant};

use saoms_core::observe::Occurrence;
use saoms_core::report::RunStatus;
use saoms_core::schedule::{RunningFleet, Settings};
use saoms_lang::assembly::Assembly;

use crate::fleet::{Diary, of, outcome, real, run, start};

/// Number of times that the fleet had to continue without a slow component.
fn takeovers(diary: &Diary, name: &str) -> usize {
    diary.count(|event| event.component.as_deref() == Some(name) && matches!(event.what, Occurrence::Slow { .. }))
}

/// Waits for something to happen, up to ten seconds.
#[track_caller]
fn wait_for(what: &str, happened: impl Fn() -> bool) {
    let begin = Instant::now();
    while !happened() {
        assert!(begin.elapsed() < Duration::from_secs(10), "{what} did not happen");
        thread::sleep(Duration::from_millis(2));
    }
}

#[test]
fn executions_follow_the_clock() {
    let (report, _) = run("A actor period=10\nB actor period=25 delay=30\nC actor period=500us", real(200));
    assert_eq!(report.outcome.status, RunStatus::Elapsed);
    assert_eq!(report.time_s, 0.2);
    for (name, due) in [("A", 20), ("B", 7), ("C", 400)] {
        // Each due execution has run or is counted as missed; the last one may have been so late that later ones are
        // counted, too.
        let component = of(&report, name);
        assert!(component.executions <= due && component.executions + component.missed >= due, "{component:?}");
    }
}

#[test]
fn a_blocked_execution_does_not_hold_up_the_others() {
    let (report, diary) = run(
        "A actor period=300 each=[sleep 200]
         B actor period=2
         C actor period=2 delay=1 publishes=TALK each=[say word]
         D actor period=4 subscribes=TALK each=[]",
        real(600),
    );
    assert_eq!(outcome(&report), "Elapsed after 0.6 s");
    assert_eq!(takeovers(&diary, "A"), 1, "{}", diary.lines());
    assert_eq!((of(&report, "A").executions, of(&report, "A").slow), (2, 2));
    for name in ["B", "C"] {
        assert!(of(&report, name).executions > 100, "{:?}", of(&report, name));
    }
    assert!(of(&report, "D").messages.received > 100);
}

#[test]
fn what_holds_up_the_others_is_named() {
    let (fleet, diary) = start(
        "A actor period=10 status=200
         B actor period=10 each=[2: sleep 200]
         C actor period=10 last=[sleep 200]",
        // Nothing else takes so long, however busy the machine is.
        Settings { budget: Duration::from_millis(50), ..real(600) },
    );
    let fleet = fleet.unwrap();
    while fleet.handle().progress().periods < 20 {
        thread::sleep(Duration::from_millis(1));
    }
    let _ = fleet.handle().status();
    let _ = fleet.run_to_end();
    let of_three = [("A", "`status`"), ("B", "an execution"), ("C", "`shutdown`")];
    for (name, what) in of_three {
        let line = format!("{what} takes longer than ");
        let said =
            diary.count(|event| event.component.as_deref() == Some(name) && event.what.to_string().starts_with(&line));
        assert_eq!(said, 1, "{}", diary.lines());
    }
}

#[test]
fn any_number_of_blocked_executions_does_not_hold_up_the_others() {
    let blocked: String = (0..12).map(|n| format!("A{n} actor period=400 each=[sleep 300]\n")).collect();
    // A busy machine stalls the start or the end of a component for longer than the usual budget of 1 ms.
    let settings = Settings { budget: Duration::from_millis(15), ..real(700) };
    let (report, diary) = run(&format!("{blocked}B actor period=2"), settings);
    assert_eq!(outcome(&report), "Elapsed after 0.7 s");
    for n in 0..12 {
        let name = format!("A{n}");
        assert_eq!(takeovers(&diary, &name), 1, "{name}");
        assert_eq!(of(&report, &name).executions, 2, "{name}");
    }
    assert!(of(&report, "B").executions > 100, "{:?}", of(&report, "B"));
}

#[test]
fn executions_do_not_overlap_and_those_left_out_are_counted() {
    let (report, _) = run("A actor period=10 each=[sleep 35]\nB actor period=5", real(400));
    let a = of(&report, "A");
    assert_eq!(a.executions, a.slow);
    assert!((2..=12).contains(&a.executions), "{a:?}");
    assert!(a.missed >= a.executions && a.executions + a.missed <= 40, "{a:?}");
    assert!(of(&report, "B").executions > 20);
}

#[test]
fn catch_up_leaves_no_execution_out() {
    let (report, _) = run("A actor period=5 overrun=catchUp each=[2: sleep 100]\nB actor period=5", real(400));
    let a = of(&report, "A");
    assert_eq!(a.missed, 0);
    assert!(a.executions > 40, "{a:?}");
}

#[test]
fn stop_on_overrun_ends_the_component_and_fails_the_run() {
    let (report, diary) = run(
        "A actor period=10 overrun=stop each=[2: sleep 100] last=[log last]
         B actor period=5",
        real(300),
    );
    assert_eq!(report.outcome.status, RunStatus::Failed);
    assert!(report.outcome.reasons[0].starts_with("component `A` stopped, because "), "{:?}", report.outcome);
    assert!(diary.lines().contains("A: last"));
    assert!(of(&report, "A").missed > 0);
    assert!(of(&report, "B").executions > 20);
}

#[test]
fn late_ends_are_counted_against_the_deadline() {
    let (report, _) = run(
        "A actor period=50 deadline=10 each=[sleep 20]
         B actor period=50 deadline=40s each=[sleep 20]",
        real(200),
    );
    assert_eq!(of(&report, "A").deadline_misses, of(&report, "A").executions);
    assert_eq!(of(&report, "B").deadline_misses, 0);
}

#[test]
fn failures_of_slow_components_are_contained_too() {
    let (report, diary) = run(
        "A actor period=10 restart=20/3 each=[sleep 30; 1: panic out of paper]
         B actor period=5",
        real(400),
    );
    assert!(of(&report, "A").restarts >= 1, "{}", diary.lines());
    assert!(diary.lines().contains(": out of paper"));
    assert!(of(&report, "B").executions > 20);
}

#[test]
fn a_slow_start_at_run_time_does_not_hold_up_the_others() {
    let (fleet, diary) = start(
        "A actor period=10 startup=false first=[sleep 200] each=[log a]
         B actor period=2",
        Settings::default(),
    );
    let fleet = fleet.unwrap();
    fleet.handle().schedule("A").unwrap();
    wait_for("a slow start", || takeovers(&diary, "A") == 1);
    let before = fleet.handle().progress().periods;
    wait_for("executions of others", || fleet.handle().progress().periods > before + 10);
    wait_for("the first execution", || diary.lines().contains("A: a"));
    fleet.handle().stop();
    assert_eq!(fleet.run_to_end().outcome.status, RunStatus::Interrupted);
}

#[test]
fn an_idle_fleet_wakes_up_for_a_request_and_is_watched_from_the_start() {
    let (fleet, diary) = start(
        "A actor period=1h startup=false each=[sleep 400]
         B actor period=2 startup=false",
        Settings::default(),
    );
    let fleet = fleet.unwrap();
    thread::sleep(Duration::from_millis(30));
    fleet.handle().schedule("A").unwrap();
    wait_for("a takeover", || takeovers(&diary, "A") == 1);
    fleet.handle().schedule("B").unwrap();
    wait_for("executions of B", || fleet.handle().progress().periods > 20);
    assert!(!diary.all_lines().contains("A: has shut down"));
    fleet.handle().unschedule("A").unwrap();
    wait_for("the end of A", || diary.all_lines().contains("A: has shut down"));
}

#[test]
fn unscheduling_interrupts_an_execution_that_listens() {
    let (fleet, diary) = start(
        "A actor period=10 each=[until-cancelled] last=[log last]
         B actor period=10 interrupt=false each=[sleep 60; cancelled] last=[log last]
         C actor period=2",
        Settings::default(),
    );
    let fleet = fleet.unwrap();
    wait_for("takeovers", || takeovers(&diary, "A") + takeovers(&diary, "B") == 2);
    fleet.handle().unschedule("A").unwrap();
    fleet.handle().unschedule("B").unwrap();
    wait_for("both to leave", || diary.lines().contains("A: last") && diary.lines().contains("B: last"));
    assert!(diary.lines().contains("B: cancelled false"), "{}", diary.lines());
    fleet.handle().schedule("A").unwrap();
    wait_for("A to be back", || diary.all_lines().matches("A: started").count() == 2);
}

#[test]
fn who_is_in_the_middle_of_a_long_execution_is_busy() {
    let (fleet, diary) = start(
        "A actor period=10 each=[sleep 100]
         B actor period=2 peer=A each=[ask something]",
        Settings::default(),
    );
    let fleet = fleet.unwrap();
    let busy = "B: is told nothing: component `A` is in the middle of an execution and cannot be called";
    wait_for("a busy provider", || diary.lines().contains(busy));
    wait_for("an answer", || diary.lines().contains("B: is told \"something from A\""));
    fleet.handle().stop();
    assert_eq!(fleet.run_to_end().outcome.status, RunStatus::Interrupted);
}

#[test]
fn a_provider_that_blocks_holds_up_its_caller_alone() {
    let (report, diary) = run(
        "A actor period=300 peer=P each=[ask something]
         P callee called=[sleep 200]
         B actor period=2",
        real(500),
    );
    assert_eq!(takeovers(&diary, "A"), 1);
    assert_eq!(diary.lines().matches("is told \"something from P\"").count(), 2, "{}", diary.lines());
    assert!(of(&report, "B").executions > 100);
}

#[test]
fn a_provider_whose_time_comes_while_it_serves_runs_afterwards() {
    let (report, diary) = run(
        "A actor period=1h peer=P each=[ask something]
         P actor period=20 called=[sleep 100]
         B actor period=2",
        real(400),
    );
    assert!(diary.lines().contains("is told \"something from P\""));
    let p = of(&report, "P");
    assert!(p.executions > 3 && p.executions + p.missed <= 20, "{p:?}");
}

#[test]
fn the_end_waits_for_executions_and_lets_everybody_shut_down() {
    let (fleet, diary) = start(
        "A actor period=10 each=[until-cancelled; log interrupted] last=[log last]
         B actor period=10 each=[sleep 50] last=[log last]
         C actor period=10 last=[log last; sleep 50]
         D callee last=[log last]",
        Settings::default(),
    );
    let fleet = fleet.unwrap();
    wait_for("takeovers", || takeovers(&diary, "A") + takeovers(&diary, "B") == 2);
    fleet.handle().stop();
    let report = fleet.run_to_end();
    assert_eq!(report.outcome.status, RunStatus::Interrupted);
    assert_eq!(report.outcome.reasons, Vec::<String>::new());
    let told = diary.lines();
    for line in ["A: interrupted", "A: last", "B: last", "C: last", "D: last"] {
        assert!(told.contains(line), "{line} is missing in\n{told}");
    }
}

#[test]
fn who_does_not_end_in_time_is_left_behind_when_the_time_of_the_run_is_over() {
    let settings = Settings { grace: Duration::from_millis(100), ..real(100) };
    let (report, _) = run("A actor period=10 each=[sleep 20000]\nB actor period=10 last=[log last]", settings);
    assert_eq!(report.outcome.status, RunStatus::Failed);
    assert!(report.outcome.reasons.iter().any(|why| why.contains('A')), "{:?}", report.outcome.reasons);
}

#[test]
fn each_component_of_many_has_the_time_to_end() {
    let settings = Settings { grace: Duration::from_millis(400), ..real(50) };
    let fleet: Vec<String> = (0..30).map(|number| format!("C{number} actor period=10 last=[sleep 40]")).collect();
    let (report, _) = run(&fleet.join("\n"), settings);
    assert_eq!(report.outcome.reasons, Vec::<String>::new());
}

#[test]
fn who_does_not_end_in_time_is_named_and_left_behind() {
    let settings = Settings { grace: Duration::from_millis(150), ..Settings::default() };
    let (fleet, diary) = start(
        "A actor period=10 each=[sleep 20000] last=[log never]
         B actor period=10 last=[sleep 20000]
         C actor period=10 last=[log last]",
        settings,
    );
    let fleet = fleet.unwrap();
    wait_for("a takeover", || takeovers(&diary, "A") == 1);
    fleet.handle().stop();
    let begin = Instant::now();
    let report = fleet.run_to_end();
    assert!(begin.elapsed() < Duration::from_secs(15), "it waited for what does not end");
    assert_eq!(
        outcome(&report).lines().skip(1).collect::<Vec<_>>(),
        ["- component `A` did not end within 150ms", "- component `B` did not end within 150ms"]
    );
    assert_eq!(report.outcome.status, RunStatus::Interrupted);
    assert!(diary.lines().contains("C: last"), "{}", diary.lines());
    assert!(diary.lines().contains("A: did not end in time and is abandoned"));
}

#[test]
fn a_fleet_that_is_too_much_for_the_machine_says_so_and_ends() {
    let busy: String = (0..8).map(|n| format!("A{n} actor period=1 each=[spin 1]\n")).collect();
    let settings = Settings { budget: Duration::from_secs(5), ..real(900) };
    let (report, diary) = run(&format!("{busy}B actor period=50"), settings);
    assert_eq!(outcome(&report), "Elapsed after 0.9 s");
    assert!(diary.lines().contains("need more processor time than is available"), "{}", diary.lines());
    assert!((0..8).all(|n| of(&report, &format!("A{n}")).missed > 0));
    assert!(of(&report, "B").executions > 2);
}

#[test]
fn a_real_run_ends_when_the_work_is_done() {
    let (report, _) = run("A actor period=5 each=[0: open; 6: done]\nB actor period=1", Settings::default());
    assert_eq!(report.outcome.status, RunStatus::Done);
    assert_eq!(of(&report, "A").executions, 7);
}

#[test]
fn a_program_that_panics_over_an_event_does_not_disturb_the_fleet() {
    struct Clumsy;
    impl saoms_core::observe::Observer for Clumsy {
        fn event(&self, _: &saoms_core::observe::RunEvent) {
            // Not `panic!`, whose message would be shown among those of the tests.
            std::panic::resume_unwind(Box::new("clumsy"));
        }
    }
    let assembly = crate::fleet::assembly("A actor period=5 each=[log a]");
    let fleet =
        saoms_core::schedule::RunningFleet::start(assembly, real(60), vec![std::sync::Arc::new(Clumsy)]).unwrap();
    assert_eq!(fleet.run_to_end().outcome.status, RunStatus::Elapsed);
}

/// The timer already sleeps when the fleet starts, and no due component wakes it.
#[test]
fn a_fleet_without_tasks_ends_when_its_time_is_over() {
    for _ in 0..50 {
        let settings = Settings { limit: Some(Duration::from_millis(1)), ..Settings::default() };
        let fleet = RunningFleet::start(Assembly::default(), settings, Vec::new()).unwrap();
        assert_eq!(fleet.run_to_end().outcome.status, RunStatus::Elapsed);
    }
}
