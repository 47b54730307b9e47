//! Faults that are put into a run on purpose.

use std::time::Duration;

use saoms_api::Time;
use saoms_core::fault::{Faults, MessageFault, MessageFaultKind, TaskFault, TaskFaultKind};
use saoms_core::schedule::Settings;

use crate::fleet::{of, outcome, run, simulated, unindent};

const FLEET: &str = "A actor period=10 publishes=TALK each=[say a; number]
     B actor period=10 subscribes=TALK each=[hear]";

fn at(milliseconds: u64) -> Time {
    Time::from_nanos(milliseconds * 1_000_000)
}

/// The fault of messages on `TALK` between 10 ms and 20 ms.
fn talk(kind: MessageFaultKind) -> Faults {
    let fault = MessageFault { topic: "TALK".to_owned(), from: at(10), until: at(20), kind };
    Faults { messages: vec![fault], ..Faults::default() }
}

fn heard(faults: Faults) -> String {
    let (_, diary) = run(FLEET, Settings { faults, ..simulated(40) });
    let lines: Vec<_> =
        diary.lines().lines().filter_map(|line| Some(line.split_once("hears ")?.1.to_owned())).collect();
    lines.join(" ")
}

#[test]
fn messages_are_lost_late_or_doubled_in_their_time() {
    assert_eq!(heard(Faults::default()), "[a] [a] [a] [a]");
    assert_eq!(heard(talk(MessageFaultKind::Lost)), "[a] [] [a] [a]");
    assert_eq!(heard(talk(MessageFaultKind::Late(Duration::from_millis(15)))), "[a] [] [a] [a, a]");
    assert_eq!(heard(talk(MessageFaultKind::Duplicated)), "[a] [a, a] [a] [a]");
}

#[test]
fn components_fail_and_panic_and_are_handled_as_ever() {
    let fault = |component: &str, kind| TaskFault { component: component.to_owned(), at: at(5), kind };
    let tasks = vec![fault("A", TaskFaultKind::Fails), fault("B", TaskFaultKind::Panics)];
    let fleet = FLEET.replace("publishes", "restart=20/3 publishes");
    let settings = Settings { faults: Faults { tasks, ..Faults::default() }, ..simulated(40) };
    let (report, diary) = run(&fleet, settings);
    let told = diary.lines();
    let failed = "[0.010 s] A: failed and is restarted in 20ms: this execution fails by fault injection\n";
    assert!(told.contains(failed), "{told}");
    assert!(told.contains("[0.030 s] A: restarted (1)\n"), "{told}");
    assert!(told.contains("[0.010 s] B: failed: panicked at "), "{told}");
    assert_eq!((of(&report, "A").failures, of(&report, "B").failures), (1, 1));
}

#[test]
fn a_component_that_stalls_runs_apart() {
    let stall = TaskFaultKind::Stalls(Duration::from_millis(30));
    let tasks = vec![TaskFault { component: "A".to_owned(), at: at(5), kind: stall }];
    let faults = Faults { tasks, ..Faults::default() };
    let settings = Settings { faults, limit: Some(Duration::from_millis(80)), ..Settings::default() };
    let (report, _) = run("A actor period=10\nB actor period=10", settings);
    assert!(outcome(&report).starts_with("Elapsed"), "{}", outcome(&report));
    assert!(of(&report, "A").slow > 0 && of(&report, "A").missed > 0);
}

#[test]
fn a_late_message_keeps_the_order_of_time() {
    let fleet = "A actor period=10 publishes=TALK each=[say-random]
         B actor period=7 subscribes=TALK each=[hear-from]";
    let hash = |time| {
        let faults = talk(MessageFaultKind::Late(Duration::from_millis(time)));
        run(fleet, Settings { faults, ..simulated(100) }).0.trace_hash.unwrap()
    };
    assert_eq!(hash(3), hash(3));
    let told = run(fleet, Settings { faults: talk(MessageFaultKind::Late(Duration::from_millis(3))), ..simulated(20) });
    let times: Vec<_> = told.1.lines().lines().map(|line| line.split(' ').next().unwrap().to_owned()).collect();
    assert_eq!(times.join("\n"), unindent("[0.000\n[0.007\n[0.014"));
}
