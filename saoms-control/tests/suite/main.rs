//! The server and its client over a real socket, with a real fleet.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::io::{Read, Write};
use std::os::unix::net::UnixStream;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

use saoms_control::{Client, ControlServer, ControlledFleet, FleetDescription, Listener, LogTail, TopicWatch, openapi};
use saoms_core::schedule::{RunningFleet, Settings};
use saoms_lang::assembly::Assembly;
use tempfile::TempDir;

/// A server for a fleet without components, in virtual time.
struct Served {
    client: Client,
    downs: Arc<AtomicUsize>,
    socket: PathBuf,
    _server: ControlServer,
    _fleet: RunningFleet,
    _folder: TempDir,
}

fn served() -> Served {
    let folder = tempfile::tempdir().unwrap();
    let socket = folder.path().join("fleet.sock");
    let log: Arc<LogTail> = Arc::default();
    let topics: Arc<TopicWatch> = Arc::default();
    let settings = Settings { limit: Some(Duration::from_secs(60)), ..Settings::simulated(1) };
    let fleet =
        RunningFleet::start(Assembly::default(), settings, vec![Arc::clone(&log) as _, Arc::clone(&topics) as _])
            .unwrap();
    let description = FleetDescription {
        name: "a \"fleet\"".to_owned(),
        pid: 7,
        composites: vec!["fleet.composite".to_owned()],
        version: "1".to_owned(),
        started: 1,
        is_virtual: true,
        seed: 1,
    };
    let downs = Arc::new(AtomicUsize::new(0));
    let counted = Arc::clone(&downs);
    let send = |line: &str| if line == "wrong" { Err("no \u{1b}[2J such event".to_owned()) } else { Ok(2) };
    let down = move || {
        counted.fetch_add(1, Ordering::SeqCst);
    };
    let controlled = ControlledFleet::new(description, fleet.handle(), (log, topics), send, down);
    let server = ControlServer::start(Listener::bind(&socket).unwrap(), controlled).unwrap();
    Served { client: Client::new(&socket), downs, socket, _server: server, _fleet: fleet, _folder: folder }
}

#[test]
fn each_route_of_the_document_is_served() {
    let served = served();
    let document = served.client.request("GET", "/v1/openapi.json", "").unwrap().json().unwrap();
    assert_eq!(document, openapi());
    let paths = document["paths"].as_object().unwrap();
    assert!(paths.len() > 5);
    for (path, operations) in paths {
        for method in operations.as_object().unwrap().keys() {
            let path = path.replace(['{', '}'], "");
            let answer = served.client.request(&method.to_uppercase(), &path, "1");
            let missing = answer.is_err_and(|error| {
                let text = error.to_string();
                text.contains("no such route") || text.contains("HTTP status 4")
            });
            assert!(!missing, "{method} {path}");
        }
    }
    let lost = served.client.request("GET", "/v2/nothing", "").unwrap_err().to_string();
    assert!(lost.contains("no such route"), "{lost}");
}

#[test]
fn orders_are_taken_or_refused_with_a_reason() {
    let Served { client, downs, .. } = &served();
    assert_eq!(client.description().unwrap().name, "a \"fleet\"");
    assert_eq!(client.request("POST", "/v1/events", "right").unwrap().json().unwrap()["events"], 2);
    let refused = client.request("POST", "/v1/events", "wrong").unwrap_err().to_string();
    assert_eq!(refused, "no \u{1b}[2J such event");
    let refused = client.request("POST", "/v1/components/A%2FB/start", "").unwrap_err().to_string();
    assert_eq!(refused, "the fleet has no component `A/B`");
    let refused = client.request("POST", "/v1/components/A/start?for=10x", "").unwrap_err().to_string();
    assert!(refused.contains("`10x`"), "{refused}");
    client.request("POST", "/v1/down", "").unwrap();
    while downs.load(Ordering::SeqCst) == 0 {
        std::thread::sleep(Duration::from_millis(1));
    }
}

#[test]
fn what_is_no_request_harms_nothing() {
    let served = served();
    let oversized = "x".repeat(1_000_000);
    let refused = served.client.request("POST", "/v1/events", &oversized);
    assert!(refused.is_err());
    for number in 0..2000_u32 {
        let mut stream = UnixStream::connect(&served.socket).unwrap();
        let bytes = match number % 8 {
            0 => b"GET /v1/status".to_vec(),
            1 => vec![0xff; 300],
            2 => format!("GET /{} HTTP/1.1\r\nHost: x\r\n\r\n", "../".repeat(100)).into_bytes(),
            3 => b"POST /v1/events HTTP/1.1\r\nHost: x\r\nContent-Length: 99999999999999999999\r\n\r\n".to_vec(),
            4 => b"POST /v1/events HTTP/1.1\r\nHost: x\r\nContent-Length: -1\r\n\r\n".to_vec(),
            5 => b"GET /v1/logs?lines=18446744073709551616 HTTP/1.0\r\n\r\n".to_vec(),
            6 => format!("GET / HTTP/1.1\r\n{}\r\n\r\n", "a: b\r\n".repeat(1000)).into_bytes(),
            _ => b"PUT /v1/components/%ff/properties/%00 HTTP/1.0\r\nContent-Length: 1\r\n\r\nx".to_vec(),
        };
        // The server may have closed it.
        let _ = stream.write_all(&bytes);
        let _ = stream.shutdown(std::net::Shutdown::Write);
        let _ = stream.read(&mut [0; 16]);
    }
    assert_eq!(served.client.description().unwrap().pid, 7);
}
