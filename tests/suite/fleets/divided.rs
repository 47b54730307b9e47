//! Masters that divide the luggage of a site by its zones.

use std::time::Duration;

use saoms_core::report::RunStatus;
use saoms_testkit::{Fleet, Run};

const HOUR: Duration = Duration::from_secs(3600);
const MINUTE: Duration = Duration::from_secs(60);

/// A component with an ID, a period of 100 ms, these properties and this scenario or reference.
fn component(class: &str, id: &str, properties: &str, rest: &str) -> String {
    let all = format!("ID={id} period=100 {properties}");
    let pairs = all.split_whitespace().map(|property| property.split_once('=').unwrap());
    let properties: String =
        pairs.map(|(name, value)| format!("<property name=\"{name}\">{value}</property>")).collect();
    format!("<component name=\"{id}\"><implementation.java class=\"{class}\"/>{properties}{rest}</component>\n")
}

const WORLD: &str = "<reference name=\"world\" target=\"World\"/>";

/// A site of 24 x 24 blocks with four zones, the master of each, and robots with these chargers and properties.
fn site(scenario: &str, robots: &[(u32, u32)], robot: &str) -> Fleet {
    Fleet::of_text(text(scenario, robots, robot))
}

fn text(scenario: &str, robots: &[(u32, u32)], robot: &str) -> String {
    let mut text = String::from(
        "<composite xmlns=\"http://docs.oasis-open.org/ns/opencsa/sca/200912\" name=\"t\" targetNamespace=\"urn:t\">",
    );
    text += &component("saoms.World", "World", "width=24 height=24 moveTime=200ms", "");
    for (number, (x, y)) in (1..).zip([(0, 0), (12, 0), (0, 12), (12, 12)]) {
        let properties = format!("number={number} x={x} y={y} width=12 height=12");
        text += &component("saoms.Zone", &format!("Zone{number}"), &properties, WORLD);
        let properties = format!("zone={number} assignment=optimal restart=onFailure");
        text += &component("saoms.MasterEnvironment", &format!("Master{number}"), &properties, "");
    }
    text += &component("saoms.MasterRobot", "Crew", "", "");
    let scenario = format!("<property name=\"scenario\">{scenario}</property>");
    text += &component("saoms.Environment", "Environment", "", &scenario);
    for (number, (x, y)) in (1..).zip(robots) {
        let properties = format!("chargeX={x} chargeY={y} chargePerSecond=5 {robot}");
        text += &component("saoms.Robot", &format!("Robot{number}"), &properties, WORLD);
    }
    text + "</composite>"
}

/// Runs it; all luggage is collected and delivered once, and no robots meet.
fn delivers(fleet: &Fleet, seed: u64, pieces: i64) -> Run {
    let run = fleet.run(seed, HOUR);
    assert_eq!(run.outcome.status, RunStatus::Done, "{:?}\n{}", run.outcome, run.log());
    let count = |name: &str| run.count(name);
    assert_eq!((count("luggage.requested"), count("luggage.delivered")), (pieces, pieces), "{}", run.log());
    assert_eq!((count("luggage.open"), count("collisions.vertex")), (0, 0), "{}", run.log());
    let log = run.log();
    for luggage in 1..=pieces {
        let collected = log.matches(&format!("collected luggage {luggage} at")).count();
        assert_eq!(collected, 1, "luggage {luggage}: {log}");
    }
    run
}

const CORNERS: [(u32, u32); 8] = [(0, 0), (5, 0), (23, 0), (18, 0), (0, 23), (5, 23), (23, 23), (18, 23)];

#[test]
fn each_zone_assigns_the_luggage_that_is_collected_there() {
    let scenario = "at 1s landing 4; at 1s 20 times luggage (0,0)..(23,23) to (0,0)..(23,23); \
        from 5s every 1s 20 times luggage (10,10)..(13,13) to (0,0)..(23,23)";
    let fleet = site(scenario, &CORNERS, "dischargePerBlock=0.1");
    for seed in 1..=3 {
        let run = delivers(&fleet, seed, 40);
        for line in run.log_of("Environment") {
            let Some((luggage, at)) = line.strip_prefix("luggage ").and_then(|rest| rest.split_once(" waits at ("))
            else {
                continue;
            };
            let (x, y) = at.split_once(')').unwrap().0.split_once(',').unwrap();
            let half = |text: &str| u32::from(text.parse::<u32>().unwrap() >= 12);
            let zone = 1 + half(x) + 2 * half(y);
            for number in 1..=4 {
                let log = run.log_of(&format!("Master{number}")).join("\n");
                let assigns = log.contains(&format!("assigns luggage {luggage} to robot"));
                assert_eq!(assigns, number == zone, "luggage {luggage} by master {number}: {log}");
            }
        }
        // A landing is passed on once.
        assert_eq!(run.log_of("Crew").join("\n").matches("needs 2 more").count(), 1, "{}", run.log());
    }
    fleet.expect_invariants(1..6, HOUR);
}

#[test]
fn luggage_finds_robots_of_zones_far_away() {
    let scenario = "at 1s luggage (23,23) to (20,20); at 2s luggage (12,23) to (12,3)";
    delivers(&site(scenario, &[(0, 0), (1, 0)], "dischargePerBlock=0.1"), 1, 2);
}

