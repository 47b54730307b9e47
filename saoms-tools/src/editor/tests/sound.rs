//! The fleets that ship are sound, and stay so whatever in them gets another name.

use std::fs;
use std::path::Path;

use crate::editor::testing::{hold, scene_of};

/// One attribute of so many is asked about.
const EVERY: usize = 5;

#[test]
fn fleets_are_sound_after_each_change_of_a_name() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../composites");
    let mut files: Vec<(String, String)> = fs::read_dir(folder)
        .unwrap()
        .filter_map(|entry| {
            let path = entry.unwrap().path();
            let name = path.file_name().unwrap().to_str().unwrap().to_owned();
            Some((name, fs::read_to_string(path).ok()?))
        })
        .collect();
    files.sort();
    let mut renamed = 0;
    for (name, text) in files.iter().filter(|(name, _)| name.ends_with(".composite")) {
        let others = files.iter().filter(|(other, _)| other != name);
        let others: Vec<(&str, &str)> = others.map(|(name, text)| (name.as_str(), text.as_str())).collect();
        let scene = scene_of(text, &others);
        for (at, _) in text.match_indices("=\"").step_by(EVERY) {
            renamed += usize::from(hold(&scene, at + 2));
        }
    }
    assert!(renamed > 20, "{renamed}");
}
