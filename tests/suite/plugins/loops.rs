//! `plugins/own-loops`: each loop that ships is replaced by one that works on entries alone. The robots do what the new
//! loop says, and the same when it comes from the library.

use std::fs;
use std::time::Duration;

use saoms_api::LoopClass;
use saoms_components::master::MasterRobot;
use saoms_components::robot::Robot;
use saoms_core::journal::JournalEntry;
use saoms_own_loops::{
    AllHands, Announcer, ClassicWalker, Distance, EarlyBattery, FixedBattery, Loner, MeanBattery, Naps, Rested,
    SlowGripper, Straight, Zone,
};
use saoms_testkit::{Bench, Fleet, Run, comply_as};
use serde_json::Value;

use super::examples::library;
use crate::support::{root, saoms, text};

const NAMESPACES: &str = r#"xmlns="http://docs.oasis-open.org/ns/opencsa/sca/200912" xmlns:saoms="urn:saoms:1""#;

/// A component with its task properties and what else stands in it.
fn component(name: &str, class: &str, rest: &str) -> String {
    format!(
        "<component name=\"{name}\"><implementation.rust class=\"{class}\"/><property name=\"ID\" value=\"{name}\"/>\
         <property name=\"period\" value=\"100ms\"/>{rest}</component>\n"
    )
}

/// A robot with a policy, and loops or properties.
fn robot(name: &str, policy: &str, rest: &str) -> String {
    let policy = format!("<property name=\"policy\" value=\"{policy}\"/><property name=\"discharge\" value=\"0.5\"/>");
    component(name, "saoms.Robot", &format!("{policy}{rest}<reference name=\"world\" target=\"World\"/>"))
}

/// The element that puts a loop with properties in the place of another one.
fn instead(name: &str, class: &str, properties: &[(&str, &str)]) -> String {
    let property = |(name, value): &(&str, &str)| format!("<property name=\"{name}\" value=\"{value}\"/>");
    let properties: String = properties.iter().map(property).collect();
    format!("<saoms:loop name=\"{name}\" class=\"{class}\">{properties}</saoms:loop>")
}

/// A fleet with a world in which a move takes a while, so that robots have to wait for their hardware.
fn fleet(scenario: &str, robots: &[String]) -> String {
    let world = component("World", "saoms.World", "<property name=\"moveTime\" value=\"250ms\"/>");
    let scenario = format!("<property name=\"scenario\">{scenario}</property>");
    let environment = component("Environment", "saoms.Environment", &scenario);
    let master = component("Master", "saoms.MasterEnvironment", "");
    let robots = robots.concat();
    format!(
        "<composite {NAMESPACES} name=\"own\" targetNamespace=\"urn:own\">\n{world}{environment}{master}{robots}</composite>"
    )
}

/// Runs a fleet with the loops linked in. It has no mistakes, and warnings only of entries that a loop does not serve.
fn linked(composite: &str) -> Run {
    let fleet = Fleet::of_text(composite);
    let found = fleet.diagnostics();
    assert!(found.lines().all(|line| line.starts_with("warning S4511")), "{found}");
    fleet.run(3, Duration::from_secs(300))
}

/// The same, and with the loops from the library, which comes to the same run.
fn both(composite: &str) -> Run {
    both_with(composite, &["saoms_own_loops"])
}

/// The same with several libraries.
fn both_with(composite: &str, libraries: &[&str]) -> Run {
    let linked = linked(composite);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("own.composite");
    fs::write(&path, composite).unwrap();
    let libraries: Vec<_> = libraries.iter().map(|name| library(name)).collect();
    let mut arguments = vec!["run", path.to_str().unwrap(), "--virtual", "--seed", "3", "--for", "300s", "--quiet"];
    arguments.extend(["--report", "-"]);
    arguments.extend(libraries.iter().flat_map(|library| ["--plugin", library.to_str().unwrap()]));
    let run = saoms(&arguments);
    let report: Value = serde_json::from_slice(&run.stdout).unwrap_or_else(|_| panic!("{}", text(&run)));
    assert_eq!(report["trace_hash"].as_str(), linked.trace_hash.as_deref(), "{}", linked.log());
    linked
}

/// What a robot did, and how its fleet fared, when it was replaced and when it was not.
fn delivered(run: &Run) -> i64 {
    run.sections["luggage"]["delivered"].as_i64().unwrap()
}

