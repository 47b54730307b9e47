//! `saoms replay`: a recording on the page of `saoms view`.

use std::fs;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::path::Path;
use std::process::Stdio;

use serde_json::Value;

use crate::support::{Program, code, command, project, saoms_in, stderr, text};

/// What the page gets of the run that a command shows.
#[track_caller]
fn shown(folder: &Path, arguments: &[&str]) -> Value {
    let child = command(arguments).current_dir(folder).stdout(Stdio::piped()).spawn().unwrap();
    let mut program = Program(child);
    let mut line = String::new();
    BufReader::new(program.0.stdout.take().unwrap()).read_line(&mut line).unwrap();
    let url = line.split_whitespace().find_map(|word| word.strip_prefix("http://")).unwrap();
    let (host, path) = url.split_once('/').unwrap();
    let mut stream = TcpStream::connect(host).unwrap();
    let request = format!("GET /{path}run HTTP/1.1\r\nHost: {host}\r\nConnection: close\r\n\r\n");
    stream.write_all(request.as_bytes()).unwrap();
    let mut answer = String::new();
    stream.read_to_string(&mut answer).unwrap();
    let (head, body) = answer.split_once("\r\n\r\n").unwrap();
    assert!(head.starts_with("HTTP/1.1 200 "), "{head}");
    serde_json::from_str(body).unwrap()
}

#[test]
fn a_recording_is_shown_as_the_report_of_its_run_is() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    fs::write(folder.join("fleet.composite"), project("composites/airport.composite")).unwrap();
    let run = ["run", "fleet.composite", "--virtual", "--quiet", "--record", "run.mcap"];
    let output = saoms_in(folder, &[&run[..], &["--report", "run.json"]].concat());
    assert_eq!(code(&output), 0, "{}", text(&output));
    let replayed = shown(folder, &["replay", "run.mcap"]);
    assert!(replayed["recording"]["samples"].as_array().unwrap().len() > 20, "{replayed}");
    assert_eq!(replayed, shown(folder, &["view", "run.json"]));
    // A recording has it also where nobody wants a report, or a short one.
    let output = saoms_in(folder, &[&run[..], &["--report", "short.json", "--short-report"]].concat());
    assert_eq!(code(&output), 0, "{}", text(&output));
    assert_eq!(shown(folder, &["replay", "run.mcap"]), replayed);
    assert!(!fs::read_to_string(folder.join("short.json")).unwrap().contains("\"recording\":"));

    let refused = |file: &str, expected: &str| {
        let output = saoms_in(folder, &["replay", file]);
        assert!(code(&output) == 2 && stderr(&output).contains(expected), "{file}: {}", text(&output));
    };
    let whole = fs::read(folder.join("run.mcap")).unwrap();
    fs::write(folder.join("cut.mcap"), &whole[..whole.len() / 3]).unwrap();
    refused("cut.mcap", "`cut.mcap` cannot be shown: it was not finished");
    refused("run.json", "`run.json` is no recording");
    refused("none.mcap", "none.mcap");
    let output = saoms_in(folder, &["record", "filter", "run.mcap", "--topic", "/tf", "-o", "part.mcap"]);
    assert_eq!(code(&output), 0, "{}", text(&output));
    assert_eq!(shown(folder, &["replay", "part.mcap"]), replayed, "a part has the report");
}
