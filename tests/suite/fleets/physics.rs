//! Physics apart from control: robots whose battery discharges by distance and time, in a world that sets their speed,
//! behave alike at any period.

use std::fmt::Write as _;
use std::time::Duration;

use saoms_testkit::Fleet;

const PHYSICAL: &str = "<property name=\"dischargePerBlock\" value=\"1\"/>\
     <property name=\"dischargePerSecond\" value=\"0.2\"/><property name=\"chargePerSecond\" value=\"5\"/>";

/// A fleet on 20 x 20 blocks, all of one period.
fn fleet(robots: u32, period: &str, move_time: &str, battery: &str, scenario: &str) -> Fleet {
    let mut text =
        "<composite xmlns=\"http://docs.oasis-open.org/ns/opencsa/sca/200912\" targetNamespace=\"urn:t\" name=\"t\">\n"
            .to_owned();
    let mut add = |name: &str, class: &str, inside: &str| {
        writeln!(
            text,
            "<component name=\"{name}\"><implementation.rust class=\"{class}\"/><property name=\"ID\" value=\"{name}\"/>\
             <property name=\"period\" value=\"{period}\"/>{inside}</component>"
        )
        .unwrap();
    };
    let world = format!(
        "<property name=\"width\" value=\"20\"/><property name=\"height\" value=\"20\"/>\
         <property name=\"moveTime\" value=\"{move_time}\"/><property name=\"handlingTime\" value=\"2s\"/>"
    );
    add("World", "saoms.World", &world);
    add("Master", "saoms.MasterEnvironment", "");
    add("Environment", "saoms.Environment", &format!("<property name=\"scenario\">{scenario}</property>"));
    for robot in 1..=robots {
        add(&format!("Robot{robot}"), "saoms.Robot", &format!("{battery}<reference name=\"world\" target=\"World\"/>"));
    }
    Fleet::of_text(text + "</composite>")
}

#[test]
fn makespans_differ_by_two_percent_at_most_at_half_the_period() {
    const WORK: &str = "at 1s 24 times luggage (5,1)..(9,19) to (12,1)..(19,19)";
    for (robots, move_time) in [(1, "500ms"), (3, "1s"), (6, "1s"), (6, "500ms")] {
        let [fast, slow] = ["50ms", "100ms"].map(|period| {
            let run = fleet(robots, period, move_time, PHYSICAL, WORK).run(5, Duration::from_hours(1));
            assert_eq!(run.count("stranded"), 0);
            (run.count("luggage.delivered"), run.time_s)
        });
        assert_eq!(fast.0, slow.0, "{robots} robots, {move_time}: pieces delivered");
        let difference = (fast.1 - slow.1).abs() / slow.1;
        assert!(difference <= 0.02, "{robots} robots, {move_time}: {} s and {} s", fast.1, slow.1);
    }
}

/// Where robots compete for pieces, the one that is first can be another one, and a single run differs as another seed
/// does. The mean over seeds does not.
#[test]
fn mean_makespans_of_competing_robots_differ_by_two_percent_at_most_at_half_the_period() {
    const WORK: &str = "from 1s every 4s 12 times luggage (1,1)..(19,19) to (1,1)..(19,19)";
    let [fast, slow] = ["50ms", "100ms"].map(|period| {
        let fleet = fleet(4, period, "500ms", &PHYSICAL.replace("\"1\"", "\"0.5\""), WORK);
        (0..40).map(|seed| fleet.run(seed, Duration::from_hours(1)).time_s).sum::<f64>()
    });
    assert!((fast - slow).abs() / slow <= 0.02, "{fast} s and {slow} s");
}

/// A robot decides at other moments, by less than a period for each action; its choice does not depend on them.
#[test]
fn a_lone_robot_brings_waiting_luggage_in_the_same_order_at_any_period() {
    const WORK: &str = "at 1s luggage (3,1) to (3,10)\nat 2s luggage (7,7) to (1,9)\nat 3s luggage (5,2) to (9,9)\n\
         then 5s every 20s 10 times luggage (2,2) to (9,8)";
    let [first, second, third] = ["20ms", "50ms", "100ms"].map(|period| {
        let battery = PHYSICAL.replace("\"0.2\"", "\"0.02\"").replace("\"1\"", "\"0.5\"");
        let run = fleet(1, period, "500ms", &battery, WORK).run(0, Duration::from_hours(1));
        let taken = run.log_of("Robot1").into_iter().filter(|line| line.contains("takes luggage"));
        taken.map(|line| line.split_once("takes ").unwrap().1.to_owned()).collect::<Vec<_>>()
    });
    assert_eq!(first.len(), 13);
    assert_eq!(first, second);
    assert_eq!(second, third);
}

#[test]
fn a_job_costs_its_blocks_and_its_time() {
    // From (0,1) 4 moves to collect at (4,1), 3 to deposit at (7,1), 7 back: 14 %, and 0.2 % in each second off the
    // charger: 14 s of moves, 4 s of handling, and at most half a second of decisions. The robot says so after the
    // first execution at the charger, which gains 0.25 %.
    let run =
        fleet(1, "50ms", "1s", PHYSICAL, "at 1s luggage (4,1) to (7,1)\nat 5min end").run(1, Duration::from_secs(60));
    let journal = run.journal();
    let charges = journal.of("Robot1").symptoms().with("is at its charger with").last().unwrap();
    let text = charges.text().to_owned();
    let level: f64 = text.split_whitespace().find_map(|word| word.parse().ok()).unwrap();
    let least = 100.0 - 14.0 - 0.2 * 18.5 + 0.25;
    assert!((least..=least + 0.1).contains(&level), "{text}: not from {least}");
}

#[test]
fn the_range_of_a_battery_by_distance_and_time_is_known_before_the_run() {
    let found = |battery: &str| fleet(1, "100ms", "1s", battery, "at 1s luggage (15,15) to (1,1)").diagnostics();
    assert_eq!(found(PHYSICAL), "");
    let weak = PHYSICAL.replace("\"1\"", "\"2\"");
    assert!(found(&weak).contains(" S5006 "), "{}", found(&weak));
}

#[test]
fn a_battery_is_of_one_kind() {
    let found = |properties: &[&str]| {
        let battery: String =
            properties.iter().map(|name| format!("<property name=\"{name}\" value=\"1\"/>")).collect();
        fleet(1, "100ms", "1s", &battery, "at 1s luggage (2,1) to (3,1)").shown()
    };
    for (properties, expected) in [
        (&["discharge", "dischargePerBlock", "chargePerSecond"][..], "per execution and also by distance or time"),
        (&["dischargePerSecond"], "`chargePerSecond` is missing"),
        (&["dischargePerBlock"], "`chargePerSecond` is missing"),
        (&["chargePerSecond"], "the battery discharges per execution, so it also charges per execution"),
    ] {
        let shown = found(properties);
        assert!(shown.contains(expected) && shown.contains("help: "), "{properties:?}: {shown}");
    }
}
