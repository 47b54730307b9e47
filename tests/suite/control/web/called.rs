//! Services of the web that a fleet calls.

use std::fs;
use std::io::Write;
use std::net::{TcpListener, TcpStream};
use std::thread::sleep;
use std::time::Duration;

use super::{composite, customer, start};
use crate::boundary::build;
use crate::control::Running;
use crate::peers::web::{answering, plain};

#[test]
fn a_reload_calls_no_other_server_than_the_command_line_allowed() {
    let (address, asked) = answering(plain("HTTP/1.1 200 OK\r\nContent-Length: 2\r\n\r\n[]"));
    let (other, never) = answering(plain("HTTP/1.1 200 OK\r\nContent-Length: 2\r\n\r\n[]"));
    let folder = tempfile::tempdir().unwrap();
    let (library, next) = (folder.path().join("libweb.so"), folder.path().join("next"));
    fs::copy(build::library("web"), &library).unwrap();
    let fleet = |address: &str, attributes: &str| {
        composite(&customer(&format!("http://{address}/"), attributes, "<property name=\"questions\">9</property>"))
    };
    let arguments = ["--plugin", library.to_str().unwrap(), "--stay", "--reload", "--allow-web"];
    let path = folder.path().join("fleet.composite");
    let running = Running::start_beside(folder, &fleet(&address, ""), &arguments);
    asked.recv_timeout(Duration::from_secs(60)).unwrap();
    let rebuilt = |composite: &str, expected: &str| {
        fs::write(&path, composite).unwrap();
        fs::copy(build::library("web"), &next).unwrap();
        fs::rename(&next, &library).unwrap();
        let is_told = (0..500).any(|_| {
            sleep(Duration::from_millis(20));
            running.told(&["logs", "--lines", "500"]).contains(expected)
        });
        assert!(is_told, "{}", running.told(&["logs", "--lines", "500"]));
    };
    let why = ", and did not when the fleet started: restart it; the fleet continues with the earlier build";
    rebuilt(&fleet(&other, ""), &format!("references lead to `http://{other}`{why}"));
    let token = format!("references lead to `http://{address}` with the token in `PATH`{why}");
    rebuilt(&fleet(&address, " s:tokenEnv=\"PATH\""), &token);
    rebuilt(&fleet(&address, " s:deadline=\"2s\""), "its components are replaced");
    running.told(&["down"]);
    let (code, printed) = running.end();
    assert!(code == Some(0) && never.try_recv().is_err(), "{printed}");
    assert!(asked.try_iter().all(|request| !request.contains("Authorization")));
}

#[test]
fn a_change_of_the_fleet_leads_to_no_other_server_than_the_command_line_allowed() {
    let (address, asked) = answering(plain("HTTP/1.1 200 OK\r\nContent-Length: 2\r\n\r\n[]"));
    let (other, never) = answering(plain("HTTP/1.1 200 OK\r\nContent-Length: 2\r\n\r\n[]"));
    let questions = "<property name=\"questions\">9</property>";
    let of = |address: &str, attributes: &str| customer(&format!("http://{address}/"), attributes, questions);
    let running = start(&of(&address, ""), &["--allow-web"]);
    asked.recv_timeout(Duration::from_secs(60)).unwrap();
    let write = |text: &str| fs::write(running.folder().join("other.composite"), composite(text)).unwrap();
    let (server, token) = (format!("`http://{other}`"), format!("`http://{address}` with the token in `PATH`"));
    for (text, what) in [(of(&other, ""), server), (of(&address, " s:tokenEnv=\"PATH\""), token)] {
        write(&text);
        for command in ["plan", "apply"] {
            let refused = running.refused(&[command, "other.composite"]);
            let expected =
                format!("error: references lead to {what}, and did not when the fleet started: restart it\n");
            assert!(refused.contains(&expected), "{refused}");
        }
    }
    assert_eq!(running.told(&["plan", "fleet.composite"]), "nothing to do\n");
    // The same server may be called otherwise.
    write(&of(&address, " s:deadline=\"2s\""));
    running.told(&["apply", "other.composite", "--allow-loss"]);
    running.told(&["down"]);
    let (code, printed) = running.end();
    assert!(code == Some(0) && never.try_recv().is_err(), "{printed}");
    assert!(asked.try_iter().all(|request| !request.contains("Authorization")));
}

/// What a customer says of a server that answers so.
fn heard(answer: impl Fn(&mut TcpStream, &str) + Send + 'static) -> String {
    let (address, _asked) = answering(answer);
    let running = start(&customer(&format!("http://{address}/a/b/"), " s:deadline=\"700ms\"", ""), &["--allow-web"]);
    let said = (0..500).find_map(|_| {
        let log = running.told(&["logs", "--lines", "50"]);
        let line = log.lines().find(|line| line.contains("failed: ") || line.contains("heard ")).map(str::to_owned);
        if line.is_none() {
            sleep(Duration::from_millis(20));
        }
        line
    });
    running.told(&["down"]);
    let (code, printed) = running.end();
    assert_eq!(code, Some(0), "{printed}");
    said.unwrap_or_else(|| panic!("{printed}"))
}

