//! A password is shown nowhere: one is given in each way, and looked for in everything that programs say and write.

use std::fs;
use std::path::Path;
use std::process::Command;

use super::certificates::write_private;
use super::programs::{Programs, Transport, component, on_network};
use crate::support::command;

/// The password that is looked for.
const SENTINEL: &str = "Xq7-sentinel-9vT";

/// All files in a folder and below it.
fn files(folder: &Path) -> Vec<std::path::PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        match path.is_dir() {
            true => found.extend(files(&path)),
            false if path.is_file() => found.push(path),
            false => {}
        }
    }
    found
}

#[track_caller]
fn is_not_in(what: &str, bytes: &[u8]) {
    let found = bytes.windows(SENTINEL.len()).any(|part| part == SENTINEL.as_bytes());
    assert!(!found, "{what} has the password");
}

#[test]
fn no_output_of_a_run_has_the_password() {
    let programs = Programs::over(Transport::Zenoh);
    let url = programs.url(programs.port);
    write_private(&programs.folder().join("password"), SENTINEL);
    let port = programs.port.to_string();
    let address = [("IP", "127.0.0.1"), ("port", &*port), ("user", "fleet"), ("password", "$SAOMS_PASSWORD")];
    let broker = programs.start_with("broker", &component("Broker", "saoms.MessageBroker", &address), |command| {
        command.env("SAOMS_PASSWORD", SENTINEL).env("RUST_LOG", "trace").args(["--report", "broker.json"]);
    });
    programs.until(&broker, "listens at");
    let account = [("user", "fleet"), ("passwordFile", "password")];
    let scenario = [("scenario", "at 1s luggage (3,1) to (3,10)\nat 1s luggage (5,1) to (5,10)")];
    let tasks = [
        ("World", "saoms.World", &[][..]),
        ("Environment", "saoms.Environment", &scenario[..]),
        ("Master", "saoms.MasterEnvironment", &[][..]),
        ("Robot001", "robot.Robot001", &[][..]),
    ];
    let fleet = on_network(&url, &account, &tasks);
    let fleet = programs.start_with("tasks", &fleet, |command| {
        command.env("RUST_LOG", "trace").args(["--report", "report.json", "--journal", "journal.ndjson"]);
        command
            .args(["--timeline", "timeline.svg", "--paths", "paths.svg", "--log", "log.txt", "--log-level", "debug"]);
        command.args(["--state", "state", "--control", "fleet.sock", "--stay"]);
    });
    programs.until(&fleet, "has joined the network at");
    programs.until(&fleet, "deposited luggage");
    let ask = |arguments: &[&str]| {
        let mut ask = command(arguments);
        let output = ask.current_dir(programs.folder()).env("XDG_RUNTIME_DIR", programs.folder()).output().unwrap();
        is_not_in(&format!("{arguments:?}"), &[output.stdout, output.stderr].concat());
    };
    let socket = programs.folder().join("fleet.sock");
    let socket = socket.to_str().unwrap();
    for arguments in [
        &["ps"][..],
        &["ps", "--format", "json"],
        &["status", "--format", "json"],
        &["logs"],
        &["topic", "list", "--format", "json"],
        &["why", "Robot001"],
    ] {
        let fleet: &[&str] = if arguments[0] == "ps" { &[] } else { &["--fleet", socket] };
        ask(&[arguments, fleet].concat());
    }
    for route in ["/v1/openapi.json", "/metrics", "/v1/fleet", "/v1/status", "/v1/topics"] {
        let output = Command::new("curl")
            .args(["--silent", "--unix-socket", socket, &format!("http://localhost{route}")])
            .output();
        // Without curl, `status` and `ps` have asked.
        if let Ok(output) = output {
            is_not_in(route, &output.stdout);
        }
    }
    for program in [&broker, &fleet] {
        // The environment of a process is for its user alone; its command line is for all.
        is_not_in("the command line", &fs::read(format!("/proc/{}/cmdline", program.pid())).unwrap());
    }
    programs.stop(&fleet);
    programs.end_without(&broker, &[SENTINEL, "panicked"]);
    let written = files(programs.folder());
    for name in ["report.json", "broker.json", "journal.ndjson", "timeline.svg", "paths.svg", "log.txt"] {
        assert!(written.iter().any(|path| path.ends_with(name)), "{name}: {written:?}");
    }
    for path in written.iter().filter(|path| !path.ends_with("password")) {
        is_not_in(&path.display().to_string(), &fs::read(path).unwrap());
    }
}

#[test]
fn composites_are_shown_and_expanded_without_the_password() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("fleet.composite");
    let text = |more: &str| {
        format!(
            "<composite xmlns=\"http://docs.oasis-open.org/ns/opencsa/sca/200912\" xmlns:saoms=\"urn:saoms:1\" \
             name=\"fleet\" targetNamespace=\"urn:fleet\">
<property name=\"secret\" saoms:env=\"HALL_PASSWORD\"/>
<component name=\"Broker\"><implementation.rust class=\"saoms.MessageBroker\"/><property name=\"user\">fleet</property>\
             <property name=\"password\">{SENTINEL}</property>{more}</component>
<component name=\"Master\"><implementation.rust class=\"saoms.MasterEnvironment\"/><property name=\"ID\">Master</property>\
             <property name=\"period\">100</property><property name=\"url\">localhost:61616</property>\
             <property name=\"user\">fleet</property><property name=\"password\" source=\"$secret\"/>{more}</component>
</composite>"
        )
    };
    let path = file.to_str().unwrap();
    fs::write(&file, text("")).unwrap();
    let run = |arguments: &[&str]| {
        let output = command(arguments).env("HALL_PASSWORD", SENTINEL).output().unwrap();
        let all = [output.stdout, output.stderr].concat();
        is_not_in(&format!("{arguments:?}"), &all);
        String::from_utf8(all).unwrap()
    };
    let expanded = run(&["expand", path]);
    assert!(expanded.contains("<property name=\"password\">$SAOMS_PASSWORD</property>"), "{expanded}");
    assert!(expanded.contains("<property name=\"password\">$HALL_PASSWORD</property>"), "{expanded}");
    for arguments in [&["check", path][..], &["check", "--wiring", path], &["graph", path]] {
        run(arguments);
    }
    // What is wrong on the same line is shown without it.
    fs::write(&file, text("<property name=\"pasword\">x</property>")).unwrap();
    for format in ["human", "json", "sarif"] {
        let found = run(&["check", path, "--format", format]);
        assert!(found.contains("pasword"), "{found}");
    }
    fs::write(&file, text("").replace("<property name=\"user\">fleet</property>", "")).unwrap();
    let found = run(&["check", path]);
    assert!(found.contains("`password` is given without `user`") && found.contains("****"), "{found}");
}
