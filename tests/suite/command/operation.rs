//! Fleets in few lines as their operator has them: values from outside, tables, the wiring report, severities.

use std::fs;

use serde_json::Value;

use crate::support::{code, command, saoms, stderr, stdout};

const HANGAR: &str = "composites/hangar.composite";

#[test]
fn the_command_line_counts_before_the_environment_and_that_before_the_file() {
    let components = |arguments: &[&str], environment: &[(&str, &str)]| {
        let output =
            command(&[&["check", HANGAR], arguments].concat()).envs(environment.iter().copied()).output().unwrap();
        stdout(&output).split(' ').next().unwrap().parse::<u32>().unwrap()
    };
    assert_eq!(components(&[], &[]), 44);
    assert_eq!(components(&[], &[("HANGAR_ROBOTS", "20")]), 24);
    assert_eq!(components(&["--set", "robots=14"], &[("HANGAR_ROBOTS", "20")]), 18);
    assert_eq!(components(&["--set", "landings=false"], &[]), 43);
    let output = command(&["check", HANGAR]).env("HANGAR_ROBOTS", "twenty").output().unwrap();
    let shown = stderr(&output);
    assert_eq!(output.status.code(), Some(2));
    assert!(shown.contains("1 | HANGAR_ROBOTS=twenty") && shown.matches("error[S2042").count() == 1, "{shown}");
    let shown = stderr(&saoms(&["check", HANGAR, "--set", "robot=3"]));
    assert!(shown.contains("replace `robot` with `robots`"), "{shown}");
}

#[test]
fn the_wiring_report_says_who_talks_to_whom() {
    let shown = stdout(&saoms(&["check", "--wiring", HANGAR]));
    let robots = "40 of saoms.Robot every 500ms: Robot01 to Robot40";
    let master = "MasterEnvironment (saoms.MasterEnvironment every 500ms)";
    assert!(shown.contains(&format!("POSTOPIC  state topic of Position, 80 messages/s if each execution sends one\n  published by {robots}\n  read by {master}\n  read by {robots}\n")), "{shown}");
    assert!(shown.ends_with("44 components: 0 errors, 0 warnings\n"), "{shown}");
    let shown = stdout(&saoms(&["check", "--wiring", "--format", "json", HANGAR]));
    let value: Value = serde_json::from_str(&shown).unwrap();
    let topics = value["wiring"]["topics"].as_array().unwrap();
    let topic = topics.iter().find(|topic| topic["name"] == "POSTOPIC").unwrap();
    assert_eq!(topic["writers"][0]["components"].as_array().unwrap().len(), 40);
    assert_eq!(topic["writers"][0]["period_us"], 500_000);
    let shown = stdout(&saoms(&["check", "--wiring", "--format", "sarif", HANGAR]));
    let value: Value = serde_json::from_str(&shown).unwrap();
    assert_eq!(value["runs"][0]["properties"]["wiring"]["topics"].as_array().unwrap().len(), topics.len());
    assert!(stderr(&saoms(&["check", HANGAR])).is_empty(), "notes come with the report alone");
}

/// As many robots as are asked for, on a charger each, and a master with a queue of its own length.
fn robots(folder: &std::path::Path) -> String {
    let path = folder.join("many.composite");
    let text = r#"<composite xmlns="http://docs.oasis-open.org/ns/opencsa/sca/200912" xmlns:saoms="urn:saoms:1" targetNamespace="urn:m" name="many">
<property name="robots">1000</property>
<component name="Master"><implementation.rust class="saoms.MasterEnvironment"/><property name="ID">Master</property><property name="period">500</property><property name="queue">1024</property></component>
<component name="Robot${index}" saoms:count="robots"><implementation.rust class="saoms.Robot"/><property name="ID">Robot${index}</property>
<property name="period">1000</property><property name="chargeY">${index}</property></component>
</composite>"#;
    fs::write(&path, text).unwrap();
    path.display().to_string()
}

#[test]
fn a_thousand_robots_are_too_many_for_a_queue_that_forty_fit_into() {
    let folder = tempfile::tempdir().unwrap();
    let path = robots(folder.path());
    let output = saoms(&["check", "--wiring", &path]);
    let shown = stderr(&output);
    assert_eq!(output.status.code(), Some(0), "{shown}");
    assert!(shown.contains("note[S4013]") && shown.contains("of topic `ELMSTOPIC`"), "{shown}");
    let shown = stderr(&saoms(&["check", "--wiring", &path, "--set", "robots=40"]));
    assert!(!shown.contains("S4013"), "{shown}");
}

#[test]
fn severities_of_the_command_line_decide_the_exit_code() {
    let folder = tempfile::tempdir().unwrap();
    let path = robots(folder.path());
    let check = |more: &[&str]| saoms(&[&["check", "--wiring", &path], more].concat());
    assert_eq!(check(&["--severity", "S4013=error"]).status.code(), Some(2));
    let codes = ["S4010=allow", "S4011=allow", "S4013=allow", "S4014=allow", "S5018=allow"];
    let options: Vec<&str> = codes.iter().flat_map(|code| ["--severity", code]).collect();
    let allowed = check(&options);
    assert_eq!((allowed.status.code(), stderr(&allowed)), (Some(0), String::new()));
    let run = saoms(&["run", &path, "--virtual", "--severity", "S3001=alow"]);
    assert_eq!(run.status.code(), Some(2));
    assert!(stderr(&run).contains("replace it with `allow`"), "{}", stderr(&run));
}

#[test]
fn the_manuals_files_check_and_run_as_they_are() {
    let files = ["robotenvironment", "launchbroker", "launchtasks"];
    for name in files {
        let path = format!("composites/manual/{name}.composite");
        let output = saoms(&["check", &path]);
        assert_eq!(code(&output), 0, "{name}: {}", stderr(&output));
        // What goes beyond one program is in `network`.
        let output = saoms(&["run", &path, "--virtual", "--for", "200ms"]);
        assert_eq!(code(&output), 0, "{name}: {}", stderr(&output));
    }
    let both = ["composites/manual/launchbroker.composite", "composites/manual/launchtasks.composite"];
    let output = saoms(&["run", both[0], both[1], "--virtual", "--for", "10s", "--report", "-", "--quiet"]);
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    let report: Value = serde_json::from_str(&stdout(&output)).unwrap();
    let names: Vec<&str> =
        report["components"].as_array().unwrap().iter().map(|one| one["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["MessageBrokerComponent", "Robot001", "Robot002"]);
}
