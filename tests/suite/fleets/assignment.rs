//! Who brings which luggage: robots that decide by themselves, and masters that assign.

use std::time::Duration;

use saoms_core::report::{RunReport, RunStatus};
use saoms_testkit::{Fleet, Run};

const HOUR: Duration = Duration::from_secs(3600);

/// A fleet on an open map of so many columns and rows, with these properties of the master of the environment and these
/// robots, as their chargers and further properties.
fn fleet(side: u32, master: &str, scenario: &str, robots: &[(u32, u32, &str)]) -> Fleet {
    fleet_with(side, "moveTime=200ms", [master, ""], scenario, robots)
}

/// The same with these properties of the world and of both masters, of the environment and of the robots.
fn fleet_with(side: u32, world: &str, masters: [&str; 2], scenario: &str, robots: &[(u32, u32, &str)]) -> Fleet {
    Fleet::of_text(fleet_text(&format!("width={side} height={side}"), world, masters, scenario, robots))
}

/// The same with a map of this size, or one that `world` has.
fn fleet_text(
    size: &str,
    world: &str,
    [master, crew]: [&str; 2],
    scenario: &str,
    robots: &[(u32, u32, &str)],
) -> String {
    let mut text = String::from(
        "<composite xmlns=\"http://docs.oasis-open.org/ns/opencsa/sca/200912\" name=\"t\" targetNamespace=\"urn:t\">",
    );
    let mut add = |class: &str, id: &str, properties: &str, rest: &str| {
        text += &format!("<component name=\"{id}\"><implementation.java class=\"{class}\"/>");
        for property in format!("ID={id} period=100 {properties}").split_whitespace() {
            let (name, value) = property.split_once('=').unwrap();
            text += &format!("<property name=\"{name}\">{value}</property>");
        }
        text += &format!("{rest}</component>\n");
    };
    add("saoms.World", "World", &format!("{size} {world}"), "");
    add("saoms.MasterEnvironment", "Master", master, "");
    add("saoms.MasterRobot", "Crew", crew, "");
    add("saoms.Environment", "Environment", "", &format!("<property name=\"scenario\">{scenario}</property>"));
    for (place, (x, y, properties)) in robots.iter().enumerate() {
        let properties = format!("chargeX={x} chargeY={y} dischargePerBlock=0.1 chargePerSecond=5 {properties}");
        add("saoms.Robot", &format!("Robot{}", place + 1), &properties, "<reference name=\"world\" target=\"World\"/>");
    }
    text + "</composite>"
}

fn count(report: &RunReport, section: &str, name: &str) -> i64 {
    report.sections[section][name].as_i64().unwrap()
}

/// Runs it; all of its luggage is delivered once, and no robots meet.
fn delivers(fleet: &Fleet, seed: u64, pieces: i64) -> Run {
    let run = fleet.run(seed, HOUR);
    assert_eq!(run.outcome.status, RunStatus::Done, "{:?}\n{}", run.outcome, run.log());
    assert_eq!(count(&run, "luggage", "delivered"), pieces, "{}", run.log());
    assert_eq!((count(&run, "luggage", "open"), count(&run, "collisions", "vertex")), (0, 0));
    run
}

/// The luggage that a robot takes, in order.
fn taken(run: &Run, robot: &str) -> Vec<String> {
    let takes = |line: &String| Some(line.split_once("takes luggage ")?.1.split(' ').next()?.to_owned());
    run.log_of(robot).iter().filter_map(takes).collect()
}

#[test]
fn on_a_large_map_luggage_finds_the_robots_that_do_not_hear_of_it() {
    let scenario = "at 1s luggage (95,95) to (60,95); at 1s luggage (1,2) to (3,4); \
        from 40s every 3s 20 times luggage random to random";
    let robots = [(0, 0, ""), (99, 0, ""), (50, 50, "")];
    for seed in 1..=3 {
        let run = delivers(&fleet(100, "", scenario, &robots), seed, 22);
        let log = run.log_of("Master").join("\n");
        assert!(log.contains("assigns luggage 1 to robot 3"), "the closest one: {log}");
        assert!(!log.contains("assigns luggage 2 to"), "who hears of it decides: {log}");
    }
}

