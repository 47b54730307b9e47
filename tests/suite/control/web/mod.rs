//! Services over the web, with real processes: one that is offered, one that is called, and both with each other.

mod called;
mod offered;

use std::fs;
use std::io::{Read, Write};
use std::net::TcpStream;

use serde_json::{Value, json};

use super::{Running, component};
use crate::boundary::build;
use crate::support::{answer, command, text};

/// A composite that may use the namespace of SAOMS.
fn composite(components: &str) -> String {
    format!(
        "<composite xmlns=\"http://docs.oasis-open.org/ns/opencsa/sca/200912\" xmlns:s=\"urn:saoms:1\" \
         targetNamespace=\"urn:example\" name=\"fleet\">\n{components}</composite>\n"
    )
}

/// A store that offers its service in this way.
fn store(binding: &str, attributes: &str) -> String {
    format!(
        "<component name=\"Store\"><implementation.rust class=\"web.Store\"/><service name=\"stock\"{attributes}>\
         {binding}</service></component>\n"
    )
}

/// A customer of a store in the same fleet, which has something to do in each period.
fn local() -> String {
    component("Customer", "web.Customer", "<reference name=\"stock\" target=\"Store\"/>")
}

/// A customer whose reference leads to this server.
fn customer(uri: &str, attributes: &str, more: &str) -> String {
    let reference = format!("<reference name=\"stock\"{attributes}><binding.rest uri=\"{uri}\"/></reference>");
    component("Customer", "web.Customer", &(more.to_owned() + &reference))
}

fn start(components: &str, arguments: &[&str]) -> Running {
    let library = build::library("web");
    Running::start(&composite(components), &[&["--plugin", library.to_str().unwrap(), "--stay"], arguments].concat())
}

/// A fleet at an address of its own, with its tokens.
struct Server {
    running: Running,
    address: String,
    token: String,
    view_token: String,
}

impl Server {
    fn start(components: &str, arguments: &[&str]) -> Server {
        Server::of(start(components, &[&["--serve", "127.0.0.1:0"], arguments].concat()))
    }

    fn of(running: Running) -> Server {
        let listed: Value = serde_json::from_str(&running.told(&["ps", "--format", "json"])).unwrap();
        let read = |name: &str| fs::read_to_string(listed[0][name].as_str().unwrap()).unwrap().trim().to_owned();
        let address = listed[0]["url"].as_str().unwrap().strip_prefix("http://").unwrap().to_owned();
        Server { address, token: read("token_file"), view_token: read("view_token_file"), running }
    }

    /// The answer to a request: status, head and body.
    fn request(&self, method: &str, path: &str, token: &str, headers: &str, body: &str) -> (u16, String, String) {
        let length = body.len();
        let authorization = if token.is_empty() { String::new() } else { format!("Authorization: Bearer {token}\r\n") };
        let request = format!(
            "{method} {path} HTTP/1.1\r\nHost: {}\r\nConnection: close\r\n{authorization}{headers}Content-Length: {length}\r\n\r\n{body}",
            self.address
        );
        let mut stream = TcpStream::connect(&self.address).unwrap();
        stream.write_all(request.as_bytes()).unwrap();
        let mut answer = String::new();
        stream.read_to_string(&mut answer).unwrap();
        let (head, body) = answer.split_once("\r\n\r\n").unwrap();
        (head[9..12].parse().unwrap(), head.to_ascii_lowercase(), body.to_owned())
    }

    /// Calls an operation with the token of the control.
    fn call(&self, path: &str, body: &str) -> (u16, Value) {
        let (status, head, body) = self.request("POST", path, &self.token, "Content-Type: application/json\r\n", body);
        let kind = if status < 400 { "application/json" } else { "application/problem+json" };
        assert!(body.is_empty() || head.contains(&format!("content-type: {kind}")), "{head}\n{body}");
        (status, if body.is_empty() { Value::Null } else { serde_json::from_str(&body).unwrap() })
    }

    /// The problem that a call has.
    #[track_caller]
    fn problem(&self, path: &str, body: &str, status: u16) -> Value {
        let (found, problem) = self.call(path, body);
        assert_eq!(found, status, "{problem}");
        assert_eq!(problem["status"], status);
        assert_eq!(problem["error"], problem["detail"]);
        problem
    }
}

const BOLT: &str = r#"{"part": {"name": "bolt", "count": 3, "sizes": [1.5, 2], "note": null}}"#;

