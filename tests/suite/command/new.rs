//! The crates of `saoms new` build, pass their own tests, and run.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::{env, fs};

use crate::support::{root, saoms_in, text};

/// The target folder of this test: the dependencies of the made crates are built there already.
fn target() -> PathBuf {
    Path::new(env!("CARGO_BIN_EXE_saoms")).parent().unwrap().parent().unwrap().to_owned()
}

/// Makes a plugin, tests it, builds it, and runs its fleet with the built library.
fn made_tested_and_run(kind: &str, expected: &str) {
    let folder = tempfile::tempdir().unwrap();
    let name = format!("made-{kind}");
    let made = saoms_in(folder.path(), &["new", "plugin", &name, "--kind", kind]);
    assert!(made.status.success(), "{}", text(&made));
    let plugin = folder.path().join(&name);
    // The same versions as here, so that nothing has to be fetched.
    fs::copy(root().join("Cargo.lock"), plugin.join("Cargo.lock")).unwrap();
    for command in ["test", "build"] {
        let cargo = Command::new(env::var_os("CARGO").unwrap_or_else(|| "cargo".into()))
            .args([command, "--offline", "--target-dir"])
            .arg(target())
            .env("SAOMS", env!("CARGO_BIN_EXE_saoms"))
            .current_dir(&plugin)
            .output()
            .unwrap();
        assert!(cargo.status.success(), "cargo {command}: {}", text(&cargo));
    }
    let library = target().join(format!("debug/libmade_{kind}.so"));
    let library = library.to_str().unwrap();
    let run = saoms_in(&plugin, &["run", "fleet.composite", "--virtual", "--for", "60s", "--plugin", library]);
    assert!(run.status.success() && text(&run).contains(expected), "{}", text(&run));
    let listed = saoms_in(&plugin, &["components", "--plugin", library]);
    assert!(text(&listed).contains(&format!("made_{kind}.Made")), "{}", text(&listed));
    assert!(saoms_in(&plugin, &["schema", "-o", "schema", "--plugin", library]).status.success());
    let schema = fs::read_to_string(plugin.join("schema/saoms.xsd")).unwrap();
    assert!(schema.contains(&format!("value=\"made_{kind}.Made")), "{schema}");
}

#[test]
fn a_made_component_builds_and_runs() {
    made_tested_and_run("component", "counts to 6");
}

#[test]
fn a_made_robot_builds_and_runs() {
    made_tested_and_run("robot", "deposited luggage 1 at (3,4)");
}

#[test]
fn a_made_loop_builds_and_runs() {
    made_tested_and_run("loop", "goes to charge");
}

#[test]
fn a_made_robot_that_extends_the_one_that_ships_builds_and_runs() {
    made_tested_and_run("extension", "has driven 8 blocks");
}

#[test]
fn a_made_master_builds_and_runs() {
    made_tested_and_run("master", "deposited luggage 2 at (3,10)");
}

#[test]
fn a_made_plugin_in_c_builds_and_runs() {
    let folder = tempfile::tempdir().unwrap();
    let made = saoms_in(folder.path(), &["new", "plugin", "made-c", "--kind", "c"]);
    assert!(made.status.success() && text(&made).contains("make test"), "{}", text(&made));
    let plugin = folder.path().join("made-c");
    let tested = Command::new("make")
        .args(["test", "CFLAGS=-Wall -Wextra -Werror -pedantic"])
        .arg(format!("SAOMS={}", env!("CARGO_BIN_EXE_saoms")))
        .current_dir(&plugin)
        .output()
        .unwrap();
    assert!(tested.status.success() && text(&tested).contains("counts to 4"), "{}", text(&tested));
    let listed = saoms_in(&plugin, &["components", "made_c.MadeC", "--plugin", "build"]);
    assert!(text(&listed).contains("Number that is added in each period."), "{}", text(&listed));
}

/// What a test of a plugin's fleet says where no command is installed.
#[test]
fn the_tests_of_a_plugin_are_told_where_the_command_is() {
    let folder = tempfile::tempdir().unwrap();
    let config = |path: &str| {
        let name = format!("made{}", path.len());
        let made = Command::new(env!("CARGO_BIN_EXE_saoms"))
            .args(["new", "plugin", &name])
            .env("PATH", path)
            .current_dir(folder.path())
            .output()
            .unwrap();
        assert!(made.status.success(), "{}", text(&made));
        fs::read_to_string(folder.path().join(name).join(".cargo/config.toml")).unwrap_or_default()
    };
    assert!(config("/nowhere").contains(&format!("SAOMS = {:?}", env!("CARGO_BIN_EXE_saoms"))));
    assert_eq!(config(Path::new(env!("CARGO_BIN_EXE_saoms")).parent().unwrap().to_str().unwrap()), "");
}

