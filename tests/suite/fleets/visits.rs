//! Blocks that robots visit, and robots that start apart from their chargers.

use std::time::Duration;

use saoms_core::report::RunStatus;
use saoms_testkit::{Fleet, Run};
use serde_json::json;

const LIMIT: Duration = Duration::from_secs(2000);

fn component(id: &str, class: &str, more: &[(&str, &str)]) -> String {
    let more: String =
        more.iter().map(|(name, value)| format!(r#"<property name="{name}">{value}</property>"#)).collect();
    let world = if class == "Robot" { r#"<reference name="world" target="World"/>"# } else { "" };
    format!(
        r#"<component name="{id}"><implementation.rust class="saoms.{class}"/>
        <property name="ID">{id}</property><property name="period">100</property>{more}{world}</component>
"#
    )
}

/// Two robots with these properties, and a scenario.
fn fleet(environment: &[(&str, &str)], robots: [&[(&str, &str)]; 2]) -> Fleet {
    let parts = [
        component("World", "World", &[("moveTime", "200ms")]),
        component("Master", "MasterEnvironment", &[]),
        component("Environment", "Environment", environment),
        component("Robot1", "Robot", &[robots[0], &[("discharge", "0.5")]].concat()),
        component("Robot2", "Robot", &[robots[1], &[("discharge", "0.5")]].concat()),
    ];
    Fleet::of_text(format!(
        r#"<composite xmlns="http://docs.oasis-open.org/ns/opencsa/sca/200912" name="f" targetNamespace="urn:f">
{}</composite>"#,
        parts.concat()
    ))
}

fn run(scenario: &str, robots: [&[(&str, &str)]; 2]) -> Run {
    fleet(&[("scenario", scenario)], robots).run(1, LIMIT)
}

/// The blocks that a robot visited, in their order.
fn visited(run: &Run, robot: &str) -> Vec<String> {
    let lines = run.log_of(robot).into_iter();
    lines.filter_map(|line| Some(line.strip_prefix("visits ")?.split(' ').next()?.to_owned())).collect()
}

#[test]
fn a_robot_visits_its_blocks_in_the_order_of_the_events() {
    let run = run(
        "at 1s visit (9,9) by Robot2; at 1s visit (2,2) then (5,5) by 2; at 1s visit (9,8) by Robot2; at 1s visit (1,1) by 1",
        [&[], &[]],
    );
    assert_eq!(visited(&run, "Robot2"), ["(9,9)", "(2,2)", "(5,5)", "(9,8)"], "{}", run.log());
    assert_eq!(visited(&run, "Robot1"), ["(1,1)"]);
    assert_eq!(run.outcome.status, RunStatus::Done);
    assert_eq!(run.sections["errands"], json!({"requested": 4, "finished": 4, "open": 0}));
    assert_eq!(run.sections["collisions"], json!({"vertex": 0, "swap": 0}));
    assert_eq!(run.sections["luggage"]["requested"], 0, "nothing is brought");
}

#[test]
fn one_of_all_robots_does_a_chain_of_visits_beside_luggage() {
    for seed in 0..5 {
        let scenario = "at 1s 10 times visit random then random then random; at 1s 10 times luggage random to random";
        let run = fleet(&[("scenario", scenario)], [&[], &[]]).run(seed, LIMIT);
        let stops = visited(&run, "Robot1").len() + visited(&run, "Robot2").len();
        assert_eq!(stops, 30, "{}", run.log());
        assert_eq!(run.sections["errands"], json!({"requested": 10, "finished": 10, "open": 0}));
        assert_eq!(run.sections["luggage"]["delivered"], 10);
        assert_eq!(run.sections["stranded"], 0, "the battery of the second one is counted for the whole chain");
    }
}

#[test]
fn visits_of_a_broken_robot_are_done_by_others_unless_they_are_its_own() {
    let scenario = "at 1s visit (2,1) then (9,9) then (9,2); at 1.5s visit (9,1) by Robot1; at 3s breakdown Robot1";
    let run = run(scenario, [&[], &[("startX", "10"), ("startY", "10"), ("chargeX", "10"), ("chargeY", "10")]]);
    let errands = &run.sections["errands"];
    assert_eq!(errands, &json!({"requested": 2, "finished": 1, "open": 1, "given_up": 1}), "{}", run.log());
    assert_eq!(visited(&run, "Robot1"), ["(2,1)"], "it has begun: {}", run.log());
    assert_eq!(visited(&run, "Robot2"), ["(2,1)", "(9,9)", "(9,2)"], "{}", run.log());
    assert_eq!(run.outcome.status, RunStatus::Incomplete);
}

#[test]
fn robots_start_apart_from_their_chargers() {
    let run = run("at 0s visit (7,5) by 1", [&[("startX", "6"), ("startY", "5")], &[]]);
    assert_eq!(run.sections["errands"]["finished"], 1);
    // From the charger it would be 11 moves.
    let log = run.log();
    let at: f64 = log.lines().find(|line| line.contains("visits (7,5)")).unwrap()[1..]
        .split(' ')
        .next()
        .unwrap()
        .parse()
        .unwrap();
    assert!(at < 2.0, "{log}");
    for (robots, expected) in [
        ([("startX", "6"), ("startY", "50")], "robot 1 starts at (6,50), outside the map"),
        ([("startX", "0"), ("startY", "2")], "robots 1 and 2 both start at (0,2)"),
        ([("startX", "6"), ("asleep", "true")], "this robot starts asleep, but not at its charger"),
    ] {
        let found = fleet(&[("scenario", "at 1s visit (7,5)")], [&robots, &[]]).diagnostics();
        assert!(found.contains(expected), "{found}");
    }
}

#[test]
fn events_wait_while_too_many_are_open() {
    let scenario = [("scenario", "at 1s 9 times visit random"), ("mostOpen", "1")];
    let all = fleet(&scenario, [&[], &[]]).run(3, LIMIT);
    assert_eq!(all.sections["errands"]["finished"], 9);
    let open = |line: &str| i64::from(line.contains("is to do: from")) - i64::from(line.contains(": visits ("));
    let log = all.log();
    let most = log.lines().scan(0, |now, line| {
        *now += open(line);
        Some(*now)
    });
    assert_eq!(most.max(), Some(1), "{log}");
}

#[test]
fn impossible_visits_are_told_at_their_place() {
    for (line, expected) in [
        ("visit (3,1) by Robot9", "no robot 9"),
        ("visit (30,1)", "no robot can visit (30,1): this block is outside the map"),
        ("visit (3,1) then", "expected a block such as"),
        ("visit (3,1) to (5,1)", "the end of the line"),
        ("visit (3,1) by", "expected a robot"),
    ] {
        let found = fleet(&[("scenario", &format!("at 1s {line}"))], [&[], &[]]).diagnostics();
        assert!(found.contains(expected) && found.contains("error "), "{line}: {found}");
    }
    let classic: [&[(&str, &str)]; 2] = [&[("policy", "classic")], &[("policy", "classic")]];
    let found = fleet(&[("scenario", "at 1s visit (3,1)")], classic).diagnostics();
    assert!(found.contains("robots with the policy `classic` visit no blocks"), "{found}");
}

/// What robots say of visits is not counted by the world, which counts luggage alone.
#[test]
fn visits_keep_the_invariants_of_luggage() {
    for scenario in
        ["at 1s visit (9,9) by Robot2; at 1s visit (1,1)", "at 1s visit (9,9); at 2s luggage (3,3) to (5,5)"]
    {
        assert_eq!(fleet(&[("scenario", scenario)], [&[], &[]]).violations(1, LIMIT), "", "{scenario}");
    }
}

/// A site with a zone, a master with this property, eight robots, and visits while this happens.
fn disturbed(assignment: &str, fault: &str) -> Fleet {
    let scenario = format!("from 1s every 400ms 30 times visit (0,0)..(10,10) then (0,0)..(10,10); {fault}");
    Fleet::of_text(disturbed_text(assignment, &scenario, 8))
}

fn disturbed_text(assignment: &str, scenario: &str, robots: u32) -> String {
    let mut parts = vec![
        component("World", "World", &[("width", "11"), ("height", "11")]),
        component("Zone", "Zone", &[])
            .replace("</component>", r#"<reference name="world" target="World"/></component>"#),
        component("Master", "MasterEnvironment", &[("assignment", assignment), ("restart", "onFailure")]),
        component("Environment", "Environment", &[("scenario", scenario)]),
    ];
    parts.extend((1..=robots).map(|number| component(&format!("Robot{number}"), "Robot", &[("discharge", "0")])));
    format!(
        r#"<composite xmlns="http://docs.oasis-open.org/ns/opencsa/sca/200912" name="f" targetNamespace="urn:f">
{}</composite>"#,
        parts.concat()
    )
}

#[test]
fn visits_are_done_once_whatever_happens_to_messages() {
    let storm = "at 1s for 20s lose 30 %; at 1s for 20s delay 10ms to 300ms; at 1s for 20s duplicate 10 %; \
        at 1s for 20s reorder 20 % by 200ms";
    let part = "at 1s for 15s part Robot1 from Robot2, Robot3, Robot4";
    for assignment in ["robots", "oldest", "optimal"] {
        for fault in ["at 1s for 20s delay 10ms to 300ms", part, storm] {
            let fleet = disturbed(assignment, fault);
            for seed in 1..=3 {
                let violations = fleet.violations(seed, Duration::from_secs(600));
                assert_eq!(violations, "", "{assignment}, {fault}, seed {seed}");
            }
        }
    }
}

#[test]
fn visits_that_are_assigned_before_they_are_heard_are_no_luggage() {
    let fault = "at 0s delay 400ms on VISITTOPIC from * to Robot1, Robot2, Robot3, Robot4";
    let run = disturbed("optimal", fault).run(1, LIMIT);
    assert_eq!(run.sections["errands"], json!({"requested": 30, "finished": 30, "open": 0}), "{}", run.log());
    assert!(!run.log().contains("collect"), "{}", run.log());
}

#[test]
fn a_robot_that_starts_later_takes_over_a_visit_that_it_never_heard_of() {
    // Robot 2 starts while robot 1 is on its way, which breaks.
    let scenario = "at 1s visit (9,9) then (2,2); at 2500ms breakdown Robot1";
    let times = [("start", "1800ms"), ("work", "10min"), ("pause", "1s"), ("shifts", "1")];
    let shift = component("Shift", "Shift", &times)
        .replace("</component>", r#"<reference name="tasks" target="Robot2/TaskInterface"/></component>"#);
    for assignment in ["robots", "optimal"] {
        let text = disturbed_text(assignment, scenario, 2);
        let late = r#"<property name="ID">Robot2</property>"#;
        let text = text.replace(late, &format!(r#"{late}<property name="runOnStartup">false</property>"#));
        let text = text.replace("</composite>", &format!("{shift}</composite>"));
        let run = Fleet::of_text(text).run(1, LIMIT);
        assert_eq!(run.sections["errands"], json!({"requested": 1, "finished": 1, "open": 0}), "{}", run.log());
        assert_eq!(visited(&run, "Robot2"), ["(9,9)", "(2,2)"], "{}", run.log());
    }
}

#[test]
fn visits_are_called_so() {
    let all = "at 1s visit (9,9) then (5,5); at 2s breakdown Robot1; at 2s breakdown Robot2";
    let run = fleet(&[("scenario", all)], [&[], &[]]).run(1, LIMIT);
    assert!(run.log().contains("gives up visit 1 from (9,9) to (5,5): no robot can do it"), "{}", run.log());
    assert!(!run.log().contains("2147483649"), "{}", run.log());
}
