//! A password is shown nowhere: one is given in each way, and looked for in everything that programs say and write.

use std::fs;
use std::io::{Read, Write};
use std::net::TcpStream;
use std::os::unix::net::UnixStream;
use std::path::Path;
use std::process::Command;

use serde_json::Value;

use super::certificates::write_private;
use super::nodes::at_node;
use super::programs::{Given, Programs, Transport, component, on_network};
use crate::plugins::library;
use crate::support::{command, stdout, text};

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

/// What a server answers to a request with a token, if one is needed. It succeeds.
#[track_caller]
fn get(mut stream: impl Read + Write, host: &str, route: &str, token: Option<&str>) -> Vec<u8> {
    let token = token.map(|token| format!("Authorization: Bearer {token}\r\n")).unwrap_or_default();
    let request = format!("GET {route} HTTP/1.1\r\nHost: {host}\r\n{token}Connection: close\r\n\r\n");
    stream.write_all(request.as_bytes()).unwrap();
    let mut answer = Vec::new();
    if route == STREAM {
        // It has no end: the first thing that it tells is enough.
        let has_told = |answer: &[u8]| String::from_utf8_lossy(answer).contains("event: status");
        while !has_told(&answer) {
            let mut some = [0; 4096];
            let size = stream.read(&mut some).unwrap();
            assert!(size > 0, "{}", String::from_utf8_lossy(&answer));
            answer.extend_from_slice(&some[..size]);
        }
    } else {
        stream.read_to_end(&mut answer).unwrap();
    }
    let text = String::from_utf8_lossy(&answer);
    let body = text.split_once("\r\n\r\n").map(|(_, body)| body).unwrap_or_default();
    assert!(text.starts_with("HTTP/1.1 200 ") && !body.trim().is_empty(), "{route}: {text}");
    answer
}

/// What a page gets as long as it is open.
const STREAM: &str = "/v1/stream";

/// A way to give the password: properties of the broker and of the tasks, and the files in which it stands.
struct Way {
    broker: Given<'static>,
    tasks: Given<'static>,
    files: &'static [&'static str],
}

#[test]
fn no_output_of_a_run_has_the_password() {
    let in_texts = &[("user", "fleet"), ("password", SENTINEL)];
    let in_environment = &[("user", "fleet"), ("password", "$SAOMS_PASSWORD")];
    let in_file = &[("user", "fleet"), ("passwordFile", "password")];
    let ways = [
        Way { broker: in_texts, tasks: in_texts, files: &["fleet.composite"] },
        Way { broker: in_environment, tasks: in_environment, files: &[] },
        Way { broker: &[("users", "users")], tasks: in_file, files: &["users", "password"] },
    ];
    for way in &ways {
        is_shown_nowhere(way);
    }
}

