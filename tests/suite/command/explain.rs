//! `saoms explain`, `completions` and `man`: what the program says of itself.

use std::fs;

use saoms_lang::diagnostic::codes;

use crate::support::{code, empty_folder, saoms, saoms_in, stderr, stdout};

#[test]
fn every_code_is_explained_with_an_example() {
    let all: Vec<&str> = codes::ALL.iter().map(|code| code.id).chain(["S5001", "S5009"]).collect();
    let output = saoms(&[&["explain"], &*all].concat());
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    let shown = stdout(&output);
    assert_eq!(shown.matches("\nExample:\n\n  ").count(), all.len(), "{shown}");
    assert!(!shown.contains("```"), "{shown}");
}

#[test]
fn a_code_is_found_by_its_name_and_by_the_rule_of_sca() {
    let by_code = stdout(&saoms(&["explain", "s3004"]));
    assert!(by_code.starts_with("S3004 unknown-property (error, ASM50037)\n\nA component"), "{by_code}");
    assert!(by_code.contains("    = help: replace `sped` with `speed`\n"), "{by_code}");
    for name in ["unknown-property", "asm50037"] {
        assert_eq!(stdout(&saoms(&["explain", name])), by_code);
    }
}

#[test]
fn a_mistyped_code_is_refused_with_the_nearest_one_and_the_others_are_explained() {
    let output = saoms(&["explain", "S30O4", "S3001"]);
    assert_eq!(code(&output), 2);
    assert!(stderr(&output).ends_with("those of a plugin with `--plugin PATH`\n"), "{}", stderr(&output));
    assert!(stderr(&saoms(&["explain", "ASM60004"])).contains("help: explain the code before it"));
    assert!(stderr(&output).starts_with("error: there is no code `S30O4`\nhelp: did you mean `S3004`?\n"));
    assert!(stdout(&output).starts_with("S3001 "));
    assert!(stderr(&saoms(&["explain", "S509"])).contains("did you mean `S5009`?"), "not `S4509`");
}

#[test]
fn without_a_code_all_are_listed() {
    let listed = stdout(&saoms(&["explain"]));
    for code in codes::ALL {
        assert!(listed.contains(&format!("{}  {}", code.id, code.name)), "{}", code.id);
    }
    assert!(listed.contains("\nS5009  "), "{listed}");
}

#[test]
fn completions_know_every_command_and_its_options() {
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let script = stdout(&saoms(&["completions", shell]));
        for word in ["expand", "explain", "virtual", "timer-slack"] {
            assert!(script.contains(word), "{shell} does not complete `{word}`");
        }
    }
}

#[test]
fn every_command_has_a_manual_page() {
    let folder = empty_folder("man").join("man1");
    let output = saoms(&["man", "-o", folder.to_str().unwrap()]);
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    let help = stdout(&saoms(&["--help"]));
    let (_, commands) = help.split_once("Commands:\n").unwrap();
    for line in commands.lines().take_while(|line| !line.is_empty()) {
        let command = line.split_whitespace().next().unwrap();
        if command != "help" {
            let page = fs::read_to_string(folder.join(format!("saoms-{command}.1"))).unwrap();
            assert!(page.contains(".SH SYNOPSIS"), "{page}");
        }
    }
    let output = saoms(&["man", "-o", "/proc/none"]);
    assert_eq!(code(&output), 1);
    assert!(stderr(&output).starts_with("error: the manual page cannot be written to `/proc/none`: "));
}

#[test]
fn several_files_need_a_folder() {
    let folder = empty_folder("several files");
    fs::write(folder.join("file"), "").unwrap();
    for (command, what) in [("man", "manual pages"), ("schema", "schemas")] {
        for (path, why) in [("-", "which is standard output: they are several files"), ("file", "which is a file")] {
            let output = saoms_in(&folder, &[command, "-o", path]);
            let told = format!("error: the {what} cannot be written to `{path}`, {why}\n");
            assert!(code(&output) == 2 && stderr(&output).starts_with(&told), "{}", stderr(&output));
        }
    }
    assert_eq!(fs::read_dir(&folder).unwrap().count(), 1);
    let output = saoms(&["expand", "composites/hall.composite", "-o", "out.composite"]);
    assert!(stderr(&output).contains("tip: this command writes to standard output: add `> FILE` to write to a file"));
    let output = saoms(&["run", "composites/hall.composite", "--wiring"]);
    assert!(stderr(&output).contains("tip: this option belongs to `saoms check`"), "{}", stderr(&output));
    for (written, meant) in [("--time", "--for"), ("--duration", "--for"), ("--simulation", "--virtual")] {
        let told = stderr(&saoms(&["run", "composites/hall.composite", written, "10s"]));
        assert!(told.contains(&format!("tip: a similar argument exists: '{meant}'")), "{told}");
        assert_eq!(told.matches("tip:").count(), 1, "{told}");
        assert!(!told.contains("--timer-slack"), "{told}");
    }
    for version in ["-v", "-V"] {
        let output = saoms(&["run", "composites/hall.composite", version]);
        let told = stderr(&output);
        assert!(code(&output) == 2 && told.contains("tip: `saoms --version` prints the version"), "{told}");
    }
    let output = saoms(&["run", "composites/hall.composite", "--seed", "abc"]);
    assert!(stderr(&output).contains("expected a whole number from 0 to 18446744073709551615"));
}
