//! Fleets that cannot bring all luggage, because robots break, sleep, get in each other's way or live on too small
//! batteries: each run ends by itself, and luggage that is not brought is reported.

use std::fmt::Write;
use std::time::Duration;

use saoms_api::Chance;
use saoms_core::report::{RunReport, RunStatus};
use saoms_testkit::Fleet;

/// A robot gives up after some hundred executions of at most 2 s, one after the other.
const LIMIT: Duration = Duration::from_secs(200_000);

fn component(id: &str, class: &str, period: u64, more: &str) -> String {
    format!(
        r#"<component name="{id}"><implementation.rust class="saoms.{class}"/>
        <property name="ID">{id}</property><property name="period">{period}</property>{more}</component>
"#
    )
}

fn property(name: &str, value: impl std::fmt::Display) -> String {
    format!(r#"<property name="{name}">{value}</property>"#)
}

fn composite(components: &str) -> Fleet {
    Fleet::of_text(format!(
        r#"<composite xmlns="http://docs.oasis-open.org/ns/opencsa/sca/200912" name="f" targetNamespace="urn:f">
{components}</composite>"#
    ))
}

fn luggage(report: &RunReport, what: &str) -> u64 {
    report.sections["luggage"].get(what).and_then(serde_json::Value::as_u64).unwrap_or_default()
}

/// The run ended by itself, without a collision, and whatever was not delivered is given up.
fn assert_ended(report: &RunReport, context: &str) {
    let expected = if luggage(report, "open") > 0 { RunStatus::Incomplete } else { RunStatus::Done };
    assert_eq!(report.outcome.status, expected, "{context}: {:?}, {:?}", report.outcome, report.sections);
    assert_eq!(luggage(report, "given_up"), luggage(report, "open"), "{context}: {:?}", report.sections);
    assert_eq!(
        luggage(report, "delivered") + luggage(report, "open"),
        luggage(report, "requested"),
        "{context}: {:?}",
        report.sections
    );
    assert_eq!(report.sections["collisions"], serde_json::json!({"vertex": 0, "swap": 0}), "{context}");
}

const WIRE: &str = r#"<reference name="world" target="World"/>"#;

#[test]
fn sleepers_try_what_those_who_are_awake_refused() {
    // Only who drives finds out that a move takes four executions: few pieces are in reach.
    let scenario = "from 1s every 1s 10 times luggage (1,0)..(10,10) to (1,0)..(10,10); at 4s breakdown 2";
    let mut components =
        component("World", "World", 100, &(property("moveTime", "350ms") + &property("handlingTime", "700ms")));
    components += &component("Master", "MasterEnvironment", 100, "");
    components += &component("MasterRobot", "MasterRobot", 100, "");
    components += &component("Environment", "Environment", 100, &property("scenario", scenario));
    for (robot, more) in [("Robot1", ""), ("Robot2", ""), ("Robot3", r#"<property name="asleep">true</property>"#)] {
        components += &component(robot, "Robot", 100, &format!("{more}{WIRE}"));
    }
    let fleet = composite(&components);
    for seed in 0..8 {
        let run = fleet.run(seed, LIMIT);
        assert_ended(&run, &format!("seed {seed}"));
        // A robot that carries it says so itself.
        let given_up = |line: &&str| line.contains("gives up luggage") || line.contains(" any more: ");
        let told = run.log().lines().filter(given_up).count();
        assert_eq!(told as u64, luggage(&run, "open"), "seed {seed}: each piece is reported once");
    }
}

#[test]
fn a_robot_whose_charger_is_behind_other_robots_charges_at_a_free_one() {
    // With this seed a robot that goes to charge has to make way for long.
    let run = Fleet::of_file("composites/scenario4.composite").run(1088, LIMIT);
    assert!(run.log().contains("this time: its own is behind other robots"), "{}", run.log());
    assert_eq!((luggage(&run, "delivered"), &run.sections["stranded"]), (100, &serde_json::json!(0)));
}

/// A fleet in a small maze: breakdowns, slow hardware, sleepers, different periods.
fn fleet(seed: u64) -> Fleet {
    let mut chance = Chance::new(seed);
    let mut pick = |values: &[u64]| *chance.pick(values).unwrap();
    let period = pick(&[100, 500, 1000]);
    let (robots, width) = (pick(&[1, 2, 3, 4, 5, 6, 7]), pick(&[5, 6, 8, 11]));
    let height = pick(&[6, 8, 11]).max(robots + 1);
    let move_time = pick(&[0, 0, 0, 2, 7]) * period / 2;
    let handling_time = pick(&[0, 2, 7]) * period;
    let (blocked, pieces) = (pick(&[0, 0, 4, 8, 14]), pick(&[1, 3, 6, 12]));
    let breakdowns = pick(&[0, 1, 2, robots]);
    let gap = pick(&[1, 5, 20]) * period / 5;

    let mut block = || (chance.range(1..width), chance.range(0..height));
    let walls: Vec<_> = (0..blocked).map(|_| block()).collect();
    let mut free = || std::iter::repeat_with(&mut block).find(|block| !walls.contains(block)).unwrap();
    let mut scenario = String::new();
    for piece in 0..pieces {
        let from = free();
        let to = std::iter::repeat_with(&mut free).find(|to| *to != from).unwrap();
        let ((x, y), (to_x, to_y)) = (from, to);
        writeln!(scenario, "at {}ms luggage ({x},{y}) to ({to_x},{to_y})", 1000 + piece * gap).unwrap();
    }
    for robot in 1..=breakdowns.min(robots) {
        writeln!(scenario, "at {}ms breakdown {robot}", period + chance.below(180 * period)).unwrap();
    }

    let mut world = property("width", width) + &property("height", height);
    world += &property("moveTime", format!("{move_time}ms"));
    world += &property("handlingTime", format!("{handling_time}ms"));
    if !walls.is_empty() {
        let values = walls.iter().map(|(x, y)| format!("<value>({x},{y})</value>"));
        world += &property("blocked", values.collect::<String>());
    }
    let mut components = component("World", "World", period, &world);
    components += &component("Master", "MasterEnvironment", period, "");
    if chance.chance(0.8) {
        components += &component("MasterRobot", "MasterRobot", period, "");
    }
    components += &component("Environment", "Environment", period, &property("scenario", scenario));
    for robot in 1..=robots {
        let mut more = property("asleep", chance.chance(0.35));
        more += &property("battery", *chance.pick(&[100, 100, 100, 60, 30]).unwrap());
        more += &property("discharge", *chance.pick(&[2, 2, 2, 1, 3]).unwrap());
        more += &property("delay", chance.below(period));
        let period = period * chance.pick(&[1, 1, 1, 2]).unwrap();
        components += &component(&format!("Robot{robot}"), "Robot", period, &format!("{more}{WIRE}"));
    }
    composite(&components)
}

#[test]
fn every_fleet_comes_to_an_end() {
    let seeds = std::env::var("SAOMS_SEEDS").ok().and_then(|seeds| seeds.parse().ok()).unwrap_or(80);
    let mut runs = 0;
    for seed in 0..seeds {
        let fleet = fleet(seed);
        // Luggage that is out of every robot's reach is found before the start.
        if fleet.diagnostics().contains("error") {
            continue;
        }
        assert_ended(&fleet.run(seed, LIMIT), &format!("seed {seed}"));
        runs += 1;
    }
    assert!(runs * 2 > seeds, "only {runs} of {seeds} fleets could run");
}

#[test]
fn a_classic_robot_before_a_wall_breaks_down() {
    let components = component("World", "World", 100, &property("map", "\n.....\n.@@@.\n....."))
        + &component("Master", "MasterEnvironment", 100, "")
        + &component("Environment", "Environment", 100, &property("scenario", "at 1s luggage (0,1) to (4,1)"))
        + &component("Robot1", "Robot", 100, &format!("{}{WIRE}", property("policy", "classic")))
        + &component("Robot2", "Robot", 100, &format!("{}{WIRE}", property("policy", "classic")));
    let run = composite(&components).run(1, LIMIT);
    assert_eq!(run.outcome.status, RunStatus::Incomplete, "{:?}", run.outcome);
    assert_eq!((luggage(&run, "open"), luggage(&run, "given_up")), (1, 1), "{}", run.log());
    assert!(run.log().contains("hardware keeps failing at (0,1): asks for help"), "{}", run.log());
}