/// Where a robot was, with the times at which it came there, as the journal has it.
fn blocks(run: &Run, robot: &str) -> Vec<(f64, (i64, i64))> {
    let changes = run.journal().of(robot).changes("block");
    let block = |entry: &JournalEntry| {
        let to = entry.values()["after"].clone();
        (entry.time().as_nanos() as f64 / 1e9, (to[0].as_i64().unwrap(), to[1].as_i64().unwrap()))
    };
    changes.iter().map(block).collect()
}

/// The time of the first record with this id.
fn time_of(run: &Run, robot: &str, record: &str) -> f64 {
    let found = run.journal().of(robot).of_record(record);
    let found = found.first().unwrap_or_else(|| panic!("{record}: {}", run.log()));
    found.time().as_nanos() as f64 / 1e9
}

/// The least distance of two robots from a time on.
fn least_distance(run: &Run, [one, other]: [&str; 2], from: f64) -> i64 {
    let [one, other] = [one, other].map(|robot| blocks(run, robot));
    let at = |path: &[(f64, (i64, i64))], time: f64| {
        path.iter().take_while(|(when, _)| *when <= time).last().map(|(_, block)| *block)
    };
    let times = one.iter().chain(&other).map(|(time, _)| *time).filter(|time| *time >= from);
    let distances = times.filter_map(|time| {
        let ((x, y), (other_x, other_y)) = (at(&one, time)?, at(&other, time)?);
        Some((x - other_x).abs() + (y - other_y).abs())
    });
    distances.min().unwrap()
}

const WORK: &str = "from 1s every 2s 8 times luggage (3,1) to (8,1)";

#[test]
fn a_battery_loop_turns_the_robot_back_at_its_own_level_and_keeps_it_until_the_battery_is_full() {
    let work = |rest: &str| fleet(WORK, &[robot("Robot1", "safe", rest)]);
    let own = both(&work(&instead("BatteryMS", "own.FixedBattery", &[("level", "75")])));
    assert_eq!(delivered(&own), 8, "{}", own.log());
    let loops = || own.journal().of("Robot1").of_loop("BatteryMS");
    let levels: Vec<f64> =
        loops().of_record("battery_below_level").iter().map(|one| one.values()["battery"].as_f64().unwrap()).collect();
    assert!(levels.len() > 1 && levels.iter().all(|level| (73.0..=75.0).contains(level)), "{levels:?}");
    assert_eq!(loops().of_record("leaves_charger_when_full").len(), levels.len());
    let turned = |run: &Run| run.journal().of("Robot1").of_record("goes_to_charge").len();
    let shipped = linked(&work(""));
    assert!(turned(&own) > turned(&shipped), "{} {}", turned(&own), turned(&shipped));
}

#[test]
fn a_loop_of_its_own_lets_the_robot_sleep_between_two_jobs() {
    let work = |rest: &str| {
        fleet("at 1s luggage (3,1) to (5,1); at 30s luggage (3,1) to (5,1)", &[robot("Robot1", "safe", rest)])
    };
    let own = both(&work(&instead("RobotMS", "own.Naps", &[])));
    assert_eq!(delivered(&own), 2);
    let slept = own.journal().of("Robot1").changes("asleep").texts();
    assert_eq!(slept, ["asleep: no -> yes", "asleep: yes -> no"]);
    assert!(linked(&work("")).journal().of("Robot1").changes("asleep").is_empty());
}

#[test]
fn a_loop_of_its_own_announces_the_robot_less_often_and_the_others_still_know_it() {
    for policy in ["safe", "classic"] {
        let work = |rest: &str| {
            let robots = [robot("Robot1", policy, rest), robot("Robot2", policy, "")];
            fleet("from 1s every 2s 6 times luggage (3,1) to (8,1)", &robots)
        };
        let own = both(&work(&instead("RobotListMS", "own.Announcer", &[])));
        let shipped = linked(&work(""));
        assert_eq!((delivered(&own), delivered(&shipped)), (6, 6), "{policy}");
        assert!(own.sections.get("messages").is_none(), "no message was ignored: {:?}", own.sections);
        let said = own.journal().of("Robot1").of_record("announces_state").len();
        let usual = match policy {
            "safe" => shipped.journal().of("Robot1").of_record("announces_state").len(),
            // In each execution.
            _ => shipped.components.iter().find(|one| one.name == "Robot1").unwrap().executions as usize,
        };
        assert!(said > 0 && said < usual, "{policy}: {said} {usual}");
        assert_eq!(own.journal().of("Robot2").with("knows 1 other robot").is_empty(), policy == "safe");
    }
}

