//! The test programs of the crates are those that CONTRIBUTING.md names.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use crate::support::{project, root};

fn entries(folder: &Path) -> Vec<PathBuf> {
    fs::read_dir(folder).into_iter().flatten().map(|entry| entry.unwrap().path()).collect()
}

/// The test programs in a folder `tests`: files, and folders with a `main.rs`.
fn programs(tests: &Path) -> Vec<PathBuf> {
    let mut programs = entries(tests);
    programs
        .retain(|path| path.extension().is_some_and(|extension| extension == "rs") || path.join("main.rs").is_file());
    programs
}

/// The crates of the workspace.
fn packages() -> Vec<PathBuf> {
    let mut packages = entries(root());
    packages.extend(entries(&root().join("plugins")));
    packages.push(root().to_owned());
    packages.retain(|path| path.join("src").is_dir() && path.join("Cargo.toml").is_file());
    packages
}

#[test]
fn test_programs_beside_the_suites_are_named_with_their_reasons() {
    let found: BTreeSet<String> = packages()
        .iter()
        .flat_map(|package| programs(&package.join("tests")))
        .filter(|program| !program.ends_with("tests/suite"))
        .map(|program| {
            let path: Vec<_> = program.strip_prefix(root()).unwrap().iter().collect();
            let parts = path.iter().enumerate().map(|(place, part)| match place {
                1 if path[0] == "plugins" => "*",
                _ => part.to_str().unwrap(),
            });
            parts.collect::<Vec<_>>().join("/")
        })
        .collect();
    let guide = project("CONTRIBUTING.md");
    let list = guide.split("\nThe integration tests of a crate").nth(1).unwrap();
    let list = list.split("\n`fuzz/`").next().unwrap().lines().filter(|line| line.starts_with("- "));
    let names = list.flat_map(|line| line.split('`').skip(1).step_by(2));
    let named: BTreeSet<String> = names.filter(|name| name.contains("tests/")).map(str::to_owned).collect();
    assert_eq!(found, named, "left: test programs, right: those that CONTRIBUTING.md names");
}
