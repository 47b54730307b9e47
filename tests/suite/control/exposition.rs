//! A strict reader of the text format of Prometheus, version 0.0.4.

use std::collections::{BTreeMap, HashSet};

/// Labels and value of a sample.
pub(super) type Sample = (BTreeMap<String, String>, f64);

/// A metric with its samples; those of a histogram by the name of their part.
#[derive(Debug, Default)]
pub(super) struct Family {
    pub(super) kind: String,
    pub(super) help: String,
    pub(super) samples: Vec<(String, Sample)>,
}

fn is_name(name: &str, colons: bool) -> bool {
    let is_inner = |letter: char| letter.is_ascii_alphanumeric() || letter == '_' || colons && letter == ':';
    name.chars().all(is_inner) && name.chars().next().is_some_and(|first| !first.is_ascii_digit())
}

/// Reads `{name="value",...}` from the start of a text, and gives the rest.
fn labels(text: &str) -> (BTreeMap<String, String>, &str) {
    let mut labels = BTreeMap::new();
    let Some(mut rest) = text.strip_prefix('{') else { return (labels, text) };
    loop {
        let (name, after) = rest.split_once("=\"").unwrap();
        assert!(is_name(name, false) && !name.starts_with("__"), "{name}");
        let (mut value, mut letters) = (String::new(), after.char_indices());
        let end = loop {
            match letters.next().unwrap() {
                (place, '"') => break place,
                (_, '\\') => value.push(match letters.next().unwrap().1 {
                    'n' => '\n',
                    escaped @ ('\\' | '"') => escaped,
                    other => panic!("`\\{other}` in {text}"),
                }),
                (_, letter) => value.push(letter),
            }
        };
        assert!(labels.insert(name.to_owned(), value).is_none(), "{name} twice");
        rest = &after[end + 1..];
        match rest.strip_prefix(',') {
            Some(more) => rest = more,
            None => return (labels, rest.strip_prefix('}').unwrap()),
        }
    }
}

/// Reads all metrics. Each has its help, its type and its samples together, no sample is there twice, no counter is
/// negative, and the buckets of a histogram grow up to its count.
pub(super) fn read(text: &str) -> BTreeMap<String, Family> {
    assert!(text.ends_with('\n'));
    let mut families: BTreeMap<String, Family> = BTreeMap::new();
    let (mut present, mut seen) = (String::new(), HashSet::new());
    for line in text.lines() {
        if let Some(help) = line.strip_prefix("# HELP ") {
            let (name, help) = help.split_once(' ').unwrap();
            assert!(is_name(name, true) && !help.is_empty(), "{line}");
            present = name.to_owned();
            let family = Family { help: help.to_owned(), ..Family::default() };
            assert!(families.insert(present.clone(), family).is_none(), "{name} is in two places");
            continue;
        }
        let family = families.get_mut(&present).unwrap();
        if let Some(kind) = line.strip_prefix("# TYPE ") {
            let (name, kind) = kind.split_once(' ').unwrap();
            assert!(name == present && family.kind.is_empty() && family.samples.is_empty(), "{line}");
            assert!(["counter", "gauge", "histogram"].contains(&kind), "{line}");
            family.kind = kind.to_owned();
            continue;
        }
        assert!(!line.starts_with('#') && !line.is_empty(), "{line}");
        let end = line.find(['{', ' ']).unwrap();
        let (name, rest) = line.split_at(end);
        let (labels, value) = labels(rest);
        let value: f64 = value.strip_prefix(' ').unwrap().parse().unwrap();
        let part = name.strip_prefix(&*present).unwrap();
        let is_histogram = family.kind == "histogram";
        assert!(if is_histogram { ["_bucket", "_sum", "_count"].contains(&part) } else { part.is_empty() }, "{line}");
        assert!(family.kind == "gauge" || value >= 0.0, "{line}");
        assert!(seen.insert(format!("{name} {labels:?}")), "{line} is there twice");
        family.samples.push((part.to_owned(), (labels, value)));
    }
    families.values().filter(|family| family.kind == "histogram").for_each(is_whole);
    families
}

/// The buckets of a histogram grow, and the last one is its count.
fn is_whole(family: &Family) {
    let mut buckets: BTreeMap<BTreeMap<String, String>, Vec<(f64, f64)>> = BTreeMap::new();
    for (part, (labels, value)) in &family.samples {
        let mut labels = labels.clone();
        if part == "_bucket" {
            let bound: f64 = labels.remove("le").unwrap().parse().unwrap();
            buckets.entry(labels).or_default().push((bound, *value));
        }
    }
    for (labels, buckets) in buckets {
        assert!(buckets.is_sorted_by(|one, next| one.0 < next.0 && one.1 <= next.1), "{labels:?}: {buckets:?}");
        let (bound, all) = *buckets.last().unwrap();
        let count = family.samples.iter().find(|(part, sample)| part == "_count" && sample.0 == labels).unwrap();
        assert!(bound.is_infinite() && all == count.1.1, "{labels:?}");
    }
}
