//! Orders of operators: read from lines, carried out at their instant, and given again from the journal.

use std::time::Duration;

use saoms_api::Time;
use saoms_core::report::RunReport;
use saoms_core::schedule::{Order, OrderError};
use serde_json::json;

use crate::fleet::{outcome, real, simulated};
use crate::kept::start;

const WAIT: Duration = Duration::from_secs(10);

fn order(line: &str) -> Order {
    Order::read(line).unwrap().unwrap().order
}

fn fault(line: &str) -> String {
    let fault = Order::read(line).unwrap().unwrap_err();
    format!("{} at `{}`", fault, &line[fault.bytes.clone()])
}

/// What came from outside, with its times.
fn lines(report: &RunReport) -> Vec<(Time, String)> {
    let from_outside = report.journal.entries().iter().filter(|entry| entry.component() == "(outside)");
    from_outside.map(|entry| (entry.time(), entry.text())).collect()
}

#[test]
fn orders_are_read_as_they_are_written() {
    for line in [
        "start A",
        "start North/A for 10s",
        "stop A",
        "set A step=5",
        "set A name=two words; # and more",
        "set A name=\"\\\"quoted\\\"\\n\"",
        "set A name=",
        "call A.where",
        "call A/gps.where robot=3 name=\"x y\" at={\"x\":1,\"y\":[2]}",
        "publish TALK {\"words\":\"a b\"}",
        "estop",
        "estop A North/B by ada",
        "release by ada",
    ] {
        assert_eq!(order(line).to_string(), line);
    }
    let call = Order::Call {
        component: "A".to_owned(),
        operation: "where".to_owned(),
        arguments: vec![("robot".to_owned(), json!(3)), ("name".to_owned(), json!("x"))],
    };
    assert_eq!(order("call A.where robot=3 name=x # who"), call);
    assert_eq!(Order::read("at 1500 stop A").unwrap().unwrap().at, Some(Time::from_nanos(1_500_000_000)));
    for line in ["", "luggage (3,1) to (3,10)", "at 3s luggage (3,1) to (3,10)", "at", "fire size=1", "# stop A"] {
        assert_eq!(Order::read(line), None, "{line}");
    }
}

#[test]
fn faults_of_orders_are_told_at_their_place() {
    for (line, expected) in [
        ("start", "found the end of the line, expected the path of a component at ``"),
        ("start A B", "found `B`, expected the end of the line at `B`"),
        ("start A for", "found the end of the line, expected a time, such as `10s` at ``"),
        ("stop A; stop B", "found `;`: write each order on a line of its own at `A;`"),
        ("set A", "found the end of the line, expected `PROPERTY=VALUE` at ``"),
        ("set A step", "found `step`, expected `PROPERTY=VALUE` at `step`"),
        ("set A step=\"5\" more", "found `more`, expected the end of the line at `more`"),
        ("call A", "found `A`, expected a component and its operation, such as `Gps.where` at `A`"),
        ("call A.where 3", "found `3`, expected `ARGUMENT=VALUE` at `3`"),
        ("from 3s stop A", "an order is carried out once; did you mean `at`? at `from`"),
    ] {
        assert_eq!(fault(line), expected, "{line}");
    }
    assert!(fault("at soon stop A").starts_with("`soon` is not a duration"));
    assert!(fault("publish TALK {words").contains("expected a message in JSON"));
}

#[test]
fn orders_take_effect_at_their_instant_and_have_the_same_effect_when_they_are_given_again() {
    const FLEET: &str = "A counter period=10
         B actor period=10 publishes=TALK each=[say b]
         C actor period=10 subscribes=TALK each=[hear] startup=false";
    let (fleet, diary) = start(FLEET, simulated(100));
    let give = |line: &str| fleet.handle().order(order(line), None).unwrap();
    // Before the executions that are due, while time stands.
    fleet.run_until(Time::from_nanos(20_000_000));
    give("set A step=5").wait(WAIT).unwrap();
    give("start C for 35ms").wait(WAIT).unwrap();
    fleet.run_until(Time::from_nanos(34_000_000));
    give("publish TALK {\"text\":\"from outside\"}").wait(WAIT).unwrap();
    fleet.run_until(Time::from_nanos(50_000_000));
    give("stop B").wait(WAIT).unwrap();
    let report = fleet.run_to_end();
    assert_eq!(outcome(&report), "Elapsed after 0.1 s");
    let given = lines(&report);
    let texts: Vec<String> = given.iter().map(|(time, text)| format!("{time} {text}")).collect();
    assert_eq!(
        texts,
        [
            "0.020 s set A step=5",
            "0.020 s start C for 35ms",
            "0.034 s publish TALK {\"text\":\"from outside\"}",
            "0.050 s stop B"
        ]
    );
    let told = diary.lines();
    assert!(told.contains("[0.040 s] C: hears [from outside"), "{told}");
    assert!(!told.contains("[0.060 s] C: hears"), "{told}");

    let (again, second) = start(FLEET, simulated(100));
    for (time, text) in &given {
        again.handle().order(order(text), Some(*time)).unwrap();
    }
    let replayed = again.run_to_end();
    assert_eq!(second.lines(), told);
    assert_eq!(replayed.trace_hash, report.trace_hash);
    assert_eq!(lines(&replayed), given);
}

