//! The rules of ARCHITECTURE.md: what a crate and a module must not know, and the layout of the page.

use std::fs;
use std::path::{Path, PathBuf};

use crate::support::{project, root};

/// The folders with an order of modules, each with the path of its modules: a module may use those before it, none
/// after it.
const ORDERS: &[(&str, &str, &[&str])] = &[
    (
        "saoms-lang/src",
        "crate::",
        &[
            "limits", "source", "diagnostic", "expression", "syntax", "model", "load", "contribution", "assembly",
            "check", "project",
        ],
    ),
    (
        "saoms-lang/src/check",
        "crate::check::",
        &[
            "judged", "options", "report", "hidden", "values", "fleet", "parameters", "unfolding", "classes",
            "properties", "loops", "component", "tasks", "contracts", "wiring", "web", "placement", "rules",
            "run_settings", "assemble", "occurrences", "wanted_tables",
        ],
    ),
    (
        "saoms-core/src",
        "crate::",
        &[
            "hash", "plugin", "assemble", "bus", "journal", "adaptation", "report", "status", "tape", "observe",
            "fault", "store", "network", "web", "schedule", "replay",
        ],
    ),
];

/// The sources in a folder and below it, but what is built of them, and links to others.
pub(super) fn rust_files(folder: &Path) -> Vec<PathBuf> {
    let mut files = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_symlink() {
            continue;
        }
        if path.is_dir() && !path.ends_with("target") {
            files.extend(rust_files(&path));
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            files.push(path);
        }
    }
    files
}

/// The path segments that follow `prefix` in the file, with their lines; comments do not count.
fn paths_behind(prefix: &str, text: &str) -> Vec<(usize, String)> {
    let mut found = Vec::new();
    for (number, line) in text.lines().enumerate() {
        let code = line.split("//").next().unwrap_or_default();
        for after in code.split(prefix).skip(1) {
            let names = match after.strip_prefix('{') {
                Some(list) => list.split('}').next().unwrap_or_default().split(',').map(str::trim).collect(),
                None => vec![after],
            };
            for name in names {
                let end = name.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(name.len());
                found.push((number + 1, name[..end].to_owned()));
            }
        }
    }
    found
}

