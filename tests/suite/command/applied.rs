//! Kills while a change of a fleet with a state folder is made: what was answered is kept, and what runs is what the
//! program was started with. `SAOMS_KILLS=1000` makes it a long one.

use std::fs;
use std::process::Stdio;
use std::thread::sleep;
use std::time::{Duration, Instant};

use super::memory::{Dice, kills, start, wait_for_pieces};
use super::state::crossing;
use crate::support::{PATIENCE, Program, ask, command, empty_folder, saoms_in, stdout, text};

/// Most pieces that are open at once, so that the robots keep up.
const MOST_OPEN: u64 = 8;

/// What the log says of a start with another fleet than the last one that was applied.
const WARNING: &str = "the fleet was changed by `saoms apply ";

/// Two fleets between which the changes lead: one has another robot, another period of a robot and one of the master.
fn fleets() -> [String; 2] {
    let fleet = crossing().replace("at 0.1s 80 times luggage random to random", "at 0.1s luggage (1,1) to (2,2)");
    let component = |fleet: &str, name: &str| {
        let begin = fleet.find(&format!("<component name=\"{name}\"")).unwrap();
        let end = begin + fleet[begin..].find("</component>").unwrap() + "</component>\n".len();
        fleet[begin..end].to_owned()
    };
    let mut other = fleet.clone();
    for name in ["Robot1", "Master"] {
        let present = component(&fleet, name);
        let slower = present.replace("name=\"period\">10<", "name=\"period\">20<");
        assert_ne!(slower, present);
        other = other.replace(&present, &slower);
    }
    let fifth = component(&fleet, "Robot4").replace("Robot4", "Robot5");
    let fifth = fifth.replace("name=\"chargeX\">5<", "name=\"chargeX\">2<");
    assert!(fifth.contains("name=\"chargeX\">2<"));
    [fleet, other.replace("</composite>", &format!("{fifth}</composite>"))]
}

#[test]
fn a_kill_while_a_change_is_made_leaves_one_fleet_whole() {
    let folder = empty_folder("memory-applied");
    let fleets = fleets();
    let socket = folder.join("socket");
    let fleet = ["--fleet", socket.to_str().unwrap()];
    let mut dice = Dice(5);
    let (mut accepted, mut answered, mut changed) = (1, 0, 0);
    // The fleet that was applied last, where that is known.
    let mut last = None;
    for kill in 0..kills() {
        let starts = dice.below(2) as usize;
        let wanted = 1 - starts;
        fs::write(folder.join("f.composite"), &fleets[starts]).unwrap();
        fs::write(folder.join("other.composite"), &fleets[wanted]).unwrap();
        let mut program = start(&folder);
        let (_, open) = wait_for_pieces(&mut program, &socket, accepted);
        let told = fs::read_to_string(folder.join("told")).unwrap();
        if let Some(last) = last {
            assert_eq!(told.contains(WARNING), last != starts, "kill {kill}: {told}");
        }
        let plan = saoms_in(&folder, &[&["plan", "f.composite"][..], &fleet].concat());
        assert_eq!(stdout(&plan), "nothing to do\n", "kill {kill}: {}", text(&plan));
        for _ in open..MOST_OPEN {
            let [x, y, to] = [dice.below(6), dice.below(6), dice.below(5)];
            let line = format!("luggage ({x},{y}) to ({},{y})", (x + 1 + to) % 6);
            ask(&socket, "POST", "/v1/events", &line).unwrap();
            accepted += 1;
        }
        let mut apply = command(&[&["apply", "other.composite"][..], &fleet].concat());
        let mut apply = apply.current_dir(&folder).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        // Half of them are killed right after it is answered, however slow the machine is, the others before that.
        let patience = if kill % 2 == 0 { PATIENCE } else { Duration::from_millis(dice.below(800)) };
        let until = Instant::now() + patience;
        while Instant::now() < until && apply.try_wait().unwrap().is_none() {
            sleep(Duration::from_millis(1));
        }
        drop::<Program>(program);
        let applied = apply.wait_with_output().unwrap();
        if applied.status.success() {
            (last, answered) = (Some(wanted), answered + 1);
            // What was answered is there: the same files have nothing to warn of.
            changed += usize::from(stdout(&applied).contains("done: "));
        } else {
            last = None;
        }
    }
    assert!(answered > 0 && changed > 0, "{answered} of the changes were answered");
    // All that was accepted is brought by the fleet with all robots.
    fs::write(folder.join("f.composite"), &fleets[1]).unwrap();
    let run = ["run", "f.composite", "--state", "state", "--invariants", "--control", "none", "--for", "120s"];
    let output = saoms_in(&folder, &run);
    let told = text(&output);
    assert_eq!(output.status.code(), Some(0), "{told}");
    let done = format!("{accepted} of {accepted} pieces of luggage delivered, no collision");
    assert!(told.contains(&done), "{accepted} accepted: {told}");
}

#[test]
fn a_start_with_other_files_than_those_applied_last_says_so() {
    let folder = empty_folder("memory-applied-told");
    let fleets = fleets();
    fs::write(folder.join("f.composite"), &fleets[0]).unwrap();
    fs::write(folder.join("other.composite"), &fleets[1]).unwrap();
    let socket = folder.join("socket");
    let start = || {
        let mut program = start(&folder);
        wait_for_pieces(&mut program, &socket, 1);
        (program, fs::read_to_string(folder.join("told")).unwrap())
    };
    let apply = |file: &str| {
        let output = saoms_in(&folder, &["apply", file, "--fleet", socket.to_str().unwrap()]);
        assert_eq!(output.status.code(), Some(0), "{}", text(&output));
        stdout(&output)
    };
    let (program, told) = start();
    assert!(!told.contains(WARNING), "{told}");
    assert!(apply("other.composite").contains("1 added, 2 replaced"));
    drop(program);
    // As often as it starts so, until somebody decides.
    for _ in 0..2 {
        let (program, told) = start();
        let other = folder.join("other.composite");
        let line = told.lines().find(|line| line.contains(WARNING)).unwrap_or_else(|| panic!("{told}"));
        let (before, after) = line.split_once("` on 20").unwrap_or_else(|| panic!("{line}"));
        assert!(before.ends_with(&format!("`saoms apply {}", other.display())), "{line}");
        let expected = format!(
            "Z, and this run is of another one, that of `saoms run f.composite`: `saoms apply {}` makes it the former, \
             `saoms apply f.composite` keeps the latter and ends this warning",
            other.display()
        );
        assert!(after.ends_with(&expected), "{line}");
        drop(program);
    }
    let (program, _) = start();
    assert_eq!(apply("f.composite"), "nothing to do\n");
    drop(program);
    let (program, told) = start();
    assert!(!told.contains(WARNING), "{told}");
    // A text that says the same is the same fleet.
    fs::write(folder.join("f.composite"), format!("<!-- Edited. -->\n{}", fleets[0])).unwrap();
    drop(program);
    let (_program, told) = start();
    assert!(!told.contains(WARNING), "{told}");
}