#[test]
fn on_a_large_map_luggage_that_no_robot_can_bring_is_given_up() {
    // Robot 1 is far away, and breaks; the range of robot 2 is too small.
    let scenario = "at 1s luggage (95,95) to (60,95); at 3s breakdown Robot1; at 5s luggage (52,50) to (52,52)";
    let robots = [(0, 0, ""), (50, 50, "dischargePerSecond=4")];
    let run = fleet(100, "", scenario, &robots).run(1, HOUR);
    assert_eq!(run.outcome.status, RunStatus::Incomplete, "{}", run.log());
    assert_eq!((count(&run, "luggage", "given_up"), count(&run, "luggage", "delivered")), (1, 1), "{}", run.log());
}

/// Robots at their chargers (0,1), (0,2) and (0,3), without a battery that runs low.
const COLUMN: [(u32, u32, &str); 3] = [(0, 1, ""), (0, 2, ""), (0, 3, "")];

#[test]
fn a_world_that_hears_late_of_luggage_does_not_make_robots_give_it_up() {
    for topic in ["ETOPIC", "ELMSTOPIC"] {
        let scenario = format!("at 0s delay 9s on {topic} from * to World; at 100ms luggage (2,1) to (3,10)");
        let run = delivers(&fleet(11, "", &scenario, &COLUMN), 1, 1);
        assert!(run.time_s < 15.0 && !run.log().contains("there is no luggage"), "{topic}: {}", run.log());
    }
}

#[test]
fn luggage_that_was_taken_before_the_master_heard_that_it_was_given_back_is_requested_again() {
    // Robot 1 finds no luggage, and gives it back. Robot 2 takes it, and has to leave it to robot 1, which the master
    // takes for its bearer.
    let scenario = "at 0s for 1.5s delay 4s from * to World; \
        at 1s for 1s delay 1s on ELMSTOPIC from Robot1 to Master; at 100ms luggage (2,1) to (3,10)";
    let fleet = fleet(11, "", scenario, &COLUMN);
    let run = delivers(&fleet, 1, 1);
    assert!(run.log().contains("could not collect"), "{}", run.log());
    fleet.expect_invariants(1..2, HOUR);
}

/// What a robot said before it was done with a piece comes after that.
#[test]
fn words_of_robots_that_overtake_each_other_do_not_mislead_a_master_for_ever() {
    let scenario = "at 1s for 40s reorder 30 % by 2s on ELMSTOPIC
        from 1s every 300ms 20 times luggage random to random";
    for assignment in ["optimal", "oldest"] {
        let fleet = fleet(6, &format!("assignment={assignment}"), scenario, &COLUMN);
        (0..10).for_each(|seed| _ = delivers(&fleet, seed, 20));
    }
}

#[test]
fn a_master_assigns_all_luggage_once() {
    let robots = [(0, 0, ""), (5, 5, ""), (10, 0, ""), (0, 10, ""), (10, 10, "asleep=true")];
    for (side, master) in [(11, "assignment=oldest"), (11, "assignment=optimal"), (90, "assignment=optimal")] {
        for seed in 1..=3 {
            let scenario = "at 1s 20 times luggage (0,0)..(10,10) to (0,0)..(10,10); \
                from 5s every 2s 20 times luggage (0,0)..(10,10) to (0,0)..(10,10)";
            let run = delivers(&fleet(side, master, scenario, &robots), seed, 40);
            let log = run.log();
            for luggage in 1..=40 {
                let collected = log.matches(&format!("collected luggage {luggage} at")).count();
                assert_eq!(collected, 1, "luggage {luggage}: {log}");
            }
        }
    }
}

#[test]
fn a_broken_robot_loses_no_luggage_that_a_master_assigned() {
    let robots = [(0, 0, ""), (5, 5, ""), (10, 0, "")];
    for at in ["1300ms", "2s", "4s", "6s"] {
        let scenario = format!("at 1s 12 times luggage (0,0)..(10,10) to (0,0)..(10,10); at {at} breakdown Robot2");
        delivers(&fleet(11, "assignment=optimal", &scenario, &robots), 1, 12);
    }
}

