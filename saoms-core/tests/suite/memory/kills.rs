//! A program that is killed at many moments: what was committed or accepted before a kill is there after it, once.

use std::collections::BTreeSet;
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::atomic::Ordering;
use std::thread::sleep;
use std::time::{Duration, Instant};

use saoms_api::Time;
use saoms_core::schedule::{InjectedContent, Injection};
use serde_json::json;

use super::{SAID, behind, counted, first_number, run, start};
use crate::fleet::real;

/// The folder in which a killed program keeps its state; without it, this is no such program.
const FOLDER: &str = "SAOMS_TEST_MEMORY";
/// True if components of that program panic.
const PANICS: &str = "SAOMS_TEST_MEMORY_PANICS";

/// The fleet of a killed program.
fn fleet_that_is_killed(panics: bool) -> String {
    let more = |panics: u64| format!(" panics={panics} restart=1ms/1000 queue=1000");
    let [teller, hearer] = if panics { [more(7), more(5)] } else { Default::default() };
    format!("T teller period=2 peer=B{teller}\nB book\nH hearer period=3 trigger=NUMBERS{hearer}")
}

/// The program that [`kill_at_many_moments`] kills: it prints what is committed and accepted.
#[test]
fn program_that_is_killed() {
    let Some(folder) = std::env::var_os(FOLDER) else { return };
    let fleet = fleet_that_is_killed(std::env::var(PANICS).as_deref() == Ok("true"));
    let (fleet, diary) = start(&fleet, real(60_000), Path::new(&folder));
    let handle = fleet.handle();
    let mut printed = 0;
    let until = Instant::now() + Duration::from_secs(20);
    while Instant::now() < until {
        let lines = diary.lines();
        lines.lines().skip(printed).for_each(|line| eprintln!("{line}"));
        printed = lines.lines().count();
        let said = SAID.load(Ordering::SeqCst);
        let number = handle.counter("numbers") + 1;
        let together = handle.together();
        handle.set_counter("numbers", number);
        let content = InjectedContent::Fields(json!({"value": number}));
        let at = (number % 3 == 0).then(|| handle.progress().time + Duration::from_millis(number % 20));
        handle.inject(Injection { topic: "NUMBERS".to_owned(), content, at, text: format!("{number}") }).unwrap();
        drop(together);
        handle.commit(Duration::from_secs(10)).unwrap();
        eprintln!("committed {said}, accepted {number}");
    }
}

#[test]
fn nothing_that_was_accepted_is_lost_by_a_kill() {
    kill_at_many_moments(false);
}

#[test]
fn nothing_that_was_accepted_is_lost_by_a_kill_while_components_panic() {
    kill_at_many_moments(true);
}

fn kill_at_many_moments(panics: bool) {
    let folder = tempfile::tempdir().unwrap();
    let mut time = Time::START;
    let (mut committed, mut accepted, mut has_panicked) = (0, 0, false);
    for milliseconds in [60, 5, 75, 90, 61, 12, 80, 66, 94, 2, 72, 69, 85, 31, 47] {
        let mut program = Command::new(std::env::current_exe().unwrap());
        program.args(["--exact", "memory::kills::program_that_is_killed", "--nocapture"]);
        program.env(FOLDER, folder.path()).env(PANICS, panics.to_string());
        let mut program = program.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
        let mut lines = BufReader::new(program.stderr.take().unwrap()).lines().map_while(Result::ok);
        let mut told: Vec<String> = Vec::new();
        while !(told.iter().any(|line| line.contains("T: has said"))
            && told.iter().any(|line| line.contains("H: has heard")))
        {
            told.push(lines.next().unwrap_or_else(|| panic!("it ended: {told:?}")));
        }
        sleep(Duration::from_millis(milliseconds));
        program.kill().unwrap();
        program.wait().unwrap();
        told.extend(lines);
        let all = told.join("\n");
        assert!(!all.contains("gap") && !all.contains("begins anew"), "{all}");
        assert!(panics || !all.contains("panicked"), "{all}");
        has_panicked |= all.contains("it was told to");
        let begins = first_number(behind(&all, "T: has said "));
        assert!(begins >= committed, "{committed} were said and committed: {all}");
        let began = Time::from_nanos(
            first_number(behind(&all, "T: has said ").replace('.', "").split(" at ").nth(1).unwrap()) * 1_000_000,
        );
        assert!(began >= time, "the time goes on from {time}: {all}");
        time = began;
        // After each panic it says that anew.
        let heard = all.lines().rfind(|line| line.contains("H: has heard up to ")).unwrap();
        let heard = heard.rsplit_once('[').unwrap().1.trim_end_matches(']');
        let heard: Vec<u64> = heard.split(", ").filter_map(|number| number.parse().ok()).collect();
        let once: BTreeSet<u64> = heard.iter().copied().collect();
        assert_eq!(once.len(), heard.len(), "each once: {all}");
        let late = (1..=accepted).filter(|number| !once.contains(number)).collect::<Vec<u64>>();
        // What was accepted for a later time is still to come.
        assert!(late.iter().all(|number| number % 3 == 0 && number + 60 > accepted), "{late:?} of {accepted}: {all}");
        for line in all.lines().filter_map(|line| line.strip_prefix("committed ")) {
            let (said, number) = line.split_once(", accepted ").unwrap();
            (committed, accepted) = (said.parse().unwrap(), number.parse().unwrap());
        }
    }
    assert!(committed > 50 && accepted > 50, "{committed} {accepted}");
    assert_eq!(has_panicked, panics);
    // The report has counted each execution that did not fail, once.
    let (report, told) = run(&fleet_that_is_killed(false), real(60), folder.path(), |_| {});
    assert_eq!(counted(&report), first_number(behind(&told, "T: ends with ")), "{told}");
}