#[test]
fn luggage_that_no_robot_of_the_site_can_bring_is_given_up() {
    let fleet = site("at 1s luggage (23,23) to (20,20)", &[(0, 0), (5, 0)], "dischargePerBlock=2");
    let run = fleet.with_severity("S5006", "allow").run(1, HOUR);
    assert_eq!(run.outcome.status, RunStatus::Incomplete, "{}", run.log());
    assert_eq!((run.count("luggage.given_up"), run.count("luggage.delivered")), (1, 0), "{}", run.log());
}

#[test]
fn luggage_of_a_robot_that_breaks_in_another_zone_is_brought() {
    for at in (2..=8).map(|second| format!("{second}s")) {
        let scenario = format!("at 1s luggage (3,2) to (20,2); at {at} breakdown Robot1");
        let run = site(&scenario, &[(2, 2), (23, 23)], "dischargePerBlock=0.1").run(1, HOUR);
        let ended = (run.count("luggage.delivered"), run.count("luggage.open"));
        assert_eq!(ended, (1, 0), "{at}: {}", run.log());
    }
}

#[test]
fn a_person_is_told_once_of_a_failed_robot_of_which_the_world_says_nothing() {
    let scenario = "at 1s luggage (3,2) to (20,2); at 2s violate 100 % on REMOVALTOPIC; at 3s crash Robot1";
    let log = site(scenario, &[(2, 2), (23, 23)], "dischargePerBlock=0.1").run(1, MINUTE).log();
    assert_eq!(log.matches("waits for the world to say what robot 1 left, and where").count(), 1, "{log}");
}

/// Messages are lost, late and doubled, masters, a zone and a robot crash, a robot breaks, and one is cut off.
#[test]
fn a_storm_loses_no_luggage_of_masters_that_divide_it() {
    let scenario = "at 1s for 40s lose 20 %; at 1s for 40s delay 10ms to 300ms; at 1s for 40s duplicate 10 %; \
        at 2s..20s breakdown Robot1; at 5s..30s crash Master1 restart 2s; at 5s..30s crash Master2 restart 2s; \
        at 5s..30s crash Zone2 restart 2s; at 5s..30s crash Robot3 restart 2s; \
        at 5s..30s for 5s part Robot4 from Robot*, Zone*, Master*; \
        at 1s 16 times luggage (0,0)..(23,23) to (0,0)..(23,23); \
        from 5s every 2s 16 times luggage (8,8)..(15,15) to (0,0)..(23,23)";
    let fleet = site(scenario, &CORNERS, "dischargePerBlock=0.1 restart=onFailure");
    fleet.expect_invariants(1..4, MINUTE * 3);
    for seed in 4..=5 {
        let run = fleet.run(seed, MINUTE * 3);
        let ended = (run.count("luggage.delivered"), run.count("luggage.open"), run.count("luggage.given_up"));
        assert_eq!(ended, (32, 0, 0), "seed {seed}: {}", run.log());
    }
}

#[test]
fn check_holds_masters_to_the_zones_of_their_site() {
    let site = text("at 1s luggage (3,3) to (5,5)", &[(0, 0)], "dischargePerBlock=0.1");
    let zone = |number: u32| format!("<property name=\"zone\">{number}</property>");
    for (there, instead, found) in [
        (zone(3), zone(2), "`Master3` forwards the same events as `Master2`"),
        (zone(3), String::new(), "`Master3` forwards the same events as `Master1`"),
        (zone(4), zone(5), "the site has no zone 5"),
        (zone(4), zone(5), "luggage in zone 4 is for no master"),
        (zone(1), zone(5), "luggage in zone 1 is for no master"),
    ] {
        let found_here = Fleet::of_text(site.replace(&there, &instead)).diagnostics();
        assert!(found_here.contains("S5010") && found_here.contains(found), "{found}: {found_here}");
    }
    let other =
        site.replace("<property name=\"number\">1<", "<property name=\"number\">9<").replace(&zone(1), &zone(9));
    assert!(Fleet::of_text(other).diagnostics().contains("no master has `zone` 1"));
}

#[test]
fn masters_do_not_call_a_robot_on_its_way_back_and_forth() {
    // The robot passes through the zone of the other master, and says on its last move to luggage that it is there.
    let scenario = "at 1s luggage (10,5) to (3,2); at 3s luggage (14,5) to (14,8); \
        from 4s every 1s 6 times luggage (8,0)..(15,9) to (8,0)..(15,9)";
    for robots in [&[(17, 7)][..], &[(17, 7), (6, 1)]] {
        let text = text(scenario, robots, "dischargePerBlock=0.1").replace(">200ms<", ">500ms<");
        for policy in ["optimal", "oldest"] {
            let run = delivers(&Fleet::of_text(text.replace(">optimal<", &format!(">{policy}<"))), 1, 8);
            for robot in ["Robot1", "Robot2"] {
                // Its own master may have found something better for it.
                let taken = run.log_of(robot).iter().filter(|line| line.starts_with("takes luggage")).count();
                assert!(taken <= 12, "{policy}: {}", run.log());
            }
        }
    }
}