#[test]
fn a_robot_of_its_own_breaks_as_others_do_and_helps_none() {
    for policy in ["safe", "classic"] {
        let scenario = "at 1s luggage (3,1) to (8,1); at 2600ms breakdown Robot1";
        let work = |first: &str, second: &str| {
            let robots = [robot("Robot1", policy, first), robot("Robot2", policy, second), robot("Robot9", policy, "")];
            fleet(scenario, &robots)
        };
        let own = instead("CriticalSituationMS", "own.Loner", &[]);
        for broken in ["", own.as_str()] {
            let shipped = linked(&work(broken, ""));
            let run = both(&work(broken, &own));
            assert_eq!((delivered(&shipped), delivered(&run)), (1, 1), "{policy}\n{}", run.log());
            let carried = |run: &Run, robot: &str| run.log_of(robot).iter().any(|line| line.starts_with("deposited"));
            assert!(carried(&shipped, "Robot2"), "{policy}: the closest robot helps\n{}", shipped.log());
            assert!(carried(&run, "Robot9") && !carried(&run, "Robot2"), "{policy}\n{}", run.log());
        }
    }
}

#[test]
fn a_gripper_loop_looks_at_luggage_before_it_takes_it() {
    let work = |rest: &str| fleet("at 1s luggage (3,1) to (8,1)", &[robot("Robot1", "safe", rest)]);
    let [own, shipped] = [both(&work(&instead("GripperMS", "own.SlowGripper", &[("looks", "12")]))), linked(&work(""))];
    assert_eq!((delivered(&own), delivered(&shipped)), (1, 1));
    let waited = |run: &Run, record: &str| {
        let there = blocks(run, "Robot1").into_iter().find(|(_, block)| *block == (3, 1)).unwrap().0;
        time_of(run, "Robot1", record) - there
    };
    assert!(waited(&own, "uses_gripper") > waited(&shipped, "collects_luggage") + 1.1);
}

#[test]
fn robots_with_zones_carry_what_waits_in_theirs() {
    for policy in ["safe", "classic"] {
        let scenario = "at 1s luggage (7,1) to (7,4); at 2s luggage (2,2) to (2,4); at 3s luggage (8,2) to (8,5)";
        let work = |first: &str, second: &str| {
            fleet(scenario, &[robot("Robot1", policy, first), robot("Robot2", policy, second)])
        };
        let zone = |from: &str, to: &str| instead("EventLuggageMS", "own.Zone", &[("from", from), ("to", to)]);
        let own = both(&work(&zone("0", "5"), &zone("6", "20")));
        let carried = |run: &Run, robot: &str| {
            let line = |line: &String| line.strip_prefix("deposited luggage ").map(|rest| rest[..1].to_owned());
            run.log_of(robot).iter().filter_map(line).collect::<Vec<_>>()
        };
        assert_eq!(carried(&own, "Robot1"), ["2"], "{policy}\n{}", own.log());
        assert_eq!(carried(&own, "Robot2"), ["1", "3"], "{policy}\n{}", own.log());
        assert_eq!(delivered(&own), 3);
        assert!(carried(&linked(&work("", "")), "Robot1").contains(&"1".to_owned()), "{policy}: it is closer");
    }
}

#[test]
fn a_collision_loop_keeps_its_distance() {
    for policy in ["safe", "classic"] {
        let scenario = "at 1s luggage (1,5) to (9,5); at 1s luggage (5,9) to (5,1)";
        let work = |rest: &str| fleet(scenario, &[robot("Robot1", policy, ""), robot("Robot9", policy, rest)]);
        let own = both(&work(&instead("CollisionMS", "own.Distance", &[("blocks", "3")])));
        assert_eq!(delivered(&own), 2, "{policy}");
        let crosses = |run: &Run| blocks(run, "Robot9").into_iter().find(|(_, block)| *block == (5, 5)).unwrap().0;
        let shipped = linked(&work(""));
        assert!(crosses(&own) > crosses(&shipped) + 0.5, "{policy}: it lets the other robot pass");
        let least = |run: &Run| least_distance(run, ["Robot1", "Robot9"], 2.0);
        if policy == "classic" {
            assert_eq!((least(&own), least(&shipped)), (2, 0), "classic robots collide there");
        }
    }
}

