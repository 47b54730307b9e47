//! `saoms simulate`: many seeds, faults and invariants.

use std::fs;
use std::io::Read;
use std::path::Path;
use std::process::{Command, Stdio};
use std::thread;
use std::time::Duration;

use expect_test::expect;
use serde_json::Value;

use crate::support::{PROGRAM, command, empty_folder, on_hangup, root, saoms, saoms_in, stdout};

fn simulate(folder: &Path, arguments: &[&str]) -> (Option<i32>, String, String) {
    let composite = root().join("composites/airport.composite");
    simulate_file(folder, composite.to_str().unwrap(), arguments)
}

fn simulate_file(folder: &Path, composite: &str, arguments: &[&str]) -> (Option<i32>, String, String) {
    let output = saoms_in(folder, &[&["simulate", composite, "--for", "5min"], arguments].concat());
    (output.status.code(), stdout(&output), String::from_utf8_lossy(&output.stderr).into_owned())
}

#[test]
fn seeds_without_faults_keep_the_invariants() {
    let folder = empty_folder("simulate-clean");
    let (code, told, progress) = simulate(&folder, &["--seeds", "4", "--first", "7", "-j", "2"]);
    assert_eq!(code, Some(0), "{told}{progress}");
    for row in [
        "seeds                      7 to 10: 4\n",
        "runs                       done 4\n",
        "violations                 none\n",
    ] {
        assert!(told.contains(row), "{told}");
    }
    assert!(told.contains("pieces delivered           56 of 56 (100.0 %)\n"), "{told}");
    let performance = told.lines().find_map(|line| line.strip_prefix("performance ")?.strip_suffix(" per CPU-hour"));
    let rate = performance.and_then(|text| text.trim().strip_suffix(" robot-hours")?.parse::<u64>().ok());
    assert!(rate.is_some_and(|rate| rate > 0), "{told}");
    assert!(progress.contains("4 of 4 seeds, 0 with violations\n"), "{progress}");
}

#[test]
fn a_failing_seed_is_shown_again_and_its_faults_are_shrunk() {
    let folder = empty_folder("simulate-failing");
    let script = "at 1s for 20s delay 300ms\nat 1s for 1s jitter 1ms on CSMSTOPIC\nat 3s fail MasterRobot\n";
    fs::write(folder.join("faults.txt"), script).unwrap();
    // Without a zone, robots collide if they hear of each other too late.
    let arguments =
        ["--seeds", "3", "--faults", "faults.txt", "--severity", "S5024=allow: to see it", "--report", "json"];
    let airport = fs::read_to_string(root().join("composites/airport.composite")).unwrap();
    let (before, after) = airport.split_once("  <component name=\"Zone\">").unwrap();
    let (_, after) = after.split_once("</component>").unwrap();
    fs::write(folder.join("peers.composite"), [before, after].concat()).unwrap();
    let (code, told, _) = simulate_file(&folder, "peers.composite", &arguments);
    assert_eq!(code, Some(1), "{told}");
    let report: Value = serde_json::from_str(&told).unwrap();
    let ways = |value: &Value| value["delay"].as_u64().unwrap() > 100 && value["fail"] == 3;
    assert!(ways(&report["faults"]), "{told}");
    // What the robots of each run were heard of, in an hour of processor time.
    let hours: f64 = report["results"].as_array().unwrap().iter().map(robot_hours).sum();
    let [rate, cpu] = [&report["performance"]["robot-hours"], &report["cpu_s"]].map(|one| one.as_f64().unwrap());
    assert!(hours > 0.0 && (rate * cpu / 3600.0 - hours).abs() < 1e-6 * hours, "{hours}: {told}");
    let failing = report["failing"].as_array().unwrap();
    assert_eq!(failing.len(), 3, "{told}");
    let of_collisions = report["results"]
        .as_array()
        .unwrap()
        .iter()
        .position(|one| one["violations"][0]["invariant"].as_str().unwrap().starts_with("1 "));
    let place = of_collisions.unwrap();
    assert_eq!(failing[place]["faults"], serde_json::json!(["at 1s for 20s delay 300ms"]), "{told}");
    let line = failing[place]["command"].as_str().unwrap();
    let again =
        Command::new("sh").args(["-c", &line.replacen("saoms", PROGRAM, 1)]).current_dir(&folder).output().unwrap();
    let first = report["results"][place]["violations"][0]["text"].as_str().unwrap();
    let seen = String::from_utf8_lossy(&again.stderr).into_owned();
    assert_eq!(again.status.code(), Some(1), "{seen}");
    assert!(seen.contains(&format!("1 no two robots in a block: {first}\n")), "{seen}");
    let (_, twice, _) = simulate_file(&folder, "peers.composite", &arguments);
    let twice: Value = serde_json::from_str(&twice).unwrap();
    assert_eq!(report["results"], twice["results"], "in other processes it is the same");
}