#[test]
fn a_made_composite_runs() {
    let folder = tempfile::tempdir().unwrap();
    let made = saoms_in(folder.path(), &["new", "composite", "my-hall"]);
    assert!(made.status.success(), "{}", text(&made));
    let run = saoms_in(folder.path(), &["run", "my-hall.composite", "--virtual"]);
    assert!(run.status.success() && text(&run).contains("deposited luggage 1 at (3,10)"), "{}", text(&run));
    // The line for CI of docs/severities.md.
    let check = ["check", "--wiring", "--severity", "S4010=error", "my-hall.composite"];
    let checked = saoms_in(folder.path(), &check);
    assert!(checked.status.success(), "{}", text(&checked));
    // Who gives a topic another name means a reader.
    let path = folder.path().join("my-hall.composite");
    let composite = fs::read_to_string(&path).unwrap();
    let renamed = "<property name=\"topicRename\">COLLISIONTOPIC,crashes</property></component>";
    fs::write(&path, composite.replace("</component>", renamed)).unwrap();
    let checked = text(&saoms_in(folder.path(), &check));
    assert!(checked.contains("topic `crashes`, which no component reads"), "{checked}");
}

#[test]
fn a_made_site_runs_with_its_files_and_options() {
    let folder = tempfile::tempdir().unwrap();
    let made = saoms_in(folder.path(), &["new", "site", "north-hall"]);
    assert!(made.status.success() && text(&made).contains("saoms run site.composite"), "{}", text(&made));
    let site = folder.path().join("north-hall");
    let readme = fs::read_to_string(site.join("README.md")).unwrap();
    let (_, commands) = readme.split_once("```\n").unwrap();
    for line in commands.lines().take_while(|line| *line != "```") {
        let line = line.split(" #").next().unwrap().trim_end();
        let mut words: Vec<&str> = line.strip_prefix("saoms ").unwrap().split(' ').collect();
        if words == ["run", "site.composite"] {
            words.push("--virtual");
        }
        let done = saoms_in(&site, &words);
        assert!(done.status.success(), "{line}: {}", text(&done));
        if words[0] == "run" {
            assert!(
                text(&done).contains("8 of 8 pieces of luggage delivered, no collision"),
                "{line}: {}",
                text(&done)
            );
        }
    }
    assert!(site.join("way.svg").exists());
    let strict = ["check", "--wiring", "--severity", "S4010=error", "site.composite"];
    assert!(saoms_in(&site, &strict).status.success());
    assert!(saoms_in(&site, &["fmt", "--check", "site.composite"]).status.success());
    let again = saoms_in(folder.path(), &["new", "site", "north-hall"]);
    assert_eq!(again.status.code(), Some(2), "{}", text(&again));
}

#[test]
fn nothing_that_is_there_is_touched() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("hall.composite"), "mine").unwrap();
    let made = saoms_in(folder.path(), &["new", "composite", "hall"]);
    assert_eq!(made.status.code(), Some(2));
    assert!(text(&made).contains("is there already: nothing was made"), "{}", text(&made));
    fs::create_dir(folder.path().join("robot")).unwrap();
    fs::write(folder.path().join("robot/README.md"), "mine").unwrap();
    let made = saoms_in(folder.path(), &["new", "plugin", "robot"]);
    assert_eq!(made.status.code(), Some(2));
    assert!(!folder.path().join("robot/Cargo.toml").exists());
}

#[test]
fn wrong_names_and_sources_are_told() {
    let folder = tempfile::tempdir().unwrap();
    for (arguments, expected) in [
        (["new", "plugin", "MyRobot"].as_slice(), "expected one for a Rust package"),
        (&["new", "plugin", "loop"], "a name of Rust itself"),
        (&["new", "plugin", "saoms-api"], "a crate of SAOMS itself"),
        (
            &["new", "plugin", "context"],
            "`Context` is used by the code that is made: take another one, such as `my-context`",
        ),
        (&["new", "plugin", "failure"], "`Failure` is used by the code"),
        (&["new", "plugin", "hardware", "--kind", "robot"], "`Hardware` is used by the code"),
        (&["new", "plugin", "component"], "`Component` is used by the code"),
        (&["new", "plugin", "class"], "`Class` is used by the code"),
        (&["new", "plugin", "adaptation", "--kind", "loop"], "`Adaptation` is used by the code"),
        (&["new", "plugin", "robot", "--kind", "extension"], "`Robot` is used by the code"),
        (&["new", "plugin", "own", "--kind", "master"], "`Own` is used by the code"),
        (&["new", "plugin", "count"], "`Count` is used by the code"),
        (&["new", "plugin", "result"], "`Result` is used by the code"),
        (&["new", "plugin", "robot", "--api", "nowhere"], "expected a folder with `saoms-api` in it"),
        (&["new", "composite", "2 halls"], "it becomes the name of the composite"),
        (&["new", "site", "2 halls"], "it becomes the name of the composite"),
    ] {
        let made = saoms_in(folder.path(), arguments);
        assert_eq!(made.status.code(), Some(2), "{}", text(&made));
        assert!(text(&made).contains(expected), "{}", text(&made));
    }
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
}
