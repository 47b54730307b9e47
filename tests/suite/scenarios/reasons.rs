//! Chains of causes lead from acts of robots back to their origin in another component.

use saoms_testkit::Fleet;

use super::fleet::fleet;
use super::run::Run;

/// Checks of each record of these loops with one of these ids that the way back ends in the environment; how many those
/// are.
#[track_caller]
fn begin_outside(run: &Run, loops: &[&str], ids: &[&str]) -> usize {
    let journal = &run.report.journal;
    let name = |of: &str| loops.contains(&of);
    let mut seen = 0;
    for entry in journal.entries().iter().filter(|entry| entry.loop_name().is_some_and(name)) {
        if !ids.contains(&entry.record_id()) {
            continue;
        }
        seen += 1;
        let way = std::iter::successors(Some(entry), |entry| journal.entry(entry.cause()));
        let root = way.last().unwrap();
        assert_eq!(root.component(), "Environment", "{} {}: {}", entry.time(), entry.component(), entry.text());
    }
    seen
}

#[test]
fn jobs_and_the_way_of_luggage_begin_with_the_request() {
    for composite in ["usecase-luggage.composite", "scenario1.composite", "scenario2.composite"] {
        let run = Run::of(composite, 200);
        let of_luggage = ["offers_to_carry", "offers_to_carry_luggage", "takes_luggage", "withdraws_offer_for_luggage"];
        let taken = begin_outside(&run, &["EventLuggageMS"], &of_luggage);
        let carried = begin_outside(&run, &["PathFollowerMS", "GripperMS"], &["hasLuggage", "collects_luggage"]);
        assert!(taken > 3 && carried > 1, "{composite}: {taken}, {carried}");
    }
}

#[test]
fn help_begins_with_the_breakdown_and_shifts_with_the_landing() {
    let scenario = "at 1s luggage (3,1) to (9,5); at 14s breakdown 1; at 15s landing 2; at 60s end";
    let robots = ["1", "3", "5", "7 asleep=true", "8 asleep=true"];
    for policy in ["safe", "classic"] {
        let run = Run::with(&fleet(policy, "", scenario, &robots), 100);
        let help = ["offers_help", "helps_robot", "wakes_robot", "wakes_substitute", "takes_over_luggage_on_board"];
        let healed = begin_outside(&run, &["CriticalSituationMS"], &help);
        let calls = ["wakes_robots", "wakes_robot", "shift_ends", "sends_robots_to_charge", "sends_robot_to_charge"];
        let called = begin_outside(&run, &["AwakeAsleepMS"], &calls);
        let sleep = ["wakes", "wakes_as_substitute", "sleeps_after_job", "sleeps", "charges_after_job"];
        let slept = begin_outside(&run, &["RobotMS"], &sleep);
        assert!(healed > 2 && called > 3 && slept > 1, "{policy}: {healed}, {called}, {slept}");
    }
}

#[test]
fn each_called_robot_follows_from_its_own_call() {
    let run = Run::with(&fleet("safe", "", "at 1s landing 4; at 10s end", &["2 asleep=true", "3 asleep=true"]), 100);
    let journal = &run.report.journal;
    for (robot, call) in [("Robot002", "wakes robot 2"), ("Robot003", "wakes robot 3")] {
        let symptoms = journal.of(robot).of_loop("RobotMS");
        let first = symptoms.iter().next().unwrap();
        assert_eq!(journal.entry(first.cause()).unwrap().text(), call);
    }
}

#[test]
fn luggage_for_which_nobody_is_awake_awakes_a_robot() {
    let robots = ["1 asleep=true", "2 asleep=true"];
    let run = Run::with(&fleet("safe", "", "at 1s luggage (3,1) to (3,10)", &robots), 300);
    assert_eq!(run.count("luggage", "delivered"), 1);
    assert_eq!(run.log("Robot002"), [""; 0], "one is enough");
    assert_eq!(begin_outside(&run, &["RobotMS"], &["no_awake_robot_can_carry"]), 1);
}

#[test]
fn luggage_that_no_battery_lasts_for_is_given_up_in_the_end() {
    // A move takes two executions: too much for the way to the far corner and back, as the checker tells.
    let component = |id: &str, class: &str, more: &str| {
        format!(
            r#"<component name="{id}"><implementation.java class="{class}"/><property name="ID">{id}</property>
            <property name="period">100</property>{more}</component>"#
        )
    };
    let scenario = "at 1s luggage (3,1) to (9,8)..(10,8); at 30s luggage (1,1) to (1,3)";
    let text = format!(
        r#"<composite xmlns="http://www.osoa.org/xmlns/sca/1.0" name="slow" targetNamespace="urn:slow">{}{}{}{}</composite>"#,
        component("World", "saoms.World", r#"<property name="moveTime">150ms</property>"#),
        component("MEMS", "saoms.MasterEnvironment", ""),
        component("Environment", "saoms.Environment", &format!(r#"<property name="scenario">{scenario}</property>"#)),
        component("Robot001", "saoms.Robot", r#"<reference name="world" target="World"/>"#),
    );
    let run = Run::with(&Fleet::of_text(text).with_severity("S5006", "warning"), 300);
    assert_eq!((run.count("luggage", "delivered"), run.count("luggage", "open")), (0, 2));
    let given_up = |line: &String| line.contains(" any more: a full battery does not last for the way");
    assert_eq!(run.log("Robot001").iter().filter(|line| given_up(line)).count(), 1);
    // With that on board it takes nothing else.
    assert!(run.log("MEMS").iter().any(|line| line.contains("gives up luggage 2")));
}