#[test]
fn an_order_while_virtual_time_runs_comes_after_the_executions_of_that_time() {
    let (fleet, _) = start("A counter period=10\nB actor period=10 each=[number]", simulated(1_000_000));
    let handle = fleet.handle();
    let giver = std::thread::spawn(move || {
        let mut given = 0;
        for step in ["2", "3", "4", "5"].iter().cycle().take(40) {
            given += usize::from(handle.set("A", "step", step).is_ok());
        }
        given
    });
    let report = fleet.run_to_end();
    let given = giver.join().unwrap();
    let lines = lines(&report);
    assert_eq!(lines.len(), given);
    assert!(given > 0);

    let (again, _) = start("A counter period=10\nB actor period=10 each=[number]", simulated(1_000_000));
    for (time, text) in &lines {
        again.handle().order(order(text), Some(*time)).unwrap();
    }
    let replayed = again.run_to_end();
    assert_eq!(replayed.trace_hash, report.trace_hash);
}

#[test]
fn operations_are_called_by_their_declaration() {
    let fleet = "A actor period=10\nB actor period=10 each=[number]";
    let (fleet, _) = start(fleet, real(60_000));
    let call = |line: &str| fleet.handle().order(order(line), None).and_then(|ticket| ticket.wait(WAIT));
    assert_eq!(call("call A.echo text=hello").unwrap(), "hello from A");
    // A number where a text is expected is a text.
    assert_eq!(call("call A/echo.echo text=5").unwrap(), "5 from A");
    let refused = |line: &str| call(line).unwrap_err().to_string();
    assert_eq!(refused("call A.ecko text=1"), "component `A` offers no operation `ecko`; did you mean `echo`?");
    let signature = "operation `echo(text: string) -> string`";
    assert_eq!(refused("call A.echo"), format!("{signature}: field `text` of `echo` is missing"));
    assert_eq!(
        refused("call A.echo words=1"),
        format!("{signature}: `echo` has no field `words`; its fields are: text; field `text` of `echo` is missing")
    );
    assert!(refused("call D.echo text=1").starts_with("the fleet has no component `D`"));
    fleet.handle().stop();
    let report = fleet.run_to_end();
    assert_eq!(lines(&report)[0].1, "call A.echo text=\"hello\"");
}

#[test]
fn an_order_that_waits_is_withdrawn_from_elsewhere_or_ends_with_the_run() {
    let (fleet, _) = start("A actor period=10 each=[until-cancelled]\nB actor period=10", real(60_000));
    let handle = fleet.handle();
    let call = |line: &str| handle.order(order(line), None).unwrap();
    // Until the code of the component does not return.
    while call("call A.echo text=a").wait(Duration::from_millis(20)).is_ok() {}
    let (left, waiting, scheduled) = (call("call A.echo text=b"), call("call A.echo text=c"), call("stop B"));
    assert_eq!(scheduled.wait(WAIT), Ok(json!(null)));
    assert!(!scheduled.withdrawal().withdraw(), "it has taken effect");
    let withdrawal = left.withdrawal();
    assert!(withdrawal.withdraw() && !withdrawal.withdraw());
    assert_eq!(left.wait(WAIT), Err(OrderError::NotYet));
    handle.stop();
    assert_eq!(waiting.wait(WAIT), Err(OrderError::Ending));
    let report = fleet.run_to_end();
    assert!(lines(&report).iter().all(|(_, line)| !line.contains("text=\"b") && !line.contains("text=\"c")));
}