#[test]
fn a_path_loop_drives_along_y_first() {
    let work = |rest: &str| fleet("at 1s luggage (3,4) to (6,8)", &[robot("Robot1", "safe", rest)]);
    let [own, shipped] = [both(&work(&instead("PathFollowerMS", "own.Straight", &[]))), linked(&work(""))];
    assert_eq!((delivered(&own), delivered(&shipped)), (1, 1), "{}", own.log());
    let path = |run: &Run| blocks(run, "Robot1").into_iter().map(|(_, block)| block).collect::<Vec<_>>();
    assert_eq!(path(&own)[..6], [(0, 2), (0, 3), (0, 4), (1, 4), (2, 4), (3, 4)]);
    assert_eq!(path(&own)[6..13], [(3, 5), (3, 6), (3, 7), (3, 8), (4, 8), (5, 8), (6, 8)]);
    assert_ne!(path(&shipped)[..6], path(&own)[..6]);
    assert_eq!(path(&shipped).len(), path(&own).len());
}

#[test]
fn a_classic_battery_loop_sends_the_robot_to_charge_at_its_own_level() {
    let work = |rest: &str| {
        fleet(WORK, &[robot("Robot1", "classic", rest), component("MasterRobot", "saoms.MasterRobot", "")])
    };
    let own = both(&work(&instead("BatteryMS", "own.classic.EarlyBattery", &[("low", "80")])));
    let shipped = linked(&work(""));
    let levels = |run: &Run| {
        let low = run.journal().of("Robot1").of_loop("BatteryMS").of_record("low_battery");
        low.iter().map(|one| one.values()["battery"].as_f64().unwrap()).collect::<Vec<_>>()
    };
    assert!(
        !levels(&own).is_empty() && levels(&own).iter().all(|level| (75.0..=80.0).contains(level)),
        "{:?}",
        levels(&own)
    );
    assert!(levels(&shipped).iter().all(|level| *level <= 35.0), "{:?}", levels(&shipped));
    assert_eq!((delivered(&own), delivered(&shipped)), (8, 8), "{}", own.log());
}

#[test]
fn a_classic_robot_is_called_in_vain_until_it_is_rested() {
    let tired = "<property name=\"asleep\" value=\"true\"/><property name=\"battery\" value=\"50\"/>";
    let work = |rest: &str| {
        let master = component("MasterRobot", "saoms.MasterRobot", "");
        let scenario = "at 500ms landing 2; at 5s luggage (3,1) to (8,1)";
        fleet(scenario, &[robot("Robot1", "classic", &format!("{tired}{rest}")), master])
    };
    let own = both(&work(&instead("RobotMS", "own.classic.Rested", &[])));
    let shipped = linked(&work(""));
    assert_eq!((delivered(&own), delivered(&shipped)), (1, 1), "{}", own.log());
    let woken = |run: &Run| run.journal().of("Robot1").changes("asleep").first().unwrap().time();
    assert!(woken(&own) > woken(&shipped));
    let called = own.journal().of("Robot1").of_record("called_and_rested");
    assert_eq!(called.first().unwrap().values()["battery"], 100.0);
}

#[test]
fn a_classic_path_loop_drives_uses_the_gripper_and_charges() {
    let work = |rest: &str| {
        let battery = "<property name=\"battery\" value=\"45\"/>";
        let scenario = "at 1s luggage (3,4) to (6,8); at 30s end";
        fleet(scenario, &[robot("Robot1", "classic", &format!("{battery}{rest}"))])
    };
    let own = both(&work(&instead("PathFollowerMS", "own.classic.Walker", &[])));
    let shipped = linked(&work(""));
    assert_eq!((delivered(&own), delivered(&shipped)), (1, 1), "{}", own.log());
    let path = |run: &Run| blocks(run, "Robot1").into_iter().map(|(_, block)| block).collect::<Vec<_>>();
    assert_eq!(path(&own)[..6], [(0, 2), (0, 3), (0, 4), (1, 4), (2, 4), (3, 4)]);
    assert_eq!(path(&shipped)[..3], [(1, 1), (2, 1), (3, 1)]);
    for run in [&own, &shipped] {
        assert_eq!(path(run).last(), Some(&(0, 1)), "it charges");
        assert_eq!(run.journal().of("Robot1").changes("inCharge").texts()[0], "inCharge: no -> yes");
        assert_eq!(run.sections["robots"]["by_path"]["Robot1"]["battery"], 100.0);
    }
}

/// Three sleeping robots with a master, in which a loop is replaced.
fn sleepers(rest: &str) -> String {
    let asleep = "<property name=\"asleep\" value=\"true\"/>";
    let robots = ["Robot1", "Robot2", "Robot3"].map(|name| robot(name, "safe", asleep));
    let master = component("MasterRobot", "saoms.MasterRobot", rest);
    let scenario = "at 1s landing 2; at 2s luggage (3,1) to (8,1); at 15s end";
    fleet(scenario, &[robots.concat(), master])
}

