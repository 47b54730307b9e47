//! How a run ends: its status, its exit code, and what is told of work that is left or was given up.

use std::fs;
use std::process::Output;

use serde_json::Value;

use crate::support::{code, empty_folder, project, saoms, stdout, text};

/// Runs the fleet of `hall.composite` in virtual time, changed so, with further options; the output and the report.
fn hall(name: &str, change: impl Fn(String) -> String, options: &[&str]) -> (Output, Value) {
    let folder = empty_folder(name);
    let (fleet, report) = (folder.join("hall.composite"), folder.join("report.json"));
    fs::write(&fleet, change(project("composites/hall.composite"))).unwrap();
    let mut arguments = vec!["run", fleet.to_str().unwrap(), "--virtual", "--report", report.to_str().unwrap()];
    arguments.extend(options);
    let output = saoms(&arguments);
    let report = fs::read(&report).map(|bytes| serde_json::from_slice(&bytes).unwrap());
    (output, report.unwrap_or_default())
}

/// The line that says how the run ended, and those below it up to the table.
fn end(output: &Output) -> String {
    // Where nothing happened, it is the first that is shown.
    let shown = format!("\n{}", stdout(output));
    let from = shown.find("\n\n").unwrap_or_else(|| panic!("{}", text(output))) + 2;
    shown[from..].split("\n\n").next().unwrap().to_owned()
}

#[test]
fn a_run_whose_luggage_was_given_up_is_incomplete() {
    let breaks = |composite: String| composite.replace("to (3,10)<", "to (3,10); at 1500ms breakdown Robot7<");
    let (output, report) = hall("outcome-given-up", breaks, &[]);
    assert_eq!(code(&output), 1, "{}", text(&output));
    let shown = stdout(&output);
    let line = |what: &str| shown.find(what).unwrap_or_else(|| panic!("no `{what}`: {shown}"));
    assert!(line("Robot7         error: breaks down at (2,6)") < line("gives up luggage 1"), "{shown}");
    let end = end(&output);
    assert!(end.starts_with("incomplete after 1.800 s: 0 of 1 pieces of luggage delivered, 1 given up, no"), "{end}");
    assert!(end.ends_with("\n  work was given up, reported by `World`, `Environment`, `Master`"), "{end}");
    assert_eq!(report["outcome"]["status"], "incomplete");
    assert_eq!(report["luggage"]["given_up"], 1);
    assert_eq!(report["votes"]["given_up"], serde_json::json!(["World", "Environment", "Master"]));
    // It is so whatever ends the run.
    let (output, report) = hall("outcome-given-up-for", breaks, &["--for", "1900ms"]);
    assert_eq!((code(&output), &report["outcome"]["status"]), (1, &Value::from("incomplete")));
}

#[test]
fn who_reads_errors_alone_is_told_of_an_end_that_is_one() {
    let off = |hall: String| {
        hall.replace(
            "Robot7\"/>",
            "Robot7\"/>\
        <property name=\"runOnStartup\" value=\"false\"/>",
        )
    };
    let (output, _) = hall("outcome-quiet", off, &["--quiet"]);
    assert_eq!(code(&output), 1, "{}", text(&output));
    assert_eq!(stdout(&output), "");
    let told = String::from_utf8(output.stderr).unwrap();
    assert!(told.starts_with("incomplete after ") && told.contains("\n  nothing has happened since "), "{told}");
    let (output, _) = hall("outcome-quiet-done", |hall| hall, &["--quiet"]);
    assert_eq!((code(&output), text(&output).as_str()), (0, ""));
}

/// A change of a composite's text.
type Change<'a> = &'a dyn Fn(String) -> String;

/// The component of this name, as `hall.composite` has it.
fn component(name: &str) -> String {
    let hall = project("composites/hall.composite");
    let from = hall.find(&format!("  <component name=\"{name}\"")).unwrap();
    let end = "</component>\n";
    hall[from..from + hall[from..].find(end).unwrap() + end.len()].to_owned()
}

