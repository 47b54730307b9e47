use saoms_api::ReportValue;
use saoms_api::extension::{RunSummary, submit};
use serde_json::json;

use super::{Lateness, LatenessSteps, Sections};

#[test]
fn quantiles_are_within_a_sixteenth() {
    let mut lateness = Lateness::default();
    let mut values: Vec<u64> = (0..10_000u64).map(|n| n * n % 70_001 * (1 + n % 13)).collect();
    for value in &values {
        lateness.record(value * 1_000 + 999);
    }
    values.sort_unstable();
    for share in [0.01, 0.25, 0.5, 0.9, 0.99, 0.999, 1.0] {
        let exact = values[(values.len() as f64 * share).ceil() as usize - 1];
        let estimate = lateness.quantile(share);
        assert!(estimate.abs_diff(exact) <= exact / 16 + 1, "{share}: {estimate} instead of {exact}");
    }
    assert_eq!(lateness.summary().max, *values.last().unwrap());
}

#[test]
fn steps_count_what_is_below_their_bounds() {
    let mut lateness = Lateness::default();
    let values: Vec<u64> = (0..10_000_u64).map(|n| n * n * 37 % 3_000_000_000).collect();
    values.iter().for_each(|nanos| lateness.record(*nanos));
    let steps = lateness.steps();
    assert_eq!(steps.count, 10_000);
    for (below, bound) in steps.below.into_iter().zip(LatenessSteps::BOUNDS) {
        assert_eq!(below, values.iter().filter(|nanos| **nanos < bound * 1_000).count() as u64, "{bound} us");
    }
    let sum = values.iter().sum::<u64>() / 1_000;
    assert!(steps.sum_us.abs_diff(sum) <= sum / 16, "{} instead of {sum}", steps.sum_us);
    assert_eq!(Lateness::default().steps(), LatenessSteps::default());
}

#[test]
fn lateness_beyond_the_histogram_keeps_its_maximum() {
    let mut lateness = Lateness::default();
    lateness.record(3_600_000_000_000);
    assert_eq!(lateness.summary().max, 3_600_000_000);
    assert!(lateness.summary().p50 > 60_000_000);
}

#[test]
fn nothing_late_is_zero() {
    let mut lateness = Lateness::default();
    assert_eq!(lateness.summary(), Default::default());
    lateness.record(0);
    lateness.record(999);
    assert_eq!(lateness.summary(), Default::default());
}

#[test]
fn merged_histograms_count_together() {
    let (mut one, mut two, mut both) = (Lateness::default(), Lateness::default(), Lateness::default());
    for value in 0..1_000 {
        (if value % 3 == 0 { &mut one } else { &mut two }).record(value * 7_000);
        both.record(value * 7_000);
    }
    one.merge(&two);
    assert_eq!(one.summary(), both.summary());
}

submit! {
    RunSummary {
        counts: &["parcels.requested", "parcels.delivered", "lost"],
        result: |_| None,
        progress: |_| None,
        voters: "a depot",
    }
}

#[test]
fn sections_nest_by_dots() {
    let mut sections = Sections::with_registered_counts();
    assert!(sections.add("parcels.delivered", 2));
    assert!(sections.add("parcels.delivered", 1));
    assert!(sections.set("map.blocks", ReportValue::Integer(121)));
    assert!(sections.set("map", ReportValue::Text("airport".to_owned())));
    assert!(sections.set("lost", ReportValue::Integer(1)));
    assert!(sections.add("lost", 1));
    assert_eq!(
        serde_json::Value::Object(sections.to_json()),
        json!({
            "parcels": {"requested": 0, "delivered": 3},
            "lost": 2,
            "map": {"value": "airport", "blocks": 121},
        })
    );
    assert_eq!(sections.integer("parcels.delivered"), Some(3));
    assert_eq!(sections.integer("map"), None);
    assert!(!sections.add(&"x".repeat(1001), 1), "it is too long");
}