#[test]
fn luggage_is_assigned_again_whose_robot_breaks_before_it_answers() {
    let robots = [(0, 0, ""), (10, 10, "")];
    for at in (11..=16).map(|tenths| f64::from(tenths) / 10.0) {
        let scenario = format!(
            "at 0s for 2s delay 300ms from Master to Robot1; at 1s luggage (1,1) to (3,3); at {at}s breakdown Robot1"
        );
        delivers(&fleet(11, "assignment=optimal", &scenario, &robots), 1, 1);
    }
}

#[test]
fn a_robot_leaves_luggage_for_what_is_much_closer() {
    let scenario = "at 1s luggage (20,0) to (21,0); at 1500ms luggage (4,0) to (4,3)";
    let optimal = delivers(&fleet(22, "assignment=optimal", scenario, &[(0, 0, "")]), 1, 2);
    assert_eq!(taken(&optimal, "Robot1"), ["1", "2", "1"], "{}", optimal.log());
    let oldest = delivers(&fleet(22, "assignment=oldest", scenario, &[(0, 0, "")]), 1, 2);
    assert_eq!(taken(&oldest, "Robot1"), ["1", "2"], "{}", oldest.log());
}

#[test]
fn the_oldest_luggage_goes_first_or_the_closest() {
    let scenario = "at 1s luggage (0,20) to (0,21); at 1s luggage (0,10) to (0,11); at 1s luggage (0,2) to (0,3)";
    let robots = [(0, 0, "")];
    for (master, order) in [("assignment=oldest", ["1", "2", "3"]), ("assignment=optimal", ["3", "2", "1"])] {
        let run = delivers(&fleet(22, master, scenario, &robots), 1, 3);
        assert_eq!(taken(&run, "Robot1"), order, "{master}: {}", run.log());
    }
}

#[test]
fn of_equally_close_luggage_the_one_with_the_longer_way_goes_first() {
    let scenario = "at 1s luggage (0,10) to (0,12); at 1s luggage (10,0) to (20,10)";
    let run = delivers(&fleet(22, "assignment=optimal", scenario, &[(0, 0, "")]), 1, 2);
    assert_eq!(taken(&run, "Robot1"), ["2", "1"], "{}", run.log());
}

#[test]
fn who_sleeps_is_woken_for_luggage_that_nobody_awake_can_bring() {
    // To the first piece no way leads for robot 1, to the second one its battery never lasts.
    let wall = format!("map={}", ["...@..."; 3].join("&#10;"));
    let near = "at 5s luggage (4,0) to (6,2)";
    let far = "at 5s luggage (57,0) to (59,2)";
    for (world, scenario, at) in [(wall.as_str(), near, "4"), ("height=3 width=60", far, "56")] {
        for policy in ["oldest", "optimal"] {
            let robots = [("0", ""), (at, "asleep=true")];
            let robots = robots.map(|(x, more)| (x.parse().unwrap(), 1, more));
            let world = format!("moveTime=100ms {world}");
            let master = format!("assignment={policy}");
            let mut text = fleet_text("", &world, [&master, ""], scenario, &robots);
            text = text.replace(">0.1<", ">1<");
            let run = delivers(&Fleet::of_text(text), 1, 1);
            assert!(run.time_s < 20.0, "{policy}: {}", run.log());
            assert!(run.log_of("Robot2").iter().any(|line| line.starts_with("takes luggage 1")), "{}", run.log());
        }
    }
}

#[test]
fn luggage_to_which_no_way_leads_is_given_up() {
    let world = format!("moveTime=100ms map={}", ["...@..."; 3].join("&#10;"));
    let scenario = "at 1s breakdown Robot2; at 3s luggage (4,0) to (6,2)";
    for policy in ["oldest", "optimal"] {
        let masters = [&format!("assignment={policy}"), ""];
        let text = fleet_text("", &world, masters, scenario, &[(0, 1, ""), (6, 1, "")]);
        let run = Fleet::of_text(text).run(1, HOUR);
        assert_eq!(run.outcome.status, RunStatus::Incomplete, "{}", run.log());
        assert_eq!(count(&run, "luggage", "given_up"), 1, "{}", run.log());
    }
}

