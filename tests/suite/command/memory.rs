//! Kills at random moments under load: what was accepted is there after each, once.
//!
//! The test is the recorder outside of the program: it notes what was answered "accepted", and compares that with what
//! the fleet knows after each restart. `SAOMS_KILLS=1000` makes it a long one.

use std::fs;
use std::io;
use std::path::Path;
use std::thread::sleep;
use std::time::{Duration, Instant};

use serde_json::Value;

use super::state::crossing;
use crate::support::{PATIENCE, Program, ask, command, empty_folder, saoms_in, send, text};

/// Number of kills, unless `SAOMS_KILLS` says another one.
const KILLS: u64 = 8;
/// Components that crash in the second test.
const CRASHING: [&str; 9] =
    ["Robot1", "Robot2", "Robot3", "Robot4", "World", "Zone", "Master", "MasterRobot", "Environment"];
/// Most pieces that are open at once, so that the robots keep up.
const MOST_OPEN: u64 = 12;

/// What the world knows of luggage: all pieces, and those that are open.
pub(super) fn pieces(socket: &Path) -> io::Result<(u64, u64)> {
    let status = ask(socket, "GET", "/v1/status", "")?;
    let components = status["status"]["components"].as_array().cloned().unwrap_or_default();
    let world = components.iter().find(|one| one["name"] == "World").cloned().unwrap_or_default();
    let count = |name: &str| world["values"][name].as_u64().ok_or(io::Error::other("no values yet"));
    assert_eq!((count("collisions")?, count("given_up")?), (0, 0));
    Ok((count("delivered")? + count("open")?, count("open")?))
}

/// Numbers that look like chance.
pub(super) struct Dice(pub(super) u64);

impl Dice {
    pub(super) fn below(&mut self, end: u64) -> u64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) % end
    }
}

/// Number of kills of a test.
pub(super) fn kills() -> u64 {
    std::env::var("SAOMS_KILLS").ok().and_then(|kills| kills.parse().ok()).unwrap_or(KILLS)
}

/// Starts the program. What it goes on from, and what it told, stay in the folder, for a look after a failure.
pub(super) fn start(folder: &Path) -> Program {
    start_with(folder, &[])
}

pub(super) fn start_with(folder: &Path, more: &[&str]) -> Program {
    let _ = fs::remove_file(folder.join("socket"));
    let (state, before) = (folder.join("state"), folder.join("before"));
    fs::create_dir_all(&before).unwrap();
    if state.join("store.log").exists() {
        fs::copy(state.join("store.log"), before.join("store.log")).unwrap();
    }
    let told = fs::File::create(folder.join("told")).unwrap();
    let usual = ["run", "f.composite", "--state", "state", "--stay", "--control", "socket"];
    let mut run = command(&[&usual[..], more].concat());
    Program(run.current_dir(folder).stdout(told.try_clone().unwrap()).stderr(told).spawn().unwrap())
}

/// Waits until the world knows of this number of pieces at least, and no more come; gives them and those that are open.
pub(super) fn wait_for_pieces(program: &mut Program, socket: &Path, least: u64) -> (u64, u64) {
    let until = Instant::now() + PATIENCE;
    let mut last = None;
    loop {
        assert_eq!(program.0.try_wait().unwrap(), None, "it runs");
        assert!(Instant::now() < until, "the world knows of {last:?} pieces, and {least} were accepted");
        let now = pieces(socket).ok().filter(|(all, _)| *all >= least);
        if let Some((all, open)) = now
            && last == Some(all)
        {
            return (all, open);
        }
        last = now.map(|(all, _)| all);
        // Answers are 100 ms old at most: what comes later than that is no more.
        sleep(Duration::from_millis(if last.is_some() { 120 } else { 10 }));
    }
}

#[test]
fn nothing_that_was_accepted_is_lost_or_done_twice() {
    kill_at_random_moments("memory-killed", false);
}

#[test]
fn nothing_that_was_accepted_is_lost_or_done_twice_while_components_crash() {
    kill_at_random_moments("memory-killed-crashing", true);
}

