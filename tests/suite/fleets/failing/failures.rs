//! Components of robots that fail: what they were to bring is brought by others, and the run ends by itself.

use std::time::Duration;

use saoms_api::{Chance, Class, Component, Context, Failure, Own, Properties, Saved, TaskInterfaceReference, Time};
use saoms_components::robot::Robot;
use saoms_testkit::{Fleet, Run};
use serde_json::{Value, json};

const LIMIT: Duration = Duration::from_secs(2000);

/// What a fleet is made of, beside its robots.
#[derive(Clone, Copy, Debug)]
struct Site {
    has_world: bool,
    has_zone: bool,
}

const SITES: [Site; 3] = [
    Site { has_world: true, has_zone: false },
    Site { has_world: true, has_zone: true },
    Site { has_world: false, has_zone: false },
];

fn property(name: &str, value: &str) -> String {
    format!(r#"<property name="{name}">{value}</property>"#)
}

fn component(id: &str, class: &str, more: &str) -> String {
    format!(
        r#"<component name="{id}"><implementation.rust class="saoms.{class}"/>
        <property name="ID">{id}</property><property name="period">100</property>{more}</component>
"#
    )
}

/// A fleet with these robots, each with more properties.
fn fleet(site: Site, scenario: &str, robots: &[(&str, &str)]) -> Fleet {
    fleet_with(site, "robots", scenario, robots)
}

/// The same with a master that assigns luggage in this way.
fn fleet_with(site: Site, assignment: &str, scenario: &str, robots: &[(&str, &str)]) -> Fleet {
    fleet_and("", site, assignment, scenario, robots)
}

/// The same with other components.
fn fleet_and(others: &str, site: Site, assignment: &str, scenario: &str, robots: &[(&str, &str)]) -> Fleet {
    let world = if site.has_world { r#"<reference name="world" target="World"/>"# } else { "" };
    let mut components = others.to_owned();
    if site.has_world {
        components +=
            &component("World", "World", &(property("moveTime", "150ms") + &property("handlingTime", "300ms")));
    }
    if site.has_zone {
        components += &component("Zone", "Zone", world);
    }
    components += &component("Master", "MasterEnvironment", &property("assignment", assignment));
    components += &component("MasterRobot", "MasterRobot", "");
    components += &component("Environment", "Environment", &property("scenario", scenario));
    for (robot, more) in robots {
        components += &component(robot, "Robot", &[world, more, &property("discharge", "0.1")].concat());
    }
    composite(&components)
}

fn composite(components: &str) -> Fleet {
    Fleet::of_text(format!(
        r#"<composite xmlns="http://docs.oasis-open.org/ns/opencsa/sca/200912" name="f" targetNamespace="urn:f">
{components}</composite>"#
    ))
}

fn luggage(run: &Run, what: &str) -> u64 {
    run.sections["luggage"].get(what).and_then(Value::as_u64).unwrap_or_default()
}

/// How the run ended, in one line.
fn outcome(run: &Run) -> String {
    let collisions = run.sections.get("collisions").cloned().unwrap_or(json!({"vertex": 0, "swap": 0}));
    let collided = collisions["vertex"].as_u64().unwrap_or(0) + collisions["swap"].as_u64().unwrap_or(0);
    let ignored = run.sections.get("messages").map(|messages| format!(", messages {messages}")).unwrap_or_default();
    format!(
        "{:?}: {} of {} delivered, {} given up, {collided} collisions{ignored}",
        run.outcome.status,
        luggage(run, "delivered"),
        luggage(run, "requested"),
        luggage(run, "given_up"),
    )
}

const THREE: &str = "at 0.5s luggage (2,2) to (8,2); at 0.5s luggage (2,3) to (8,3); at 0.5s luggage (2,1) to (8,1);";
const TEAM: [(&str, &str); 3] = [("Robot1", ""), ("Robot2", ""), ("Robot3", "")];

/// Runs a fleet with a fault at each of these times, in tenths of a second, and expects that each run ends like this,
/// within two minutes, and keeps the invariants.
#[track_caller]
fn expect_ends(
    sites: &[Site],
    robots: &[(&str, &str)],
    times: impl Iterator<Item = u64> + Clone,
    expected: &str,
    faults: impl Fn(u64) -> String,
) {
    let mut wrong = String::new();
    for site in sites {
        for tenths in times.clone() {
            let fleet = fleet(*site, &format!("{THREE} {}; at 15s end", faults(tenths)), robots);
            let run = fleet.run(tenths, LIMIT);
            let ended = outcome(&run);
            // Without a world a robot that begins anew starts at its charger, wherever it was.
            let violations = if site.has_world { fleet.violations(tenths, LIMIT) } else { String::new() };
            if ended != expected || run.time_s > 120.0 || !violations.is_empty() {
                let (time, reasons) = (run.time_s, &run.outcome.reasons);
                wrong += &format!("{site:?} at {tenths}: {ended}, {time} s, {reasons:?} {violations}\n");
            }
        }
    }
    assert!(wrong.is_empty(), "expected {expected}:\n{wrong}");
}

fn at(tenths: u64) -> String {
    format!("at {}.{}s", tenths / 10, tenths % 10)
}

#[test]
fn a_robot_fails_for_good_at_any_time() {
    let expected = "Failed: 3 of 3 delivered, 0 given up, 0 collisions";
    expect_ends(&SITES, &TEAM, (3..60).step_by(3), expected, |tenths| format!("{} fail Robot2", at(tenths)));
}

#[test]
fn a_robot_crashes_for_good_which_is_no_failure_of_the_run() {
    let expected = "Done: 3 of 3 delivered, 0 given up, 0 collisions";
    expect_ends(&SITES, &TEAM, (3..60).step_by(11), expected, |tenths| format!("{} crash Robot2", at(tenths)));
}

#[test]
fn a_robot_starts_again_without_what_it_knew() {
    let expected = "Done: 3 of 3 delivered, 0 given up, 0 collisions";
    for pause in ["10ms", "150ms", "2s"] {
        let crash = |tenths: u64| format!("{} crash Robot2 restart {pause}", at(tenths));
        expect_ends(&SITES, &TEAM, (4..60).step_by(7), expected, crash);
    }
}

#[test]
fn a_robot_that_is_alone_starts_again_without_what_it_knew() {
    let expected = "Done: 3 of 3 delivered, 0 given up, 0 collisions";
    let crash = |tenths: u64| format!("{} crash Robot2 restart 1500ms", at(tenths));
    expect_ends(&SITES, &TEAM[1..2], (7..150).step_by(11), expected, crash);
}

#[test]
fn a_robot_goes_on_from_what_it_saved() {
    let expected = "Done: 3 of 3 delivered, 0 given up, 0 collisions";
    let robots = [TEAM[0], ("Robot2", r#"<property name="restart">onFailure</property>"#), TEAM[2]];
    expect_ends(&SITES, &robots, (3..60).step_by(11), expected, |tenths| format!("{} fail Robot2", at(tenths)));
}

#[test]
fn two_robots_fail() {
    let expected = "Failed: 3 of 3 delivered, 0 given up, 0 collisions";
    for between in [0, 3, 10, 25] {
        let both = |tenths: u64| format!("{} fail Robot1; {} fail Robot2", at(tenths), at(tenths + between));
        expect_ends(&SITES, &TEAM, (6..60).step_by(9), expected, both);
    }
}

#[test]
fn a_robot_breaks_and_who_helps_it_fails() {
    let expected = "Failed: 3 of 3 delivered, 0 given up, 0 collisions";
    for helper in ["Robot1", "Robot3"] {
        let both = |tenths: u64| format!("at 2s breakdown 2; {} fail {helper}", at(tenths));
        expect_ends(&SITES, &TEAM, (19..80).step_by(7), expected, both);
    }
}

#[test]
fn all_robots_fail_and_what_they_leave_is_given_up() {
    for site in SITES {
        let all = "at 0.8s fail Robot1; at 0.8s fail Robot2; at 0.9s fail Robot3; at 9s end";
        let run = fleet(site, &format!("{THREE} {all}"), &TEAM).run(1, LIMIT);
        assert_eq!(outcome(&run), "Failed: 0 of 3 delivered, 3 given up, 0 collisions", "{site:?}");
        assert!(run.time_s < 20.0);
    }
}

#[test]
fn a_run_without_its_master_or_world_ends_and_says_what_it_waits_for() {
    let mut ends = String::new();
    for (component, tenths) in [("Master", 2), ("Master", 10), ("World", 10), ("Environment", 10), ("MasterRobot", 10)]
    {
        let fleet = fleet(SITES[0], &format!("{THREE} {} fail {component}; at 9s end", at(tenths)), &TEAM);
        // With a limit a run waits for what may still come.
        let run = fleet.run(1, Duration::MAX);
        ends += &format!("{component} at {tenths}: {}\n  {}\n", outcome(&run), run.outcome.reasons.join("\n  "));
    }
    expect_test::expect![[r#"
        Master at 2: Failed: 0 of 0 delivered, 0 given up, 0 collisions
          component `Master` failed: this execution fails by fault injection
          nothing has happened since 75.500 s, and nothing more can: `World` waits for a robot to carry luggage 1 and 2 more pieces; `Environment` waits for a master of the environment to pass on luggage 1 and 2 more pieces on `ELMSTOPIC`; `MasterRobot` waits for landings and take-offs; `Robot1` and 2 more wait for luggage
        Master at 10: Failed: 3 of 3 delivered, 0 given up, 0 collisions
          component `Master` failed: this execution fails by fault injection
        World at 10: Failed: 0 of 3 delivered, 0 given up, 0 collisions
          component `World` failed: this execution fails by fault injection
          nothing has happened since 100.800 s, and nothing more can: `Environment` and 1 more wait for a robot to carry luggage 1 and 2 more pieces; `MasterRobot` waits for landings and take-offs; `Robot1` and 2 more wait for its world, which does not run
        Environment at 10: Failed: 3 of 3 delivered, 0 given up, 0 collisions
          component `Environment` failed: this execution fails by fault injection
        MasterRobot at 10: Failed: 3 of 3 delivered, 0 given up, 0 collisions
          component `MasterRobot` failed: this execution fails by fault injection
    "#]].assert_eq(&ends);
}

/// Robots whose world does not run cannot even say that their battery is empty, and hand back all luggage.
#[test]
fn a_master_that_assigns_asks_robots_without_a_world_ever_less_often() {
    let later = "at 3s fail World; at 9s luggage (3,3) to (5,5); at 9s luggage (5,3) to (5,7)";
    for assignment in ["oldest", "optimal"] {
        let fleet = fleet_with(SITES[0], assignment, &format!("{THREE} {later}"), &TEAM);
        let run = fleet.with_severity("S5028", "allow").run(1, LIMIT);
        let told = run.standstill.as_ref().unwrap_or_else(|| panic!("{assignment}: {}", run.log())).to_string();
        assert!(told.contains("`Robot1` and 2 more wait for its world, which does not run"), "{assignment}: {told}");
    }
}

#[test]
fn a_robot_is_stopped_since_it_is_late() {
    let expected = "Failed: 3 of 3 delivered, 0 given up, 0 collisions";
    let robots = [TEAM[0], ("Robot2", r#"<property name="overrun">stop</property>"#), TEAM[2]];
    expect_ends(&SITES, &robots, (4..60).step_by(11), expected, |tenths| format!("{} for 3s stall Robot2", at(tenths)));
}

#[test]
fn a_robot_breaks_while_it_hangs() {
    let expected = "Done: 3 of 3 delivered, 0 given up, 0 collisions";
    let both = |tenths: u64| format!("{} for 1700ms stall Robot2; {} breakdown 2", at(tenths), at(tenths + 4));
    expect_ends(&SITES[..2], &TEAM, (4..40).step_by(3), expected, both);
}

/// Stops another component at a time, as an operator does with `saoms stop`.
#[derive(Class)]
#[class(name = "test.Operator", periodic)]
struct Operator {
    #[properties]
    properties: OperatorProperties,
    #[reference]
    task: TaskInterfaceReference,
}

#[derive(Debug, Properties)]
struct OperatorProperties {
    at: Duration,
}

impl Component for Operator {
    type Properties = OperatorProperties;

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        if context.due() == Time::START + self.properties.at {
            self.task.unschedule(context)?;
        }
        Ok(())
    }
}

#[test]
fn an_operator_stops_a_robot_at_any_time() {
    for site in SITES {
        for tenths in (3..60).step_by(3) {
            let stop = component("Operator", "X", &property("at", &format!("{tenths}00ms")))
                .replace("saoms.X", "test.Operator")
                .replace("</component>", r#"<reference name="task" target="Robot2"/></component>"#);
            let run = fleet_and(&stop, site, "robots", &format!("{THREE} at 15s end"), &TEAM).run(tenths, LIMIT);
            let context = format!("{site:?} at {tenths}: {}", run.log());
            assert_eq!(outcome(&run), "Done: 3 of 3 delivered, 0 given up, 0 collisions", "{context}");
            let robot = run.components.iter().find(|one| one.name == "Robot2").unwrap();
            assert!(robot.executions <= tenths && run.time_s < 120.0, "{context}");
        }
    }
}

#[test]
fn a_sleeping_robot_is_woken_for_what_the_only_one_awake_leaves() {
    let expected = "Failed: 3 of 3 delivered, 0 given up, 0 collisions";
    let robots = [TEAM[0], ("Robot2", r#"<property name="asleep">true</property>"#)];
    expect_ends(&SITES, &robots, (5..60).step_by(8), expected, |tenths| format!("{} fail Robot1", at(tenths)));
}

#[test]
fn a_robot_that_refused_luggage_brings_it_from_where_its_carrier_stopped() {
    let at = |x: &str| property("chargeX", x) + &property("chargeY", "1");
    let robots =
        [("Robot1", at("0") + &property("discharge", "1.5")), ("Robot2", at("20") + &property("discharge", "0.2"))];
    for fault in ["breakdown 2", "crash Robot2"] {
        let map = format!("{0}&#10;{0}&#10;{0}", ".".repeat(45));
        let scenario = format!("at 0.5s luggage (40,0) to (2,0); at 6.2s {fault}; at 9s end");
        let mut components = component("World", "World", &property("map", &map));
        components += &component("Master", "MasterEnvironment", "");
        components += &component("Environment", "Environment", &property("scenario", &scenario));
        for (robot, more) in &robots {
            components +=
                &component(robot, "Robot", &(r#"<reference name="world" target="World"/>"#.to_owned() + more));
        }
        let run = composite(&components).run(1, LIMIT);
        assert!(run.log().contains("Robot1: cannot carry luggage 1 from (40,0)"), "{}", run.log());
        assert_eq!(outcome(&run), "Done: 1 of 1 delivered, 0 given up, 0 collisions", "{fault}: {}", run.log());
    }
}

/// A robot whose saved state cannot be read.
#[derive(Class)]
#[class(name = "test.Forgetful", periodic, saves)]
struct Forgetful {
    #[extends]
    robot: Robot,
}

impl Component for Forgetful {
    type Properties = Own<Self>;

    fn restore(&mut self, _: &Saved) -> Result<(), Failure> {
        Err(Failure::new("this version cannot read it"))
    }
}

#[test]
fn a_robot_whose_saved_state_cannot_be_read_begins_anew() {
    for tenths in (4..60).step_by(5) {
        let restart = property("restart", "onFailure");
        let mut components = component("World", "World", &property("moveTime", "150ms"));
        components += &component("Master", "MasterEnvironment", "");
        let scenario = format!("{THREE} {} fail Robot2; at 15s end", at(tenths));
        components += &component("Environment", "Environment", &property("scenario", &scenario));
        let robot = r#"<reference name="world" target="World"/>"#.to_owned() + &property("discharge", "0.1") + &restart;
        components += &component("Robot1", "Robot", &robot);
        components += &component("Robot2", "Robot", &robot).replace("saoms.Robot", "test.Forgetful");
        let run = composite(&components).run(tenths, LIMIT);
        let context = format!("{tenths}: {}", run.log());
        assert_eq!(outcome(&run), "Done: 3 of 3 delivered, 0 given up, 0 collisions", "{context}");
        assert!(context.contains("could not continue with its saved state: this version cannot read it"), "{context}");
    }
}

/// Faults of a run with this seed, and whether a robot is left that none of them concerns for good.
fn drawn(seed: u64, robots: u32, has_zone: bool) -> (String, bool) {
    let mut chance = Chance::new(seed);
    let mut lines = String::new();
    let mut out = std::collections::BTreeSet::new();
    for _ in 0..=chance.below(4) {
        let (time, robot) = (5 + chance.below(120), 1 + chance.below(u64::from(robots)));
        let pause = 10 + chance.below(3000);
        let (fault, is_lasting) = match chance.below(5) {
            0 => (format!("fail Robot{robot}"), true),
            1 => (format!("crash Robot{robot}"), true),
            2 => (format!("breakdown {robot}"), true),
            3 => (format!("crash Robot{robot} restart {pause}ms"), false),
            _ => (format!("for {pause}ms stall Robot{robot}"), false),
        };
        if is_lasting {
            out.insert(robot);
        }
        lines += &format!("{} {fault}; ", at(time));
    }
    // Without a zone robots may collide if messages are late (S5024).
    if has_zone && chance.below(2) == 0 {
        let (rate, delay) = (chance.below(30), 10 + chance.below(70));
        lines += &format!("at 1s for 20s lose {rate} %; at 1s for 20s delay 10ms to {delay}ms; ");
    }
    (lines, out.len() < robots as usize)
}

#[test]
fn whatever_fails_no_luggage_is_lost() {
    let seeds = if std::env::var_os("SAOMS_THOROUGH").is_some() { 0..300 } else { 0..30 };
    let mut wrong = String::new();
    for seed in seeds {
        let site = SITES[(seed % 2) as usize];
        let (faults, is_one_left) = drawn(seed, 4, site.has_zone);
        let scenario =
            format!("from 0.5s every 0.5s..2s 10 times luggage (1,1)..(8,8) to (1,1)..(8,8); {faults} at 40s end");
        let saves = r#"<property name="restart">onFailure</property><property name="restartLimit">1</property>"#;
        let robots = [("Robot1", ""), ("Robot2", saves), ("Robot3", ""), ("Robot4", saves)];
        let assignment = ["robots", "oldest", "optimal"][(seed / 2 % 3) as usize];
        let fleet = fleet_with(site, assignment, &scenario, &robots);
        let run = fleet.run(seed, LIMIT);
        let violations = fleet.violations(seed, LIMIT);
        let (delivered, given_up) = (luggage(&run, "delivered"), luggage(&run, "given_up"));
        let is_all = delivered + given_up == luggage(&run, "requested") && (given_up == 0 || !is_one_left);
        if !is_all || run.time_s > 600.0 || !violations.is_empty() {
            wrong += &format!(
                "seed {seed}, {site:?}, {assignment}: {faults}{}, {} s {violations}\n",
                outcome(&run),
                run.time_s
            );
        }
    }
    assert!(wrong.is_empty(), "{wrong}");
}