#[test]
fn luggage_is_not_kept_for_ever_for_a_robot_that_gets_nowhere() {
    // Robot 1 would be at luggage 2 first, but does not move for as long as 450 moves take.
    let scenario = "at 1s luggage (1,0) to (9,0); at 2500ms slow robot=1 factor=1000 lasting=90s; \
        at 4s luggage (12,0) to (12,3)";
    let run = delivers(&fleet(22, "assignment=optimal", scenario, &[(0, 0, ""), (20, 20, "")]), 1, 2);
    assert_eq!((taken(&run, "Robot1"), taken(&run, "Robot2")), (vec!["1".into()], vec!["2".into()]), "{}", run.log());
}

#[test]
fn thousands_of_pieces_at_once_overflow_no_queue() {
    for (side, master) in [(12, ""), (90, ""), (12, "assignment=optimal")] {
        let robots = [(0, 0, ""), (5, 5, ""), (10, 0, "asleep=true")];
        let fleet = fleet(side, master, "at 1s 3000 times luggage random to random", &robots);
        let run = fleet.run(1, Duration::from_secs(30));
        assert_eq!(run.outcome.status, RunStatus::Elapsed, "{:?}", run.outcome);
        assert_eq!(count(&run, "luggage", "requested"), 3000);
    }
}

#[test]
fn nobody_is_sent_to_sleep_while_luggage_waits() {
    let pieces: String = (0..8).map(|y| format!("at 2s luggage (10,{y}) to (1,{y});")).collect();
    let scenario = format!("at 1s landing 8; {pieces} at 8s landing 8; {}", pieces.replace("at 2s", "at 9s"));
    let robots: Vec<(u32, u32, &str)> = (0..5).map(|y| (0, y + 6, if y == 0 { "" } else { "asleep=true" })).collect();
    let run = delivers(&fleet(12, "", &scenario, &robots), 1, 16);
    let log = run.log();
    let place = |what: &str| log.find(what).unwrap_or_else(|| panic!("{what}: {log}"));
    assert!(place("wakes robots") < place("takes luggage"));
    let last = log.rfind("takes luggage").unwrap();
    assert!(log.find(" to charge\n").is_none_or(|sent| sent > last), "{log}");
}

#[test]
fn robots_sleep_again_when_what_was_announced_does_not_come() {
    let scenario = "at 1s landing 4; at 60s luggage (3,3) to (5,5)";
    let robots = [(0, 0, ""), (5, 5, "asleep=true"), (10, 0, "asleep=true")];
    let log = delivers(&fleet(12, "", scenario, &robots), 1, 1).log();
    assert_eq!((log.matches(": wakes up").count(), log.matches(": sleeps").count()), (2, 2), "{log}");
}

/// Two airplanes land so many seconds apart, with eight pieces each, one every five seconds; all but one robot sleep,
/// or none.
fn two_landings(apart: u32, asleep: bool, seed: u64) -> f64 {
    let landing = |at: u32| {
        let pieces = (0..8).map(|piece| {
            let at = at + 1 + 5 * piece;
            format!("at {at}s luggage (13,0)..(19,19) to (1,0)..(5,19); ")
        });
        format!("at {at}s landing 8; {}", pieces.collect::<String>())
    };
    let scenario = landing(1) + &landing(1 + apart);
    // Those who are awake stay so.
    let counter = if asleep { "counter=50" } else { "counter=100000" };
    let of = |place: u32| (0, 4 * place, if asleep && place > 0 { "asleep=true" } else { "" });
    let robots: Vec<(u32, u32, &str)> = (0..5).map(of).collect();
    let fleet = fleet_with(20, "moveTime=1s", ["", counter], &scenario, &robots);
    delivers(&fleet, seed, 16).time_s
}

