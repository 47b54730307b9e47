//! The server and its client over a real socket, with a real fleet.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod hostile;
mod network;
mod pages;
mod places;
mod view;

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

use saoms_control::{
    AlertList, Client, ControlServer, ControlledFleet, FleetDescription, Listener, LogTail, NetworkListener, Places,
    SentLine, Token, TokenFile, Tokens, TopicWatch, openapi, view_token_beside,
};
use saoms_core::schedule::{RunningFleet, Settings};
use saoms_lang::assembly::Assembly;
use tempfile::TempDir;

/// A server for a fleet without components, in virtual time, on a socket and on the network.
struct Served {
    client: Client,
    of_network: Client,
    /// Address and port.
    address: String,
    /// The files with the tokens.
    token: PathBuf,
    view_token: PathBuf,
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
    let alerts: Arc<AlertList> = Arc::default();
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
        url: None,
        token_file: None,
        view_token_file: None,
        history: None,
        seed: 1,
    };
    let downs = Arc::new(AtomicUsize::new(0));
    let counted = Arc::clone(&downs);
    let send =
        |line: &str| if line == "wrong" { Err("no \u{1b}[2J such event".to_owned()) } else { Ok(SentLine::Events(2)) };
    let down = move || {
        counted.fetch_add(1, Ordering::SeqCst);
    };
    let controlled = ControlledFleet::new(description, fleet.handle(), (log, topics, alerts), send, down);
    let token = folder.path().join("fleet.sock.token");
    let view_token = view_token_beside(&socket);
    let tokens = Tokens { control: TokenFile::create(&token).unwrap(), view: TokenFile::create(&view_token).unwrap() };
    let network = NetworkListener::bind("127.0.0.1:0", false, tokens).unwrap();
    let of_network = Client::of_network(&network.url(), Token::read(&token).unwrap()).unwrap();
    let address = network.url().strip_prefix("http://").unwrap().to_owned();
    let places = Places { socket: Some(Listener::bind(&socket).unwrap()), network: Some(network) };
    let server = ControlServer::start(places, controlled).unwrap();
    let client = Client::new(&socket);
    Served {
        client,
        of_network,
        address,
        token,
        view_token,
        downs,
        socket,
        _server: server,
        _fleet: fleet,
        _folder: folder,
    }
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
