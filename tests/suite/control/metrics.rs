//! `/metrics`: the metrics of a running fleet, and their page.
//!
//! `UPDATE_EXPECT=1 cargo test --test suite metrics` writes the page anew.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::io::{Read, Write};
use std::net::TcpStream;
use std::os::unix::net::UnixStream;
use std::process::{Command, Stdio};

use expect_test::expect_file;
use saoms_control::METRICS;
use serde_json::Value;

use super::exposition::{Family, read};
use super::{Running, fleet};

/// What a server answers to a request without a body.
pub(super) fn answer(mut stream: impl Read + Write, head: &str) -> (String, String) {
    stream.write_all(format!("{head}\r\n\r\n").as_bytes()).unwrap();
    let mut answer = String::new();
    stream.read_to_string(&mut answer).unwrap();
    let (head, body) = answer.split_once("\r\n\r\n").unwrap();
    (head.to_owned(), body.to_owned())
}

/// The metrics of a fleet, from its socket.
pub(super) fn metrics(running: &Running) -> String {
    let listed: Value = serde_json::from_str(&running.told(&["ps", "--format", "json"])).unwrap();
    let socket = UnixStream::connect(listed[0]["socket"].as_str().unwrap()).unwrap();
    let (head, body) = answer(socket, "GET /metrics HTTP/1.0");
    assert!(head.starts_with("HTTP/1.0 200"), "{head}");
    assert!(head.contains("content-type: text/plain; version=0.0.4"), "{head}");
    body
}

/// The value of a metric with these labels.
#[track_caller]
fn value(family: &Family, labels: &[(&str, &str)]) -> f64 {
    let is_it = |found: &BTreeMap<String, String>| {
        labels.iter().all(|(name, value)| found.get(*name).is_some_and(|found| found == value))
    };
    family.samples.iter().find(|(_, sample)| is_it(&sample.0)).unwrap().1.1
}

#[test]
fn a_running_fleet_has_metrics() {
    let running = Running::start(&fleet(), &["--stay", "--serve", "127.0.0.1:0"]);
    running.told(&["send", "luggage (0,0) to (1,0)"]);
    running.until("World", |world| world["values"]["delivered"] == 1);
    let text = metrics(&running);
    let families = read(&text);
    for metric in METRICS {
        let family = &families[metric.name];
        assert_eq!((&*family.kind, &*family.help), (metric.kind, metric.help));
        for (_, (labels, _)) in &family.samples {
            let names: BTreeSet<&str> = labels.keys().map(String::as_str).filter(|name| *name != "le").collect();
            assert_eq!(names, metric.labels.iter().copied().collect(), "{}", metric.name);
        }
    }
    assert_eq!(families.len(), METRICS.len());
    let of = |component| [("component", component)];
    assert!(value(&families["saoms_executions_total"], &of("Robot1")) > 0.0);
    assert_eq!(value(&families["saoms_missed_total"], &of("Robot2")), 0.0);
    assert_eq!(value(&families["saoms_phase"], &[("phase", "running")]), 1.0);
    assert_eq!(value(&families["saoms_component_info"], &[("component", "Robot2"), ("state", "idle")]), 1.0);
    let battery = value(&families["saoms_component_value"], &[("component", "Robot1"), ("name", "battery")]);
    assert!((0.0..=100.0).contains(&battery));
    assert_eq!(value(&families["saoms_report_value"], &[("path", "luggage.delivered")]), 1.0);
    let queue = [("component", "Robot1"), ("topic", "ELMSTOPIC")];
    assert!(value(&families["saoms_queue_events"], &queue) < value(&families["saoms_queue_limit_events"], &queue));
    let adaptations = &families["saoms_adaptations_total"];
    assert!(adaptations.samples.iter().any(|(_, sample)| sample.0["component"] == "Robot1" && sample.1 > 0.0));
    assert_eq!(value(&families["saoms_control_denied_total"], &[]), 0.0);
    checked_by_prometheus(&text);

    // The same over the network, where a request without the token is counted.
    let listed: Value = serde_json::from_str(&running.told(&["ps", "--format", "json"])).unwrap();
    let address = listed[0]["url"].as_str().unwrap().strip_prefix("http://").unwrap();
    let token = std::fs::read_to_string(listed[0]["token_file"].as_str().unwrap()).unwrap();
    let ask = |headers: &str| {
        let request = format!("GET /metrics HTTP/1.0\r\nHost: {address}{headers}");
        answer(TcpStream::connect(address).unwrap(), &request)
    };
    assert!(ask("").0.starts_with("HTTP/1.0 401"));
    let (_, body) = ask(&format!("\r\nAuthorization: Bearer {}", token.trim()));
    assert_eq!(read(&body).len(), METRICS.len());
    std::thread::sleep(std::time::Duration::from_millis(110));
    assert_eq!(value(&read(&metrics(&running))["saoms_control_denied_total"], &[]), 1.0);
    running.told(&["down"]);
    assert_eq!(running.end().0, Some(0));
}