/// The robots that woke.
fn woken(run: &Run) -> usize {
    let robots = ["Robot1", "Robot2", "Robot3"].into_iter();
    robots.filter(|robot| !run.journal().of(robot).changes("asleep").is_empty()).count()
}

#[test]
fn a_loop_of_the_master_wakes_all_robots() {
    let own = both(&sleepers(&instead("AwakeAsleepMS", "own.AllHands", &[])));
    let shipped = linked(&sleepers(""));
    assert_eq!((delivered(&own), delivered(&shipped)), (1, 1), "{}", own.log());
    assert_eq!((woken(&own), woken(&shipped)), (3, 1));
    let shifts = own.journal().of("MasterRobot").changes("onShift").texts();
    assert_eq!(shifts, ["onShift: 0 -> 3", "onShift: 3 -> 0"]);
}

#[test]
fn a_loop_of_the_master_tells_the_mean_battery_and_the_other_one_still_knows_the_robots() {
    let own = both(&sleepers(&instead("RobotListMS", "own.MeanBattery", &[])));
    assert!(own.sections["robots"]["mean_battery"].as_f64().unwrap() > 50.0, "{:?}", own.sections);
    assert_eq!((delivered(&own), woken(&own)), (1, 1), "{}", own.log());
}

#[test]
fn what_a_loop_does_not_serve_is_told_before_the_start() {
    let own = fleet(WORK, &[robot("Robot1", "safe", &instead("BatteryMS", "own.FixedBattery", &[]))]);
    let found = Fleet::of_text(own).diagnostics();
    for expected in [
        "no loop effects `chargeBlock` any more: `own.FixedBattery` replaces `saoms.BatteryMS`, which does",
        "no loop senses `reserve` any more: `own.FixedBattery` replaces `saoms.BatteryMS`, which does",
    ] {
        assert!(found.contains(expected), "{found}");
    }
    let shown = Fleet::of_text(fleet(WORK, &[robot("Robot1", "safe", &instead("CollisionMS", "own.Announcer", &[]))]));
    assert!(shown.diagnostics().contains("no loop effects `stopAPeriod` any more"), "{}", shown.diagnostics());
}

#[test]
fn a_robot_of_one_library_takes_loops_of_another() {
    let camera = fs::read_to_string(root().join("plugins/camera/fleet.composite")).unwrap();
    let loops = instead("GripperMS", "own.SlowGripper", &[("looks", "7")])
        + &instead("PathFollowerMS", "own.Straight", &[])
        + &instead("BatteryMS", "own.FixedBattery", &[]);
    let own = camera.replacen("<composite ", "<composite xmlns:saoms=\"urn:saoms:1\" ", 1).replacen(
        "<property name=\"reach\" value=\"3\"/>",
        &format!("<property name=\"reach\" value=\"3\"/>{loops}"),
        1,
    );
    let run = both_with(&own, &["saoms_camera", "saoms_own_loops"]);
    assert_eq!(delivered(&run), 2, "{}", run.log());
    assert!(!run.journal().of("Robot1").of_record("has_looked").is_empty());
    assert!(run.journal().of("Robot1").of_loop("PathFollowerMS").changes("block").len() > 5);
}

/// Holds a robot with this loop to the rules for every component.
fn complies<L: LoopClass>(policy: &str, name: &str) {
    comply_as(|| Bench::of::<Robot>(&[("ID", "Robot1"), ("policy", policy)])?.with_loop::<L>(name, &[]));
}

#[test]
fn robots_and_masters_with_these_loops_keep_the_rules_for_every_component() {
    complies::<Naps>("safe", "RobotMS");
    complies::<FixedBattery>("safe", "BatteryMS");
    complies::<SlowGripper>("safe", "GripperMS");
    complies::<Straight>("safe", "PathFollowerMS");
    complies::<Rested>("classic", "RobotMS");
    complies::<EarlyBattery>("classic", "BatteryMS");
    complies::<ClassicWalker>("classic", "PathFollowerMS");
    for policy in ["safe", "classic"] {
        complies::<Announcer>(policy, "RobotListMS");
        complies::<Loner>(policy, "CriticalSituationMS");
        complies::<Zone>(policy, "EventLuggageMS");
        complies::<Distance>(policy, "CollisionMS");
    }
    comply_as(|| Bench::of::<MasterRobot>(&[])?.with_loop::<AllHands>("AwakeAsleepMS", &[]));
    comply_as(|| Bench::of::<MasterRobot>(&[])?.with_loop::<MeanBattery>("RobotListMS", &[]));
}
