//! Records of the journal in what ships: each has an id, and an id stands for one text.

use std::collections::BTreeMap;
use std::fs;

use super::architecture::rust_files;
use crate::support::root;

/// What ships, and the pages that authors of loops copy from.
const SOURCES: [&str; 5] = ["saoms-components/src", "saoms-core/src", "plugins", "src", "docs/loops.md"];

/// The parts of `record!(id: "text", name, name = value)`.
#[derive(Debug, PartialEq)]
struct Written {
    id: String,
    text: String,
    names: Vec<String>,
}

/// All records in a text, each as written between the parentheses. Records without an id have an empty one.
fn records(source: &str) -> Vec<Written> {
    let calls = source.split("record!(").skip(1).filter(|rest| !rest.starts_with("...") && !rest.starts_with('@'));
    calls.map(|rest| written(rest).unwrap_or_else(|| panic!("this is no record: {}", first(rest)))).collect()
}

fn written(rest: &str) -> Option<Written> {
    let (id, rest) = rest.split_once('"')?;
    let (text, rest) = rest.split_once('"')?;
    let mut depth = 1;
    let end = rest.find(|c| {
        depth += i32::from(c == '(') - i32::from(c == ')');
        depth == 0
    })?;
    let mut depth = 0;
    let parts = rest[..end].split(|c| {
        depth += i32::from(c == '(') - i32::from(c == ')');
        depth == 0 && c == ','
    });
    let names = parts.map(|part| part.split('=').next().unwrap_or_default().trim().to_owned());
    let names = names.filter(|name| !name.is_empty()).collect();
    Some(Written { id: id.trim().trim_end_matches(':').to_owned(), text: text.to_owned(), names })
}

fn first(text: &str) -> &str {
    text.lines().next().unwrap_or_default()
}

/// What is wrong with a record by itself.
fn fault(record: &Written) -> Option<String> {
    let is_word = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_';
    if record.id.is_empty() || !record.id.chars().all(is_word) {
        return Some("no id in `snake_case`".to_owned());
    }
    let places = record.text.split('{').skip(1).filter_map(|rest| rest.split(['}', ':']).next());
    let mut unknown = places.filter(|place| !record.names.iter().any(|name| name == place));
    unknown.next().map(|place| format!("no value `{place}`"))
}

#[test]
fn each_record_has_an_id_and_each_id_one_text() {
    let mut known: BTreeMap<String, Written> = BTreeMap::new();
    let mut texts: BTreeMap<String, String> = BTreeMap::new();
    let mut faults = Vec::new();
    for source in SOURCES.map(|source| root().join(source)) {
        let files = if source.is_dir() { rust_files(&source) } else { vec![source] };
        // Tests have records of their own.
        let files = files.iter().filter(|file| !file.iter().any(|part| part == "tests" || part == "tests.rs"));
        for file in files {
            for record in records(&fs::read_to_string(file).unwrap()) {
                faults.extend(fault(&record).map(|fault| format!("{}: {fault}: {record:?}", file.display())));
                let id = texts.entry(record.text.clone()).or_insert_with(|| record.id.clone());
                let other = known.entry(record.id.clone()).or_insert_with(|| Written {
                    names: record.names.clone(),
                    id: record.id.clone(),
                    text: record.text.clone(),
                });
                if *other != record || *id != record.id {
                    faults.push(format!("{}: one id, one text: {record:?}, {other:?}", file.display()));
                }
            }
        }
    }
    assert!(known.len() > 100, "{}", known.len());
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn records_are_read_as_they_are_written() {
    let record = |id: &str, text: &str, names: &[&str]| Written {
        id: id.to_owned(),
        text: text.to_owned(),
        names: names.iter().map(|name| (*name).to_owned()).collect(),
    };
    let source = r#"record!(goes: "goes to {to} for {n:piece|pieces}", to = (1, f(2)), n,), record!("sleeps")"#;
    let found = records(source);
    assert_eq!(found, [record("goes", "goes to {to} for {n:piece|pieces}", &["to", "n"]), record("", "sleeps", &[])]);
    assert_eq!(fault(&found[0]), None);
    assert_eq!(fault(&found[1]).unwrap(), "no id in `snake_case`");
    assert_eq!(fault(&record("goes", "goes to {there}", &["to"])).unwrap(), "no value `there`");
}