#[track_caller]
fn is_shown_nowhere(way: &Way) {
    let programs = Programs::over(Transport::Zenoh);
    let url = programs.url(programs.port);
    let in_file = |name: &str, text: &str| {
        if way.files.contains(&name) {
            write_private(&programs.folder().join(name), text);
        }
    };
    in_file("password", SENTINEL);
    in_file("users", &format!("fleet:{SENTINEL}\n"));
    let port = programs.port.to_string();
    let address = [&[("IP", "127.0.0.1"), ("port", &*port)][..], way.broker].concat();
    let scenario = [("scenario", "at 1s luggage (3,1) to (3,10)\nat 1s luggage (5,1) to (5,10)")];
    let tasks = [
        ("World", "saoms.World", &[][..]),
        ("Environment", "saoms.Environment", &scenario[..]),
        ("Master", "saoms.MasterEnvironment", &[][..]),
        ("Robot001", "robot.Robot001", &[][..]),
    ];
    let components =
        at_node("broker", component("Broker", "saoms.MessageBroker", &address)) + &on_network(&url, way.tasks, &tasks);
    programs.write(
        "fleet.composite",
        &format!(
            "<composite xmlns=\"http://docs.oasis-open.org/ns/opencsa/sca/200912\" xmlns:s=\"urn:saoms:1\" \
             targetNamespace=\"urn:fleet\" name=\"fleet\" s:defaultNode=\"tasks\">\n{components}</composite>\n"
        ),
    );
    let start = |node: &str, configure: &dyn Fn(&mut Command)| {
        programs.run_with(node, &["run", "fleet.composite", "--node", node], |command| {
            command.env("SAOMS_PASSWORD", SENTINEL).env("RUST_LOG", "trace");
            configure(command);
        })
    };
    let broker = start("broker", &|command| {
        command.args(["--report", "broker.json"]);
    });
    programs.until(&broker, "listens at");
    let fleet = start("tasks", &|command| {
        command.args(["--report", "report.json", "--journal", "journal.ndjson", "--history", "history.db"]);
        command
            .args(["--timeline", "timeline.svg", "--paths", "paths.svg", "--log", "log.txt", "--log-level", "debug"]);
        command.args(["--state", "state", "--serve", "127.0.0.1:0", "--stay"]);
    });
    programs.until(&fleet, "has joined the network at");
    programs.until(&fleet, "deposited luggage");
    let ask = |arguments: &[&str]| {
        let mut ask = command(arguments);
        ask.current_dir(programs.folder()).env("XDG_RUNTIME_DIR", programs.folder()).env("SAOMS_PASSWORD", SENTINEL);
        let output = ask.output().unwrap();
        assert!(output.status.success() && !output.stdout.is_empty(), "{arguments:?}: {}", text(&output));
        is_not_in(&format!("{arguments:?}"), &[&output.stdout[..], &output.stderr].concat());
        stdout(&output)
    };
    let socket = programs.socket(&fleet);
    let socket = socket.to_str().unwrap();
    for arguments in [
        &["status", "--format", "json"][..],
        &["logs"],
        &["topic", "list", "--format", "json"],
        &["why", "Robot001"],
        &["plan", "fleet.composite"],
    ] {
        ask(&[arguments, &["--fleet", socket]].concat());
    }
    ask(&["ps"]);
    let zenoh = library("saoms_zenoh");
    let over = ["status", "--url", &url, "--user", "fleet", "--plugin", zenoh.to_str().unwrap()];
    ask(&over);
    write_private(&programs.folder().join("own"), SENTINEL);
    ask(&[&over[..], &["--password-file", "own"]].concat());
    for route in ["/v1/openapi.json", "/metrics", "/v1/fleet", "/v1/status", "/v1/topics"] {
        is_not_in(route, &get(UnixStream::connect(socket).unwrap(), "localhost", route, None));
    }
    // What browsers get.
    let listed: Value = serde_json::from_str(&ask(&["ps", "--format", "json"])).unwrap();
    let served = listed.as_array().unwrap().iter().find(|one| one["url"].is_string()).unwrap();
    let token = fs::read_to_string(served["token_file"].as_str().unwrap()).unwrap();
    let address = served["url"].as_str().unwrap().strip_prefix("http://").unwrap().trim_end_matches('/');
    for route in ["/", "/v1/session", "/v1/figures", "/v1/picture.svg", STREAM] {
        is_not_in(route, &get(TcpStream::connect(address).unwrap(), address, route, Some(token.trim())));
    }
    for program in [&broker, &fleet] {
        // The environment of a process is for its user alone; its command line is for all.
        is_not_in("the command line", &fs::read(format!("/proc/{}/cmdline", program.pid())).unwrap());
    }
    programs.stop(&fleet);
    programs.end_without(&broker, &[SENTINEL, "panicked"]);
    ask(&["report", "merge", "broker.json", "report.json"]);
    let written = files(programs.folder());
    let outputs =
        ["report.json", "broker.json", "journal.ndjson", "timeline.svg", "paths.svg", "log.txt", "history.db"];
    for name in outputs {
        assert!(written.iter().any(|path| path.ends_with(name)), "{name}: {written:?}");
    }
    let has_it = |path: &Path| path.ends_with("own") || way.files.iter().any(|name| path.ends_with(name));
    for path in written.iter().filter(|path| !has_it(path)) {
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
