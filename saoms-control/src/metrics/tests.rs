#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use saoms_core::journal::LoopCounts;
use saoms_core::report::Lateness;
use saoms_core::status::{ComponentState, FleetStatus};
use serde_json::json;

use super::*;

/// The lines of a metric in the text of a fleet with one component, whose names need an escape.
fn lines(metric: &str) -> Vec<String> {
    let name = "hall/a \"b\" \\c\nd";
    let mut lateness = Lateness::default();
    [0, 20_000, 2_000_000, 2_000_000, 3_000_000_000].into_iter().for_each(|nanos| lateness.record(nanos));
    let component = ComponentStatus {
        report: ComponentReport { name: name.into(), executions: 5, ..ComponentReport::default() },
        site: "hall".into(),
        emergency_stop: false,
        state: ComponentState::Running,
        period_ms: Some(100.0),
        in_code_s: None,
        waits_for: None,
        values: json!({"level": 86.5, "on": true, "word": "x", "list": [1], "in": {"in": {"er": 1}}, "in.in.er": 2})
            .as_object()
            .unwrap()
            .clone()
            .into(),
        values_s: None,
    };
    let queue = |waiting| {
        let queue = TopicReaderStatus { component: name.to_owned(), waiting: Some(waiting), queue: Some(8) };
        ("T".to_owned(), queue)
    };
    let counts = |loop_name: Option<&str>| LoopCounts {
        component: "C".to_owned(),
        loop_name: loop_name.map(str::to_owned),
        symptoms: 1,
        ..LoopCounts::default()
    };
    let fleet = FleetMetrics {
        status: FleetStatus {
            paused: false,
            speed: None,
            time_s: 1.5,
            phase: FleetPhase::Running,
            summaries: Vec::new(),
            components: vec![component],
        },
        lateness: vec![(name.to_owned(), lateness.steps())],
        numbers: vec![("a.b".to_owned(), -2.0), ("c".to_owned(), f64::NAN), ("d".to_owned(), f64::INFINITY)],
        loops: vec![counts(None), counts(Some("L")), counts(Some("L"))],
        queues: vec![queue(1), queue(2)],
        networks: vec![("relay://localhost:1".to_owned(), 3)],
    };
    let description = FleetDescription {
        name: "fleet".to_owned(),
        pid: 1,
        composites: Vec::new(),
        version: "1".to_owned(),
        started: 1_000_000_000,
        is_virtual: false,
        url: None,
        token_file: None,
        view_token_file: None,
        history: None,
        seed: 0,
    };
    let clients = ClientCounts::default();
    let alerts = AlertCounts { kinds: vec![("a\"b".to_owned(), [2, 1, 5])], undelivered: 7 };
    let text = text(&Measured {
        description: &description,
        fleet: &fleet,
        clients: &clients,
        losses: &LossCounts::default(),
        alerts,
    });
    let is_it = |line: &&str| !line.starts_with('#') && line.starts_with(metric);
    text.lines().filter(is_it).map(|line| line[metric.len()..].to_owned()).collect()
}

#[test]
fn names_are_escaped() {
    assert_eq!(lines("saoms_executions_total"), [r#"{component="hall/a \"b\" \\c\nd"} 5"#]);
}

#[test]
fn alerts_are_counted_by_kind_and_state() {
    let expected =
        [r#"{kind="a\"b",state="waiting"} 2"#, r#"{kind="a\"b",state="acknowledged"} 1"#, r#"_total{kind="a\"b"} 5"#];
    assert_eq!(lines("saoms_alerts")[..3], expected);
    assert_eq!(lines("saoms_alerts_undelivered_total"), [" 7"]);
}

#[test]
fn lateness_is_a_histogram_of_all_below() {
    let component = r#"component="hall/a \"b\" \\c\nd""#;
    let below = |bound: &str, count| format!("_bucket{{{component},le=\"{bound}\"}} {count}");
    let lines = lines("saoms_lateness_seconds");
    let expected = [
        below("0.000016", 1),
        below("0.000064", 2),
        below("0.000256", 2),
        below("0.001024", 2),
        below("0.004096", 4),
        below("0.016384", 4),
        below("0.065536", 4),
        below("0.262144", 4),
        below("1.048576", 4),
        below("+Inf", 5),
    ];
    assert_eq!(lines[..10], expected);
    let sum: f64 = lines[10].strip_prefix(&format!("_sum{{{component}}} ")).unwrap().parse().unwrap();
    assert!((sum - 3.004).abs() < 3.004 / 16.0, "{sum}");
    assert_eq!(lines[11], format!("_count{{{component}}} 5"));
}

#[test]
fn each_number_has_one_line() {
    let values = lines("saoms_component_value");
    let names: Vec<&str> = values.iter().filter_map(|line| line.split_once("name=\"")?.1.strip_prefix("")).collect();
    assert_eq!(names, ["in.in.er\"} 1", "level\"} 86.5", "on\"} 1"]);
    assert_eq!(lines("saoms_report_value"), [r#"{path="a.b"} -2"#, r#"{path="c"} NaN"#, r#"{path="d"} +Inf"#]);
    assert_eq!(lines("saoms_queue_events"), [r#"{component="hall/a \"b\" \\c\nd",topic="T"} 3"#]);
    let loops = lines("saoms_adaptations_total");
    assert_eq!(loops.len(), 6);
    assert_eq!(loops[3], r#"{component="C",loop="L",phase="symptom"} 2"#);
}