/// The hours of all robots in the result of a run.
fn robot_hours(result: &Value) -> f64 {
    let simulated = &result["simulated"][0];
    assert_eq!(simulated["name"], "robot-hours", "{result}");
    simulated["value"].as_f64().unwrap()
}

/// An airport in a storm: messages are lost, late and doubled, robots break down, masters die, a zone crashes, and
/// robots are cut off.
#[test]
fn a_storm_harms_no_fleet_with_zones() {
    let folder = empty_folder("simulate-storm");
    let composite = root().join("composites/storm.composite");
    let faults = root().join("composites/storm.txt");
    let arguments = ["--faults", faults.to_str().unwrap(), "--seeds", "200", "--report", "json"];
    let (code, told, progress) = simulate_file(&folder, composite.to_str().unwrap(), &arguments);
    assert_eq!(code, Some(0), "{told}{progress}");
    let report: Value = serde_json::from_str(&told).unwrap();
    let faults = &report["faults"];
    for kind in ["lose", "delay", "duplicate", "part", "crash"] {
        assert!(faults[kind].as_u64().unwrap() >= 200, "{kind}: {faults}");
    }
    let mut delivered = (0.0, 0.0);
    for one in report["results"].as_array().unwrap() {
        let pieces = &one["measures"][0];
        assert_eq!(pieces["name"], "pieces delivered", "{one}");
        delivered.0 += pieces["value"].as_f64().unwrap();
        delivered.1 += pieces["of"].as_f64().unwrap();
    }
    assert!(delivered.0 >= 0.99 * delivered.1 && delivered.1 >= 24.0 * 195.0, "{delivered:?}");
}

/// Events that are lost for good cost work, and nothing else: invariants 7 and 8 need not hold then.
#[test]
fn events_that_are_lost_for_good_lead_to_no_collision_and_no_second_delivery() {
    let folder = empty_folder("simulate-violate");
    let composite = root().join("composites/storm.composite");
    let storm = fs::read_to_string(root().join("composites/storm.txt")).unwrap();
    fs::write(folder.join("faults.txt"), format!("at 1s for 60s violate 20 %\n{storm}")).unwrap();
    let arguments = ["--faults", "faults.txt", "--seeds", "20", "--report", "json"];
    let (_, told, progress) = simulate_file(&folder, composite.to_str().unwrap(), &arguments);
    let report: Value = serde_json::from_str(&told).unwrap_or_else(|_| panic!("{told}{progress}"));
    assert!(report["faults"]["violate"].as_u64().unwrap() >= 20, "{}", report["faults"]);
    let violated = report["violations"].as_object().unwrap();
    assert!(violated.keys().all(|name| name.starts_with("7 ") || name.starts_with("8 ")), "{violated:?}");
}

/// The run is the same on every machine, debug and release. What changes the acts of fleets changes its hash, too:
/// `UPDATE_EXPECT=1` writes it anew.
#[test]
fn a_run_in_a_storm_is_the_same_everywhere() {
    let storm = ["composites/storm.composite", "--faults", "composites/storm.txt", "--for", "40s"];
    let run = ["run", "--virtual", "--seed", "1", "--quiet", "--report", "-"];
    let output = saoms(&[&run[..], &storm].concat());
    let report: Value = serde_json::from_str(&stdout(&output)).unwrap();
    let faults = &report["faults"]["applied"];
    assert!(["lose", "delay", "duplicate"].iter().all(|kind| faults[kind].as_u64() > Some(1000)), "{faults}");
    expect![["9e9d068c83587e0d"]].assert_eq(report["trace_hash"].as_str().unwrap());
}

/// Zones answered so late that no full battery lasted with the reserve for that: robots went between their own charger
/// and the one that they had borrowed, which they kept from others.
#[test]
fn robots_with_a_full_battery_leave_a_charger_to_others_however_late_zones_answer() {
    let folder = empty_folder("simulate-late");
    let (composite, faults) = (root().join("composites/storm.composite"), root().join("composites/storm.txt"));
    let arguments = ["--faults", faults.to_str().unwrap(), "--seeds", "1", "--first", "7484"];
    let (code, told, _) = simulate_file(&folder, composite.to_str().unwrap(), &arguments);
    assert_eq!(code, Some(0), "{told}");
    assert!(told.contains("24 of 24"), "{told}");
}