#[test]
fn a_fleet_calls_a_service_that_another_one_offers() {
    let server = Server::start(&store("<binding.rest uri=\"/stock\"/>", ""), &[]);
    assert_eq!(server.call("/stock/putPart", BOLT).0, 200);
    let library = build::library("web");
    let fleet = customer(&format!("http://{}/stock", server.address), " s:tokenEnv=\"STOCK_TOKEN\"", "");
    let run = |token: Option<&str>| {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("fleet.composite"), composite(&fleet)).unwrap();
        let arguments = ["run", "fleet.composite", "--plugin", library.to_str().unwrap(), "--for", "2s", "--allow-web"];
        let mut run = command(&arguments);
        run.current_dir(folder.path()).env("XDG_RUNTIME_DIR", folder.path()).env_remove("STOCK_TOKEN");
        answer(&token.into_iter().fold(&mut run, |run, token| run.env("STOCK_TOKEN", token)).output().unwrap())
    };
    let (code, printed, errors) = run(Some(&server.token));
    assert_eq!(code, 0, "{printed}{errors}");
    let heard = "heard [Part { name: \"bolt\", count: 3, sizes: [1.5, 2.0], note: None }]";
    assert!(printed.contains(heard), "{printed}{errors}");
    assert!(!printed.contains(&server.token) && !errors.contains(&server.token));
    let (_, printed, _) = run(Some(&server.view_token));
    assert!(printed.contains("answers `parts` with the status 403: this token has the right to view"), "{printed}");
    let (code, _, errors) = run(None);
    let place = "fleet.composite:2:";
    let all = ["error[S2071]: the environment variable `STOCK_TOKEN` is not set", place, "nothing was started"];
    assert!(code == 2 && all.iter().all(|part| errors.contains(part)), "{errors}");
}

#[test]
fn the_example_of_the_page_runs() {
    let page = crate::support::project("docs/web-services.md");
    let example = page.split("```xml\n").nth(1).unwrap().split("```").next().unwrap();
    let server = Server::of(Running::start(example, &["--stay", "--serve", "127.0.0.1:0"]));
    let body = |call: &str| {
        let (_, rest) = page.split_once(call).unwrap();
        rest.split('\'').nth(1).unwrap().to_owned()
    };
    assert_eq!(server.call("/gps/carried", &body("8080/gps/carried")), (204, Value::Null));
    let (status, place) = server.call("/gps/position", &body("8080/gps/position"));
    assert_eq!((status, page.contains(&format!("\n{place}\n"))), (200, true), "{place}");
    let wrong = page.split_once(&place.to_string()).unwrap().1.split('\'').nth(1).unwrap();
    let mut problem = server.problem("/gps/carried", wrong, 400);
    problem["error"] = json!("...");
    assert!(page.contains(&format!("\n{problem}\n")), "{problem}");
}

#[test]
fn a_run_says_what_it_does_not_serve_or_call() {
    let library = build::library("web");
    let run = |components: &str, more: &[&str]| {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("fleet.composite"), composite(components)).unwrap();
        let arguments = [&["run", "fleet.composite", "--plugin", library.to_str().unwrap(), "--for", "200ms"], more];
        let mut command = command(&arguments.concat());
        text(&command.current_dir(folder.path()).env("XDG_RUNTIME_DIR", folder.path()).output().unwrap())
    };
    let offered = store("<binding.rest uri=\"/stock\"/>", "");
    let unserved = "warning[S2072]: the services that are offered over the web are not served";
    for arguments in [&["--control", "none"][..], &["--virtual"]] {
        let printed = run(&offered, arguments);
        assert!(printed.contains(unserved) && printed.contains("`--serve 127.0.0.1:8080`"), "{printed}");
    }
    let printed = run(&offered, &[]);
    assert!(printed.contains("offers services over the web at its socket alone, `/stock`"), "{printed}");
    assert!(!printed.contains("S2072"), "{printed}");
    let called = customer("http://127.0.0.1:9/", " s:tokenEnv=\"PATH\"", "");
    let printed = run(&called, &[]);
    let refused = "error[S2073]: references lead to the web, to `http://127.0.0.1:9`, with tokens of the \
                   environment from `PATH`: `--allow-web` is missing";
    assert!(printed.contains(refused) && printed.contains("nothing was started"), "{printed}");
    let printed = run(&offered, &["--allow-web"]);
    assert!(printed.contains("`--allow-web` has nothing to allow"), "{printed}");
    let printed = run(&called, &["--virtual", "--allow-web"]);
    assert!(printed.contains("`--allow-web` has no effect with `--virtual`"), "{printed}");
    let printed = run(&called, &["--virtual"]);
    assert!(printed.contains("warning[S2072]: web servers are not called in virtual time"), "{printed}");
    assert!(
        printed.contains("failed: the web server `http://127.0.0.1:9/` is not called in virtual time"),
        "{printed}"
    );
}
