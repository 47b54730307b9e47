//! Options that have no effect are refused, and the help of a command says what its exit codes mean.

use std::collections::BTreeSet;

use crate::support::{answer, empty_folder, saoms, stdout};

const HALL: &str = "composites/hall.composite";

#[test]
fn options_that_have_no_effect_beside_others_are_refused() {
    for (first, second) in [
        ("--virtual", "--realtime"),
        ("--virtual", "--timer-slack=1ns"),
        ("--virtual", "--budget=5ms"),
        ("--virtual", "--reload"),
        ("--realtime", "--timer-slack=1ns"),
    ] {
        let (code, out, error) = answer(&saoms(&["run", HALL, first, second]));
        assert_eq!((code, out.as_str()), (2, ""), "{first} {second}");
        let second = second.split('=').next().unwrap();
        assert!(error.contains("cannot be used with") && error.contains(first) && error.contains(second), "{error}");
        assert!(error.contains("leave one out"), "{error}");
    }
}

#[test]
fn reload_needs_a_library_to_watch() {
    let (code, out, error) = answer(&saoms(&["run", HALL, "--reload", "--for", "1s"]));
    assert_eq!((code, out.as_str()), (2, ""));
    assert!(error.contains("error: `--reload` has nothing to watch") && error.contains("`--plugin`"), "{error}");
}

#[test]
fn a_picture_has_one_format() {
    let folder = empty_folder("format");
    let path = folder.join("hall.svg");
    let (code, _, error) = answer(&saoms(&["graph", HALL, "-o", path.to_str().unwrap(), "--format", "dot"]));
    assert_eq!(code, 2);
    assert!(error.contains("`--format` differs from the ending of") && !path.exists(), "{error}");
    assert_eq!(answer(&saoms(&["graph", HALL, "-o", path.to_str().unwrap(), "--format", "svg"])).0, 0);
}

/// The commands that a help lists.
fn below(arguments: &[&str]) -> Vec<String> {
    let help = stdout(&saoms(&[arguments, &["--help"]].concat()));
    let Some((_, listed)) = help.split_once("\nCommands:\n") else { return Vec::new() };
    let names = listed.lines().take_while(|line| !line.is_empty()).filter_map(|line| line.split_whitespace().next());
    names.filter(|name| *name != "help").map(str::to_owned).collect()
}

#[test]
fn each_help_says_its_own_exit_codes() {
    let commands = below(&[]);
    assert!(commands.len() > 9, "{commands:?}");
    let mut seen = BTreeSet::new();
    for command in &commands {
        let help = stdout(&saoms(&[command, "--help"]));
        let codes = help.split_once("\nExit codes:\n").unwrap_or_else(|| panic!("{command} has none")).1;
        assert!(codes.trim_start().starts_with("0 "), "{command}: {codes}");
        assert!(seen.insert(codes.to_owned()), "{command} has those of another command: {codes}");
        for name in below(&[command]) {
            assert!(stdout(&saoms(&[command, &name, "--help"])).contains("\nExit codes:\n"), "{command} {name}");
        }
    }
    let of = |command: &str| stdout(&saoms(&[command, "--help"]));
    assert!(of("run").contains("  130  ended by Ctrl-C"));
    assert!(!of("check").contains("130") && !of("check").contains("--for elapsed"));
}