/// Where Prometheus is installed, it finds nothing wrong with the text.
#[expect(clippy::print_stdout, reason = "a test that is skipped says so")]
fn checked_by_prometheus(text: &str) {
    let promtool = std::env::var_os("PROMTOOL").unwrap_or_else(|| "promtool".into());
    let pipes = (Stdio::piped(), Stdio::piped());
    let started =
        Command::new(promtool).args(["check", "metrics"]).stdin(Stdio::piped()).stdout(pipes.0).stderr(pipes.1).spawn();
    let Ok(mut child) = started else { return println!("skipped: promtool is missing") };
    child.stdin.take().unwrap().write_all(text.as_bytes()).unwrap();
    let output = child.wait_with_output().unwrap();
    assert!(output.status.success(), "{}", crate::support::text(&output));
}

#[test]
fn virtual_time_knows_no_lateness() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("saoms")).unwrap();
    std::fs::write(folder.path().join("fleet.composite"), fleet()).unwrap();
    let running = Running::start_in(folder, &["--virtual", "--stay", "--control", "saoms/fleet.sock"]);
    let families = read(&metrics(&running));
    assert!(families["saoms_lateness_seconds"].samples.is_empty());
    assert_eq!(value(&families["saoms_fleet_info"], &[("clock", "virtual")]), 1.0);
    running.told(&["down"]);
    assert_eq!(running.end().0, Some(0));
}

const HEAD: &str = "\
# Metrics

A running fleet offers metrics for [Prometheus](https://prometheus.io) at `GET /metrics` of its
[control](control.md), on the socket and, with the token, over the network:

```yaml
scrape_configs:
  - job_name: saoms
    static_configs: [{targets: ['127.0.0.1:8080']}]
    authorization: {credentials_file: /etc/prometheus/saoms.token}   # the file of `saoms run --token-file`
```

The metrics come from counters that the engine has anyway. They are computed on request, at most ten times a second, so
they do not slow down executions. Labels name components by their paths. The metrics of the domain come from the
components:

| question | expression |
| --- | --- |
| batteries below 20 % | `saoms_component_value{name=\"battery\"} < 20` |
| luggage delivered in an hour | `delta(saoms_report_value{path=\"luggage.delivered\"}[1h])` |
| open luggage | `saoms_report_value{path=\"luggage.requested\"} - ignoring(path) saoms_report_value{path=\"luggage.delivered\"}` |
| robots that need a person | `saoms_report_value{path=\"assistance\"}` |
| share of executions that start within 1 ms | `sum(rate(saoms_lateness_seconds_bucket{le=\"0.001024\"}[5m])) / sum(rate(saoms_lateness_seconds_count[5m]))` |
| adaptations a second by loop | `sum by (loop) (rate(saoms_adaptations_total{phase=\"effect\"}[5m]))` |

| metric | kind | labels | what it is |
| --- | --- | --- | --- |
";

#[test]
fn metrics_are_documented() {
    let mut page = HEAD.to_owned();
    for metric in METRICS {
        let labels = metric.labels.iter().map(|label| format!("`{label}`")).collect::<Vec<_>>().join(", ");
        let _ = writeln!(page, "| `{}` | {} | {labels} | {} |", metric.name, metric.kind, metric.help);
    }
    expect_file!["../../../docs/metrics.md"].assert_eq(&page);
}
