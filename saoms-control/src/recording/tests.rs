#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::time::Duration;

use serde_json::{Value, json};

use super::cells::{Cells, Subject};
use super::samples::Samples;

const SECOND: Duration = Duration::from_secs(1);

/// What the cells hold after all samples, by their names.
fn held(cells: &Cells, samples: &Samples) -> Vec<(f64, Value)> {
    let (paths, texts) = (cells.paths(), serde_json::from_str::<Value>(&cells.texts()).unwrap());
    let samples: Value = serde_json::from_str(&samples.json()).unwrap();
    let mut now = json!({});
    let shown = |value: &Value| match value["#"].as_array() {
        Some(list) => list.iter().map(|one| one.as_u64().map_or(one, |one| &texts[one as usize]).clone()).collect(),
        None => value.clone(),
    };
    let sample = |sample: &Value| {
        for pair in sample[1].as_array().unwrap().chunks(2) {
            let path = &paths[pair[0].as_u64().unwrap() as usize];
            let names = path.as_array().unwrap().iter().map(|name| name.to_string().replace('"', ""));
            now[names.collect::<Vec<_>>().join(".")] = shown(&pair[1]);
        }
        (sample[0].as_f64().unwrap(), now.clone())
    };
    samples.as_array().unwrap().iter().map(sample).collect()
}

#[test]
fn a_sample_has_what_differs_and_a_list_has_each_entry_once() {
    let (mut cells, mut samples) = (Cells::new(1000), Samples::new(SECOND, (100, 10_000)));
    let robot = cells.row(&Subject::Component("Arm"));
    for second in 0..3_u32 {
        assert!(samples.want(f64::from(second), false) && !samples.want(f64::from(second) - 0.5, false));
        cells.put(robot, &["state"], &json!("running"));
        cells.put(robot, &["values", "level"], &json!(87.000_01 - f64::from(second)));
        let pieces: Vec<Value> = (second..second + 2).map(|number| json!({"piece": number})).collect();
        cells.put(robot, &["values", "pieces"], &json!(pieces));
        if second < 2 {
            cells.put(robot, &["values", "job"], &json!("a"));
        }
        let changes = cells.changes();
        assert_eq!(changes.len(), if second == 0 { 4 } else { 1 + 1 + usize::from(second == 2) }, "{changes:?}");
        samples.push(f64::from(second), &changes);
    }
    assert_eq!(cells.texts(), r#"[{"piece":0},{"piece":1},{"piece":2},{"piece":3}]"#);
    let held = held(&cells, &samples);
    let expected = json!({"0.state": "running", "0.values.level": 85, "0.values.pieces": [{"piece": 2}, {"piece": 3}],
        "0.values.job": null});
    assert_eq!(held[2], (2.0, expected));
    assert_eq!(held[1].1["0.values.job"], "a");
}

#[test]
fn a_long_run_is_thinned_out_and_keeps_its_first_and_last_samples() {
    for most in [(10_000, 600), (100, 10_000)] {
        is_thinned_out(most);
    }
}

fn is_thinned_out(most: (usize, usize)) {
    let (mut cells, mut samples) = (Cells::new(0), Samples::new(SECOND, most));
    let fleet = cells.row(&Subject::Fleet);
    for second in 0..=1000_u32 {
        let is_last = second == 1000;
        if !samples.want(f64::from(second), is_last) {
            continue;
        }
        cells.put(fleet, &["second"], &json!(second));
        cells.put(fleet, &["tens"], &json!(second / 100));
        cells.put(fleet, &["pieces"], &json!([{"piece": second / 500}]));
        samples.push(f64::from(second), &cells.changes());
        assert!(samples.len() <= most.0.min(200), "{}", samples.len());
    }
    let held = held(&cells, &samples);
    assert!((20..200).contains(&held.len()) && samples.every_s() > 7.0, "{} {}", held.len(), samples.every_s());
    for (time_s, now) in &held {
        let second = *time_s as u64;
        let expected = json!({"0.second": second, "0.tens": second / 100, "0.pieces": [{"piece": second / 500}]});
        assert_eq!(*now, expected);
    }
    assert_eq!((held[0].0, held.last().unwrap().0), (0.0, 1000.0));
    let times: Vec<f64> = held.iter().map(|(time_s, _)| *time_s).collect();
    assert!(times.windows(2).all(|pair| pair[0] < pair[1]), "{times:?}");
}

#[test]
fn the_sample_of_the_end_may_be_of_the_time_of_the_one_before() {
    let (mut cells, mut samples) = (Cells::new(100), Samples::new(SECOND, (100, 1000)));
    let fleet = cells.row(&Subject::Fleet);
    for value in ["a", "b"] {
        cells.put(fleet, &["value"], &json!(value));
        samples.push(5.0, &cells.changes());
    }
    assert_eq!(samples.json(), r#"[[5,[0,"b"]]]"#);
}

#[test]
fn entries_of_lists_that_no_sample_has_any_more_are_forgotten() {
    let (mut cells, mut samples) = (Cells::new(1000), Samples::new(SECOND, (20, 100_000)));
    let fleet = cells.row(&Subject::Fleet);
    for second in 0..=1000_u32 {
        if samples.want(f64::from(second), false) {
            cells.put(fleet, &["pieces"], &json!([{"piece": second}, {"piece": "same"}]));
            if samples.push(f64::from(second), &cells.changes()) {
                cells.forget_texts(&mut samples);
            }
        }
    }
    let texts: Vec<Value> = serde_json::from_str(&cells.texts()).unwrap();
    assert!((10..=21).contains(&texts.len()), "{texts:?}");
    for (time_s, now) in held(&cells, &samples) {
        assert_eq!(now, json!({"0.pieces": [{"piece": time_s as u32}, {"piece": "same"}]}));
    }
    assert!(!samples.json().contains("piece"), "{}", samples.json());
}

#[test]
fn a_subject_that_is_kept_holds_what_it_held() {
    let mut cells = Cells::new(100);
    let topic = Subject::Message { topic: "T", message: "M", component: "A", key: None };
    let row = cells.row(&topic);
    cells.put(row, &["field"], &json!(1));
    assert_eq!(cells.changes().len(), 1);
    cells.keep_all(row);
    assert!(cells.changes().is_empty());
    assert_eq!(cells.changes(), [(0, "null".to_owned())]);
}
