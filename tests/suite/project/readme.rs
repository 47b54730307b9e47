//! The README shows the real thing: the composite that ships, and what the command prints.

use std::fs;
use std::path::Path;

use crate::support::{code, project, saoms, saoms_in, stderr, stdout};

/// The block of this language whose text contains `mark`, without its fences.
fn block(language: &str, mark: &str) -> String {
    let readme = project("README.md");
    let fence = format!("```{language}\n");
    let blocks = readme.split(&fence).skip(1).map(|rest| rest.split("```").next().unwrap());
    let mut found = blocks.filter(|block| block.contains(mark));
    found.next().unwrap().to_owned()
}

#[test]
fn the_composite_of_the_readme_ships() {
    let shipped = project("composites/hall.composite");
    let start = shipped.find("<composite").unwrap();
    assert_eq!(block("xml", "Robot7"), shipped[start..]);
}

#[test]
fn the_run_of_the_readme_is_real() {
    let expected = block("console", "$ saoms run composites/hall.composite --virtual\n");
    let (_, expected) = expected.split_once('\n').unwrap();
    let output = saoms(&["run", "composites/hall.composite", "--virtual"]);
    assert_eq!(expected, stdout(&output));
}

#[test]
fn the_mistake_of_the_readme_is_real() {
    let expected = block("console", "perid");
    let (_, expected) = expected.split_once('\n').unwrap();
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("readme/composites");
    fs::create_dir_all(&folder).unwrap();
    let shipped = project("composites/hall.composite");
    let (before, robot) = shipped.split_at(shipped.find("Robot7").unwrap());
    let wrong = format!("{before}{}", robot.replacen("\"period\"", "\"perid\"", 1));
    fs::write(folder.join("hall.composite"), wrong).unwrap();
    let output = saoms_in(folder.parent().unwrap(), &["run", "composites/hall.composite"]);
    assert_eq!(expected, stderr(&output));
    assert_eq!(code(&output), 2);
}