#[test]
fn robots_that_sleep_cost_two_landings_little_time() {
    for apart in [10, 60] {
        let total = |asleep: bool| (1..=4).map(|seed| two_landings(apart, asleep, seed)).sum::<f64>();
        let (asleep, awake) = (total(true), total(false));
        assert!(asleep <= 1.15 * awake, "{apart} s apart: {asleep} s in place of {awake} s");
    }
}

#[test]
fn a_robot_on_its_way_to_sleep_is_called_back_for_luggage_that_waits() {
    // Both are sent to sleep at 6 s, when robot 1 has its job. The other pieces wait for longer than the counter.
    let scenario = "at 1s landing 2; at 2s luggage (19,0) to (1,19); at 7s luggage (19,19) to (1,5); \
        at 7s luggage (18,19) to (2,5)";
    let robots = [(0, 0, "asleep=true"), (0, 19, "asleep=true")];
    let fleet = fleet_with(20, "moveTime=1s", ["", "counter=50 piecesPerRobot=1"], scenario, &robots);
    let log = delivers(&fleet, 1, 3).log_of("Robot1").join("\n");
    let job = log.split_once("takes luggage 1 ").unwrap().1.split_once("deposited luggage 1 ").unwrap().0;
    assert!(job.contains("wakes up"), "{log}");
}

#[test]
fn a_master_that_hears_late_does_not_assign_luggage_again_and_again() {
    // An answer takes four seconds, and the master asks another robot after 0.8 s, until it knows that.
    let robots: Vec<(u32, u32, &str)> = (0..6).map(|y| (0, 2 * y, "")).collect();
    for policy in ["oldest", "optimal"] {
        let scenario = "at 0s delay 2s from Master; at 0s delay 2s to Master; \
            at 1s 12 times luggage (0,0)..(11,11) to (0,0)..(11,11); \
            from 20s every 2s 24 times luggage (0,0)..(11,11) to (0,0)..(11,11)";
        let run = delivers(&fleet(12, &format!("assignment={policy}"), scenario, &robots), 1, 36);
        let log = run.log_of("Master").join("\n");
        let (assigned, back) = (log.matches("assigns luggage").count(), log.matches(" back from robot").count());
        assert!((36..=72).contains(&assigned) && back <= 12, "{policy}: {assigned} and {back}: {log}");
    }
}

#[test]
fn robots_agree_although_messages_overtake_each_other() {
    let scenario = "from 1s every 400ms 60 times luggage random to random; at 1s for 40s reorder 20 % by 200ms";
    let robots: Vec<(u32, u32, &str)> = (1..=4).map(|number| (0, number, "")).collect();
    let text = fleet_text("width=11 height=11", "", ["", ""], scenario, &robots);
    let zone = "<component name=\"Zone\"><implementation.java class=\"saoms.Zone\"/><property name=\"ID\">Zone</property>\
        <property name=\"period\">100</property><reference name=\"world\" target=\"World\"/></component></composite>";
    let fleet = Fleet::of_text(text.replace("</composite>", zone));
    for seed in 1..=8 {
        delivers(&fleet, seed, 60);
    }
}

/// A piece far away, and an endless stream of others beside the robot: `optimal` prefers short ways, but for
/// 400 steps at most.
#[test]
fn luggage_far_away_is_not_left_for_ever_to_closer_luggage() {
    let scenario = "at 1s luggage (20,20) to (20,16); from 1s every 500ms 300 times luggage (1,1) to (2,2)";
    let run = fleet(22, "assignment=optimal", scenario, &[(0, 0, "")]).run(1, Duration::from_secs(120));
    let takes = run.log().lines().find(|line| line.contains("Robot1: takes luggage 1 ")).map(str::to_owned);
    let time = takes.as_ref().and_then(|line| line.strip_prefix('[')?.split_once(" s]")?.0.parse::<f64>().ok());
    // A step is 200 ms.
    assert!(time.is_some_and(|time| (20.0..=81.0).contains(&time)), "{takes:?}\n{}", run.log());
}
