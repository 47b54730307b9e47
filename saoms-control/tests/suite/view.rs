//! The page of a run that has ended: who gets it, and from what report.

use std::sync::Arc;
use std::time::Duration;

use saoms_control::{AlertList, FigureWatch, FinishedRun, Recorder, RunReadError, ViewServer};
use saoms_core::observe::Observer;
use saoms_core::schedule::{RunningFleet, Settings};
use saoms_lang::assembly::Assembly;
use serde_json::{Value, json};

use super::network::exchange;

/// The report of a fleet without components, which was recorded for this time.
fn report(time: Duration) -> Value {
    let (alerts, figures): (Arc<AlertList>, _) = (Arc::default(), Arc::new(FigureWatch::new(false)));
    let recorder = Recorder::new("</script>".to_owned(), 0, Arc::clone(&alerts), Arc::clone(&figures));
    let observers: Vec<Arc<dyn Observer>> = vec![alerts, figures, Arc::new(recorder)];
    let settings = Settings { limit: Some(time), ..Settings::simulated(7) };
    let report = RunningFleet::start(Assembly::default(), settings, observers).unwrap().run_to_end();
    serde_json::to_value(&report).unwrap()
}

#[test]
fn only_who_has_the_key_sees_a_run_and_nobody_changes_it() {
    let run = FinishedRun::read(&report(Duration::from_secs(3)).to_string()).unwrap();
    assert_eq!((run.name(), run.time().as_secs_f64()), ("</script>", 3.0));
    let server = ViewServer::start(run, 0).unwrap();
    let (address, path) = server.url().strip_prefix("http://").unwrap().split_once('/').unwrap();
    assert!(address.starts_with("127.0.0.1:") && path.len() == 33, "{}", server.url());
    let ask = |method: &str, path: &str, more: &str| {
        let answer = exchange(address, &format!("{method} {path} HTTP/1.0\r\nHost: {address}\r\n{more}\r\n"));
        let (head, body) = answer.split_once("\r\n\r\n").unwrap();
        (head.split(' ').nth(1).unwrap().to_owned(), head.to_lowercase(), body.to_owned())
    };
    let (status, head, page) = ask("GET", &format!("/{path}"), "");
    assert_eq!(status, "200");
    assert!(page.contains("/assets/player.js") && !page.contains("<script>"), "{page}");
    for policy in ["content-security-policy: default-src 'self';", "cache-control: no-store", "nosniff"] {
        assert!(head.contains(policy), "{head}");
    }
    let (status, head, told) = ask("GET", &format!("/{path}run"), "");
    assert!(status == "200" && head.contains("content-type: application/json"), "{head}");
    let told: Value = serde_json::from_str(&told).unwrap();
    assert_eq!(
        (&told["time_s"], &told["name"], &told["outcome"]["status"]),
        (&json!(3.0), &json!("</script>"), &json!("elapsed"))
    );
    assert_eq!(told["recording"]["samples"].as_array().unwrap().last().unwrap()[0], 3);
    let (status, _, told) = ask("GET", &format!("/{path}records?component=Nobody"), "");
    assert!(status == "422" && told.contains("no component `Nobody`"), "{told}");
    assert_eq!(ask("GET", &format!("/{path}why?component=Nobody"), "").0, "422");
    assert_eq!(ask("GET", "/assets/player.js", "").0, "200");
    for hidden in ["/", "/run", "/v1/status", "/0/run", &format!("/{path}x"), &format!("/{}", &path[..32])] {
        assert_eq!(ask("GET", hidden, "").0, "404", "{hidden}");
    }
    assert_eq!(ask("POST", &format!("/{path}run"), "").0, "405");
    assert_eq!(ask("GET", &format!("/{path}run"), "Origin: http://evil.example\r\n").0, "403");
    let rebound = exchange(address, &format!("GET /{path}run HTTP/1.0\r\nHost: evil.example\r\n\r\n"));
    assert!(rebound.starts_with("HTTP/1.0 403"), "{rebound}");
}

#[test]
fn what_is_no_recorded_run_is_refused() {
    let whole = report(Duration::from_secs(3));
    let changed = |change: &dyn Fn(&mut Value)| {
        let mut report = whole.clone();
        change(&mut report);
        FinishedRun::read(&report.to_string()).map(|_| ()).unwrap_err()
    };
    let without = changed(&|report| drop(report.as_object_mut().unwrap().remove("recording")));
    assert_eq!(without, RunReadError::NotRecorded);
    assert_eq!(changed(&|report| report["recording"]["version"] = json!(9)), RunReadError::OtherVersion(9));
    for (field, value, expected) in [
        ("samples", json!([]), "it has no samples"),
        ("samples", json!([[0, [99, 1]]]), "the sample of 0 s names a cell that there is not"),
        ("samples", json!([[0, [0]]]), "the sample of 0 s names a cell that there is not"),
        ("cells", json!([[7, "state"]]), "a cell has no subject, or no name"),
        ("cells", json!([[0]]), "a cell has no subject, or no name"),
        ("cells", json!([[0, "speed"]]), "the fleet has no field `speed`"),
        ("log", json!(1), "invalid type: integer `1`, expected a sequence at line 1 column"),
    ] {
        let RunReadError::Malformed(error) = changed(&|report| report["recording"][field] = value.clone()) else {
            panic!("{field}");
        };
        assert!(error.starts_with(expected), "{field}: {error}");
    }
    // What a page shows of a component is of a kind.
    for (names, value, expected) in [
        (json!(["state"]), json!(1), "field `state` of component `A`: found 1, expected a text"),
        (
            json!(["executions"]),
            json!("many"),
            "field `executions` of component `A`: found \"many\", expected a number",
        ),
        (json!(["late_us", "p99"]), json!({}), "field `late_us.p99` of component `A`: found {}, expected a number"),
        (
            json!(["emergency_stop"]),
            json!(0),
            "field `emergency_stop` of component `A`: found 0, expected true or false",
        ),
        (json!(["in_code_s"]), json!(2), "component `A` has no field `in_code_s`"),
        (json!(["values"]), json!("x"), "component `A` has no field `values`"),
    ] {
        let error = changed(&|report| {
            let recording = &mut report["recording"];
            recording["subjects"] = json!([{"component": "A"}]);
            let cell = [vec![json!(0)], names.as_array().unwrap().clone()].concat();
            recording["cells"] = json!([cell]);
            recording["samples"] = json!([[0, [0, null]], [1, [0, value]]]);
        });
        let RunReadError::Malformed(error) = error else { panic!("{names}: {error}") };
        assert!(error == expected || error == format!("the sample of 1 s: {expected}"), "{error}");
    }
    let text = whole.to_string();
    assert_eq!(FinishedRun::read(&text[..text.len() - 20]).unwrap_err(), RunReadError::CutOff);
    for text in ["", "x", "[]", "{}", "\u{0}"] {
        assert!(matches!(FinishedRun::read(text).unwrap_err(), RunReadError::NoReport(_)), "{text}");
    }
}
