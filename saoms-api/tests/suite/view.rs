//! The names that an author of components sees at the root of the crate. A name that only hosts use belongs to `host`.

use std::fs;
use std::path::{Path, PathBuf};

const NAMES: &[&str] = &[
    "Adaptation", "Bounded", "CallError", "Cause", "Chance", "Class", "Component", "Context", "Departed", "Effector",
    "Entries", "Entry", "Extras", "Failure", "Field", "Finding", "Header", "KeptByOther", "Knowledge",
    "KnownPublisher", "Level", "Loop", "LoopClass", "Loops", "Message", "Messages", "Own", "Place", "Properties",
    "PropertyField", "Publisher", "Record", "Recordable", "Region", "ReportValue", "Saved", "SavedLoops", "Secret",
    "SimpleLoop", "StopFunction", "Subscription", "TaskInterface", "TaskInterfaceReference", "Time", "Topic", "Value",
    "Work", "builtin_interfaces", "event", "extension", "fleet_rules!", "host", "info!", "interface", "plugin!",
    "record!", "rule", "warn!",
];

/// The names that the text of `lib.rs` and the exported macros of the crate make public, without hidden ones.
fn names() -> Vec<String> {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let root = fs::read_to_string(source.join("lib.rs")).unwrap();
    // Modules in the text are hidden ones.
    let root =
        root.split("#[doc(hidden)]\npub mod generated").next().unwrap().replace("#[doc(hidden)]\npub mod", "mod");
    let mut names = Vec::new();
    for item in root.split("\npub ").skip(1) {
        let item = item.split(';').next().unwrap();
        let list = item.rsplit("::").next().unwrap().trim_start_matches("mod ");
        names.extend(list.trim_matches(['{', '}']).split(',').map(|name| name.trim().to_owned()));
    }
    for file in files(&source) {
        let text = fs::read_to_string(file).unwrap();
        for after in text.split("#[macro_export]\nmacro_rules! ").skip(1) {
            names.push(format!("{}!", after.split(' ').next().unwrap()));
        }
    }
    names.retain(|name| !name.is_empty());
    names.sort();
    // Macros that derive a trait have its name.
    names.dedup();
    names
}

fn files(folder: &Path) -> Vec<PathBuf> {
    let mut all = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() { all.extend(files(&path)) } else { all.push(path) }
    }
    all
}

#[test]
fn an_author_sees_these_names() {
    assert_eq!(names(), NAMES, "is the new name for authors, or for hosts?");
}