/// Without a robot nobody brings the luggage. The command that shows a seed again ends there, too.
#[test]
fn a_standstill_ends_a_run_and_is_named() {
    let folder = empty_folder("simulate-standstill");
    let hall = fs::read_to_string(root().join("composites/hall.composite")).unwrap();
    let (before, after) = hall.split_once("  <component name=\"Robot7\">").unwrap();
    let (_, after) = after.split_once("</component>").unwrap();
    fs::write(folder.join("hall.composite"), [before, after].concat()).unwrap();
    let (code, told, _) = simulate_file(&folder, "hall.composite", &["--seeds", "2"]);
    assert_eq!(code, Some(1), "{told}");
    let stands = "nothing has happened since 1.100 s, and nothing more can: `World` waits for a robot";
    for row in [
        "runs                       incomplete 2\n",
        &format!("standstills                2, first seed 0: {stands}"),
        "violations                 2 in 2 seeds: 7 requests are finished once faults are over\n",
        &format!("\n  it stands still: {stands}"),
    ] {
        assert!(told.contains(row), "{row}: {told}");
    }
    let line = told.lines().find_map(|line| line.strip_prefix("  saoms run ")).unwrap();
    assert_eq!(line, "hall.composite --virtual --invariants --seed 0 --for 300s");
    let again = saoms_in(&folder, &std::iter::once("run").chain(line.split(' ')).collect::<Vec<_>>());
    let seen = String::from_utf8_lossy(&again.stderr).into_owned() + &stdout(&again);
    assert_eq!(again.status.code(), Some(1), "{seen}");
    assert!(seen.contains("7 requests are finished once faults are over") && seen.contains(stands), "{seen}");
    // A fault that begins later may start something.
    fs::write(folder.join("faults.txt"), "at 2min crash World restart 1s\n").unwrap();
    let arguments = ["--seeds", "1", "--faults", "faults.txt", "--report", "json"];
    let (_, told, _) = simulate_file(&folder, "hall.composite", &arguments);
    let report: Value = serde_json::from_str(&told).unwrap();
    assert!(report["results"][0]["time_s"].as_f64().unwrap() > 180.0, "{told}");
}

#[test]
fn wrong_input_starts_nothing() {
    let folder = empty_folder("simulate-wrong");
    fs::write(folder.join("faults.txt"), "at 1s lose 200 %\n").unwrap();
    let (code, told, why) = simulate(&folder, &["--faults", "faults.txt"]);
    assert_eq!((code, told.as_str()), (Some(2), ""), "{why}");
    assert!(why.contains("faults.txt:1:12: found `200 %`") && why.ends_with("1 error: nothing was started\n"), "{why}");
    let endless = "from 1s every 1s lose 20 %\nfrom 1s every 1ms until 10min landing 2\n";
    fs::write(folder.join("faults.txt"), endless).unwrap();
    let (code, _, why) = simulate(&folder, &["--faults", "faults.txt"]);
    assert_eq!(code, Some(2), "{why}");
    for line in [
        "this line never ends, but a line of `--faults` has to end\n",
        "found more than 100000 events in a line of `--faults`\n",
    ] {
        assert!(why.contains(line), "{why}");
    }
    let (code, _, why) = simulate(&folder, &["--faults", "falts.txt"]);
    assert_eq!(code, Some(2), "{why}");
    let output = saoms_in(&folder, &["simulate", "-"]);
    assert_eq!(output.status.code(), Some(2));
}

#[test]
fn a_signal_ends_it_with_130_and_the_processes_of_its_seeds() {
    for signal in [libc::SIGTERM, libc::SIGINT, libc::SIGHUP] {
        let arguments = ["simulate", "composites/storm.composite", "--seeds", "100000", "-j", "1"];
        let mut run = command(&arguments);
        on_hangup(run.stdout(Stdio::piped()).stderr(Stdio::piped()), libc::SIG_DFL);
        let mut child = run.spawn().unwrap();
        // A process that runs seeds has the same standard error, which is closed once all have ended.
        while threads_with_children(child.id()) == 0 {
            thread::sleep(Duration::from_millis(5));
        }
        // SAFETY: `kill` takes no pointers; the process is our own child, not yet waited for.
        assert_eq!(unsafe { libc::kill(i32::try_from(child.id()).unwrap(), signal) }, 0);
        let mut told = String::new();
        child.stderr.take().unwrap().read_to_string(&mut told).unwrap();
        assert_eq!(child.wait().unwrap().code(), Some(130), "signal {signal}: {told}");
    }
}

/// Number of the threads of a process that have started others.
fn threads_with_children(process: u32) -> usize {
    let Ok(threads) = fs::read_dir(format!("/proc/{process}/task")) else { return 0 };
    let children = threads.map(|thread| fs::read_to_string(thread.unwrap().path().join("children")));
    children.filter(|all| all.as_ref().is_ok_and(|all| !all.trim().is_empty())).count()
}