fn kill_at_random_moments(folder: &str, crashes: bool) {
    let folder = empty_folder(folder);
    let mut fleet = crossing().replace("at 0.1s 80 times luggage random to random", "at 0.1s luggage (1,1) to (2,2)");
    if crashes {
        let period = r#"<property name="period">10</property>"#;
        let crashing = fleet.replace(period, &format!(r#"{period}<property name="restart">onFailure</property>"#));
        assert_ne!(crashing, fleet);
        fleet = crashing;
    }
    fs::write(folder.join("f.composite"), fleet).unwrap();
    let kills = kills();
    let socket = folder.join("socket");
    let mut dice = Dice(7);
    // One after the other: who crashes twice before it has executed loses what it heard.
    let mut crashing = CRASHING.iter().cycle();
    // The pieces that were accepted, and those that were sent without an answer: these may be there.
    let (mut accepted, mut unanswered) = (1, 0);
    let mut has_crashed = false;
    for kill in 0..kills {
        let mut program = start(&folder);
        if dice.below(4) == 0 {
            // In its start, too.
            sleep(Duration::from_millis(dice.below(300)));
        } else {
            let (all, open) = wait_for_pieces(&mut program, &socket, accepted);
            assert!(
                all <= accepted + unanswered,
                "kill {kill}: {all} pieces, {accepted} accepted, {unanswered} more sent"
            );
            (accepted, unanswered) = (all, 0);
            let until = Instant::now() + Duration::from_millis(dice.below(400));
            for _ in open..MOST_OPEN {
                if Instant::now() >= until {
                    break;
                }
                let [x, y, to] = [dice.below(6), dice.below(6), dice.below(5)];
                let line = format!("luggage ({x},{y}) to ({},{y})", (x + 1 + to) % 6);
                let answer = ask(&socket, "POST", "/v1/events", &line).unwrap();
                assert_eq!(answer["events"], 1);
                accepted += 1;
                if crashes {
                    let who = crashing.next().unwrap();
                    let line = format!("crash {who} restart {}ms", 1 + dice.below(40));
                    ask(&socket, "POST", "/v1/events", &line).unwrap();
                }
            }
            sleep(until.saturating_duration_since(Instant::now()));
            // One that has no answer before the kill.
            let _stream = send(&socket, "POST", "/v1/events", "luggage (0,1) to (5,4)").unwrap();
            unanswered += 1;
            sleep(Duration::from_micros(dice.below(15_000)));
        }
        drop(program);
        has_crashed |= fs::read_to_string(folder.join("told")).unwrap().contains("it crashes by fault injection");
    }
    assert_eq!(has_crashed, crashes);
    let output = saoms_in(&folder, &["run", "f.composite", "--state", "state", "--invariants", "--control", "none"]);
    let told = text(&output);
    assert_eq!(output.status.code(), Some(0), "{told}");
    let done = told.lines().find(|line| line.contains("pieces of luggage delivered")).unwrap();
    let number = |text: &str| -> u64 { text.rsplit(' ').next().unwrap().parse().unwrap() };
    let (delivered, rest) = done.split_once(" of ").unwrap();
    let all: u64 = rest.split(' ').next().unwrap().parse().unwrap();
    assert_eq!(number(delivered), all, "{told}");
    assert!((accepted..=accepted + unanswered).contains(&all), "{accepted} accepted, {unanswered} more sent: {told}");
    assert!(done.contains("no collision"), "{told}");
    assert!(!told.contains("begins anew"), "{told}");
}

#[test]
fn what_was_acknowledged_calls_nobody_again() {
    let folder = empty_folder("memory-alerts");
    let fleet = crossing().replace("at 0.1s 80 times luggage random to random", "at 0.1s luggage (1,1) to (2,2)");
    fs::write(folder.join("f.composite"), fleet).unwrap();
    let socket = folder.join("socket");
    let stranded = || -> Vec<Value> {
        let alerts = ask(&socket, "GET", "/v1/alerts", "").unwrap();
        let all = alerts.as_array().or(alerts["alerts"].as_array()).unwrap();
        all.iter().filter(|alert| alert["kind"] == "stranded" && alert["over_s"].is_null()).cloned().collect()
    };
    let answers = || {
        let until = Instant::now() + PATIENCE;
        while ask(&socket, "GET", "/v1/status", "").is_err() {
            assert!(Instant::now() < until, "it answers");
            sleep(Duration::from_millis(20));
        }
    };
    let mut program = start(&folder);
    answers();
    let until = Instant::now() + PATIENCE;
    while stranded().is_empty() {
        assert!(Instant::now() < until, "a robot without a charge is stranded");
        for robot in 1..=4 {
            ask(&socket, "POST", "/v1/events", "luggage (2,2) to (3,3)").unwrap();
            sleep(Duration::from_millis(60));
            ask(&socket, "POST", "/v1/events", &format!("drain robot={robot} percent=100")).unwrap();
        }
    }
    sleep(Duration::from_millis(300));
    ask(&socket, "POST", "/v1/alerts/ack?by=anna", "").unwrap();
    let before = stranded();
    for _ in 0..2 {
        drop(program);
        program = start(&folder);
        answers();
        // It answers before its components have started.
        let until = Instant::now() + PATIENCE;
        while stranded().len() < before.len() {
            assert!(Instant::now() < until, "the alerts are there again");
            sleep(Duration::from_millis(20));
        }
        let after = stranded();
        let of = |alerts: &[Value]| alerts.iter().map(|alert| alert["component"].clone()).collect::<Vec<_>>();
        assert_eq!(of(&after), of(&before));
        assert!(after.iter().all(|alert| alert["acknowledged"]["by"] == "anna"), "{after:?}");
    }
}

#[test]
fn events_among_the_faults_happen_once() {
    let folder = empty_folder("memory-faults");
    let fleet = crossing().replace("at 0.1s 80 times luggage random to random", "at 0.1s luggage (1,1) to (2,2)");
    fs::write(folder.join("f.composite"), fleet).unwrap();
    fs::write(folder.join("faults"), "at 0s lose 1 % on POSTOPIC\nat 4s luggage (3,3) to (4,4)\n").unwrap();
    let socket = folder.join("socket");
    for _ in 0..2 {
        let mut program = start_with(&folder, &["--faults", "faults"]);
        assert_eq!(wait_for_pieces(&mut program, &socket, 1).0, 1, "killed before the event");
        // Behind the next moment that is kept.
        sleep(Duration::from_millis(600));
    }
    // Two events with the number of one piece are one piece: the journal says how often it came.
    let arguments = ["run", "f.composite", "--state", "state", "--control", "none", "--faults", "faults"];
    let output = saoms_in(&folder, &[&arguments[..], &["--journal", "journal"]].concat());
    let journal = fs::read_to_string(folder.join("journal")).unwrap();
    let is_event = |line: &&str| line.contains("\"(outside)\"") && line.contains("luggage (3,3) to (4,4)");
    assert_eq!(journal.lines().filter(is_event).count(), 1, "{}", text(&output));
    let mut program = start_with(&folder, &["--faults", "faults"]);
    assert_eq!(wait_for_pieces(&mut program, &socket, 2).0, 2, "after its time");
}