#[test]
fn what_a_server_answers_is_held_to_the_interface() {
    let (address, asked) = answering(plain("HTTP/1.1 200 OK\r\nContent-Length: 2\r\n\r\n[]"));
    let running = start(&customer(&format!("http://{address}/a/b/"), "", ""), &["--allow-web"]);
    let request = asked.recv_timeout(Duration::from_secs(60)).unwrap();
    assert!(request.starts_with("POST /a/b/parts HTTP/1.1\r\n"), "{request}");
    assert!(request.contains(&format!("\r\nHost: {address}\r\n")), "{request}");
    assert!(request.contains("\r\nContent-Type: application/json\r\n") && !request.contains("Authorization"));
    assert!(request.ends_with("\r\n\r\n{\"least\":1}"), "{request}");
    running.told(&["down"]);
    drop(running.end());

    for (answer, expected) in [
        (
            "HTTP/1.1 200 OK\r\n\r\n[{\"name\": \"nut\", \"count\": 2, \"sizes\": []}]",
            "heard [Part { name: \"nut\", count: 2",
        ),
        (
            "HTTP/1.1 200 OK\r\n\r\n[{\"name\": 1, \"count\": -2, \"sizes\": []}]",
            "answers `parts(least: uint32) -> sequence of Part` with a reply that does not fit: field `reply[0].name`: \
             found 1, expected a text; field `reply[0].count`: found -2, expected a whole number from 0 to 4294967295",
        ),
        (
            "HTTP/1.1 200 OK\r\nContent-Type: text/html\r\n\r\n<html>\u{1b}hello</html>",
            "answers `parts` with `<html> hello</html>` (text/html), which is not JSON",
        ),
        ("HTTP/1.1 200 OK\r\nContent-Length: 50\r\n\r\n[", "answers incompletely: 1 of 50 bytes came"),
        ("HTTP/1.1 200 OK\r\n\r\n[{\"name\"", "which is not JSON: EOF"),
        ("HTTP/1.1 200 OK\r\nContent-Length: 99999999\r\n\r\n[", "answers with more than 4194304 bytes"),
        ("", "closes the connection without an answer"),
        ("SSH-2.0-OpenSSH_9.6\r\n", "does not answer in HTTP"),
        (
            "HTTP/1.1 404 Not Found\r\nContent-Type: application/problem+json\r\n\r\n{\"detail\": \"no such store\"}",
            "answers `parts` with the status 404: no such store",
        ),
        (
            "HTTP/1.1 301 Moved\r\nLocation: /c\r\n\r\n",
            "answers `parts` with the status 301: write the address to which it redirects",
        ),
        ("HTTP/1.1 500 Internal Server Error\r\n\r\n", "answers `parts` with the status 500"),
    ] {
        let said = heard(plain(answer));
        assert!(said.contains(expected), "{answer}: {said}");
    }
}

#[test]
fn a_server_that_is_slow_is_left_at_the_deadline() {
    let said = heard(|_, _| sleep(Duration::from_secs(3)));
    assert!(said.contains("does not answer `parts` within 700ms"), "{said}");
    // A byte now and then is no answer.
    let said = heard(|stream, _| {
        for _ in 0..40 {
            if stream.write_all(b"H").is_err() {
                return;
            }
            sleep(Duration::from_millis(50));
        }
    });
    assert!(said.contains("does not answer `parts` within 700ms"), "{said}");
    let huge = heard(|stream, _| {
        let _ = stream.write_all(b"HTTP/1.1 200 OK\r\n\r\n");
        while stream.write_all(&[b'['; 65_536]).is_ok() {}
    });
    assert!(huge.contains("answers with more than 4194304 bytes") || huge.contains("within 700ms"), "{huge}");
    // Nobody listens at the first port that was free a moment ago.
    let port = TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
    let running = start(&customer(&format!("http://127.0.0.1:{port}/a"), "", ""), &["--allow-web"]);
    running.until("Customer", |component| component["executions"].as_u64() > Some(1));
    let log = running.told(&["logs", "--lines", "50"]);
    assert!(log.contains("cannot be reached: Connection refused"), "{log}");
}

#[test]
fn a_server_that_is_busy_is_asked_again_in_the_next_period() {
    let (address, asked) = answering({
        let count = std::cell::Cell::new(0);
        move |stream, _| {
            count.set(count.get() + 1);
            let answer = match count.get() {
                1 => "HTTP/1.1 503 Service Unavailable\r\nRetry-After: 1\r\nContent-Length: 0\r\n\r\n",
                _ => "HTTP/1.1 200 OK\r\nContent-Length: 2\r\n\r\n[]",
            };
            stream.write_all(answer.as_bytes()).unwrap();
        }
    });
    let questions = "<property name=\"questions\">2</property>";
    let running = start(&customer(&format!("http://{address}/"), "", questions), &["--allow-web"]);
    for _ in 0..2 {
        asked.recv_timeout(Duration::from_secs(60)).unwrap();
    }
    running.until("Customer", |component| component["executions"].as_u64() > Some(3));
    let log = running.told(&["logs", "--lines", "50"]);
    assert!(
        log.contains(&format!("failed: the server at `http://{address}/` is busy")) && log.contains("heard []"),
        "{log}"
    );
}

#[test]
fn a_run_ends_although_a_server_does_not_answer() {
    let (address, asked) = answering(|_, _| sleep(Duration::from_secs(60)));
    let running =
        start(&customer(&format!("http://{address}/"), " s:deadline=\"10min\"", ""), &["--grace", "5s", "--allow-web"]);
    asked.recv_timeout(Duration::from_secs(60)).unwrap();
    running.told(&["down"]);
    let (code, printed) = running.end();
    assert_eq!(code, Some(0), "{printed}");
}