#[test]
fn a_run_in_which_nothing_can_happen_any_more_ends_and_says_who_waits_for_what() {
    let wire = "    <reference name=\"world\" target=\"World\"/>\n";
    let id = "<property name=\"ID\" value=\"Robot7\"/>";
    let later = format!("{id}<property name=\"runOnStartup\" value=\"false\"/>");
    let needs_robot = "`World` waits for a robot with a reference `world` to it, to carry luggage 1";
    let off = |hall: String, id: &str| {
        let id = format!("<property name=\"ID\" value=\"{id}\"/>");
        hall.replace(&id, &format!("{id}<property name=\"runOnStartup\" value=\"false\"/>"))
    };
    let fleets: [(&str, Change<'_>, &str, &[&str]); 6] = [
        (
            "robot",
            &|hall| hall.replace(&component("Robot7"), ""),
            "1.100 s",
            &[needs_robot, "`Environment` and 1 more wait for a robot to carry luggage 1"],
        ),
        (
            "started",
            &|hall| hall.replace(id, &later),
            "1.100 s",
            &[needs_robot, "`Environment` and 1 more wait for a robot to carry luggage 1", "`Robot7` is not started"],
        ),
        (
            "master",
            &|hall| hall.replace(&component("Master"), ""),
            "1.100 s",
            &[
                "`World` waits for a robot to carry luggage 1",
                "`Environment` waits for a master of the environment to pass on luggage 1 on `ELMSTOPIC`",
                "`Robot7` waits for luggage",
            ],
        ),
        (
            "world",
            &|hall| hall.replace(wire, ""),
            "4.300 s",
            &[
                needs_robot,
                "`Environment` waits for nothing: its scenario is over",
                "`Master` waits for events",
                "`Robot7` waits for luggage",
            ],
        ),
        (
            "running-world",
            &|hall| off(hall, "World"),
            "1.000 s",
            &[
                "`Environment` and 1 more wait for a robot to carry luggage 1",
                "`World` is not started",
                "`Robot7` waits for its world, which does not run",
            ],
        ),
        (
            "running-environment",
            &|hall| off(hall, "Environment"),
            "0.000 s",
            &["`Environment` is not started", "`World` and 1 more wait for luggage", "`Master` waits for events"],
        ),
    ];
    for (name, change, since, waits) in fleets {
        let (output, report) = hall(&format!("outcome-no-{name}"), change, &[]);
        assert_eq!(code(&output), 1, "{}", text(&output));
        let told = format!("nothing has happened since {since}, and nothing more can: {}", waits.join("; "));
        let (first, rest) = end(&output).split_once('\n').map(|(one, rest)| (one.to_owned(), rest.to_owned())).unwrap();
        assert!(first.starts_with("incomplete after 6"), "{name}: {first}");
        assert_eq!(rest, format!("  {told}"), "{name}");
        assert_eq!(report["outcome"], serde_json::json!({"status": "incomplete", "reasons": [told]}));
        assert_eq!(report["standstill"]["ends"], true, "{name}");
        // Whoever gives the run a time keeps it, and is told once.
        let (output, report) = hall(&format!("outcome-no-{name}-for"), change, &["--for", "2h"]);
        assert_eq!((code(&output), &report["outcome"]["status"]), (0, &Value::from("elapsed")));
        let line = format!("warning: nothing has happened since {since}: {}\n", waits.join("; "));
        assert_eq!(stdout(&output).matches(&line).count(), 1, "{}", text(&output));
    }
}

#[test]
fn a_scenario_with_a_long_pause_is_played_to_its_end() {
    let pause = |hall: String| hall.replace("to (3,10)<", "to (3,10); at 50min luggage (3,1) to (3,5)<");
    let (output, report) = hall("outcome-pause", pause, &[]);
    assert_eq!((code(&output), &report["luggage"]["delivered"]), (0, &Value::from(2)), "{}", text(&output));
    assert_eq!(report["standstill"], Value::Null);
}

#[test]
fn a_fleet_without_components_is_refused() {
    let empty =
        r#"<composite xmlns="http://docs.oasis-open.org/ns/opencsa/sca/200912" name="e" targetNamespace="urn:e"/>"#;
    let file = empty_folder("outcome-empty").join("empty.composite");
    fs::write(&file, empty).unwrap();
    let file = file.to_str().unwrap();
    for arguments in [&["run", file][..], &["run", file, "--virtual"], &["simulate", file, "--seeds", "2"]] {
        let output = saoms(arguments);
        assert_eq!(code(&output), 2, "{}", text(&output));
        let why = format!("error: this fleet has no components: there is nothing to {}\n", arguments[0]);
        assert!(text(&output).contains(&why), "{}", text(&output));
    }
}