#[test]
fn a_module_uses_only_modules_before_it() {
    let mut wrong = Vec::new();
    for (name, prefix, order) in ORDERS {
        let source = root().join(name);
        for file in rust_files(&source) {
            let relative = file.strip_prefix(&source).unwrap();
            let module = relative.iter().next().unwrap().to_str().unwrap().trim_end_matches(".rs");
            if ["lib", "mod"].contains(&module) {
                continue;
            }
            let Some(place) = order.iter().position(|name| *name == module) else {
                panic!("module `{module}` of {name} has no place in the order {order:?}");
            };
            for (line, used) in paths_behind(prefix, &fs::read_to_string(&file).unwrap()) {
                if order.iter().position(|name| *name == used).is_some_and(|other| other > place) {
                    let file = file.display();
                    wrong.push(format!("{file}:{line}: `{module}` comes before `{used}` and must not use it"));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// The names of the crates of this workspace that the crate depends on, tests aside.
fn dependencies(package: &str) -> Vec<String> {
    let manifest = fs::read_to_string(root().join(package).join("Cargo.toml")).unwrap();
    let section = manifest.split("\n[dependencies]").nth(1).unwrap_or_default().split("\n[").next().unwrap();
    section
        .lines()
        .filter_map(|line| line.split(['.', ' ', '=']).next())
        .filter(|name| name.starts_with("saoms-"))
        .map(str::to_owned)
        .collect()
}

#[test]
fn each_invariant_is_a_line_in_bold() {
    for line in project("ARCHITECTURE.md").lines().filter(|line| line.contains("**")) {
        let inside = line.strip_prefix("**").and_then(|rest| rest.strip_suffix("**"));
        assert!(inside.is_some_and(|inside| !inside.contains("**") && inside.ends_with('.')), "{line}");
    }
}

#[test]
fn crates_know_only_what_they_may() {
    assert_eq!(dependencies("saoms-abi"), Vec::<String>::new(), "the boundary is plain C");
    assert_eq!(dependencies("saoms-derive"), Vec::<String>::new());
    assert_eq!(dependencies("saoms-api"), ["saoms-abi", "saoms-derive"]);
    assert_eq!(dependencies("saoms-registry"), ["saoms-api"], "declarations are known without anything that runs");
    assert_eq!(dependencies("saoms-lang"), ["saoms-api", "saoms-registry"], "what judges composites never runs them");
    assert_eq!(
        dependencies("saoms-core"),
        ["saoms-abi", "saoms-api", "saoms-lang"],
        "the core never knows a component"
    );
    assert_eq!(dependencies("saoms-tools"), ["saoms-api", "saoms-lang"], "no tool runs a fleet");
    assert_eq!(dependencies("saoms-control"), ["saoms-api", "saoms-core", "saoms-lang"], "operators reach any fleet");
    assert_eq!(dependencies("saoms-history"), ["saoms-api", "saoms-core"], "any fleet has a history");
    assert_eq!(
        dependencies("saoms-recording"),
        ["saoms-api", "saoms-core", "saoms-registry"],
        "any fleet can be recorded, and a recording be read without one"
    );
    assert_eq!(dependencies("saoms-components"), ["saoms-api"], "components know the contract alone");
}

#[test]
fn the_protocol_of_editors_neither_reads_composites_nor_checks_them() {
    for file in rust_files(&root().join("src/lsp")) {
        let text = fs::read_to_string(&file).unwrap();
        for absent in ["load", "contribution", "check", "syntax", "model", "project::Project", "assembly"] {
            assert!(!text.contains(&format!("saoms_lang::{absent}")), "{} uses `{absent}`", file.display());
        }
        assert!(!text.contains("std::fs"), "{} reads files", file.display());
    }
}

#[test]
fn the_contract_does_no_input_or_output() {
    for file in rust_files(&root().join("saoms-api/src")) {
        let text = fs::read_to_string(&file).unwrap();
        for absent in ["std::fs", "std::net", "std::io", "std::process", "std::thread", "async fn"] {
            let code = text.lines().filter(|line| !line.trim_start().starts_with("//"));
            assert!(!code.clone().any(|line| line.contains(absent)), "{} uses `{absent}`", file.display());
        }
    }
}

#[test]
fn the_checker_knows_no_clock_no_thread_and_no_network() {
    let is_test = |file: &PathBuf| file.iter().any(|part| part == "tests" || part == "tests.rs");
    for file in rust_files(&root().join("saoms-lang/src")).into_iter().filter(|file| !is_test(file)) {
        let text = fs::read_to_string(&file).unwrap();
        for absent in ["Instant", "SystemTime", "std::thread", "TcpStream", "UdpSocket", "ToSocketAddrs"] {
            let code = text.lines().filter(|line| !line.trim_start().starts_with("//"));
            assert!(!code.clone().any(|line| line.contains(absent)), "{} uses `{absent}`", file.display());
        }
    }
}

/// Words of the domain of the components that ship: the program knows them only through what `saoms-components`
/// registers.
const DOMAIN: &[&str] =
    &["luggage", "collision", "stranded", "robot", "airport", "charg", "battery", "healer", "scenario"];

/// Examples in messages and helps, and names of the contract, that may say such a word.
const EXAMPLES: &[&str] =
    &["`hall/Robot001`", "`robots > 10", "unibg.robotics.tca", "value_name = \"ROBOT\"", "no such robot"];

/// A line of code without comments and without the examples.
fn without_examples(line: &str) -> String {
    let code = line.split("//").next().unwrap_or_default();
    EXAMPLES.iter().fold(code.to_owned(), |code, example| code.replace(example, ""))
}

#[test]
fn only_the_components_know_their_domain() {
    // Templates of plugins are for makers of robots.
    let templates = root().join("src/command/new");
    let is_test = |file: &Path| file.iter().any(|part| part == "tests" || part == "tests.rs");
    let mut wrong = Vec::new();
    for source in [
        "saoms-lang/src", "saoms-core/src", "saoms-control/src", "saoms-history/src", "saoms-recording/src",
        "saoms-tools/src", "src",
    ] {
        let files = rust_files(&root().join(source));
        for file in files.iter().filter(|file| !file.starts_with(&templates) && !is_test(file)) {
            let text = fs::read_to_string(file).unwrap();
            let tests = ["#[cfg(test)]\nmod tests {", "#[cfg(test)]\n#[test]", "\n#[test]"];
            let code = tests.iter().fold(text.as_str(), |code, start| code.split(start).next().unwrap_or(code));
            for (number, line) in code.lines().enumerate() {
                let line = without_examples(line).to_lowercase();
                wrong.extend(
                    DOMAIN
                        .iter()
                        .filter(|word| line.contains(**word))
                        .map(|word| format!("{}:{}: `{word}` is of the domain", file.display(), number + 1)),
                );
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
