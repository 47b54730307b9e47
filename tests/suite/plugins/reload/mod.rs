//! `saoms run --reload` with real libraries, which the system's C compiler builds anew while the fleet runs.

use std::fs;
use std::io::{BufRead, BufReader, Lines};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdout, Command, Stdio};

use serde_json::Value;

use crate::support::{command, root};

const FLEET: &str = r#"<composite xmlns="http://docs.oasis-open.org/ns/opencsa/sca/200912" name="f" targetNamespace="urn:f">
  <component name="Counter">
    <implementation.rust class="test.Counter"/>
    <property name="ID">Counter</property>
    <property name="period">20</property>
  </component>
  <component name="Master">
    <implementation.rust class="saoms.MasterEnvironment"/>
    <property name="ID">Master</property>
    <property name="period">500</property>
  </component>
</composite>
"#;

/// A fleet that runs, and its folder.
struct Run {
    folder: tempfile::TempDir,
    child: Child,
    lines: Lines<BufReader<ChildStdout>>,
    seen: Vec<String>,
}

/// Builds the library into the folder, over an earlier build, with these definitions.
fn build(folder: &Path, definitions: &[&str]) {
    let new = folder.join("new");
    let output = Command::new("cc")
        .args(["-std=c99", "-Wall", "-Werror", "-shared", "-fPIC", "-I"])
        .arg(root().join("saoms-abi/include"))
        .args(definitions)
        .arg(root().join("tests/suite/plugins/reload/counter.c"))
        .arg("-o")
        .arg(&new)
        .output();
    let output = output.unwrap_or_else(|error| panic!("this test needs the system's C compiler, `cc`: {error}"));
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    // As a linker that writes over the file, which is the worst that can happen to a library in use.
    fs::write(library(folder), fs::read(new).unwrap()).unwrap();
}

fn library(folder: &Path) -> PathBuf {
    folder.join("libcounter.so")
}

impl Run {
    fn start(definitions: &[&str]) -> Run {
        let folder = tempfile::tempdir().unwrap();
        build(folder.path(), definitions);
        let composite = folder.path().join("f.composite");
        fs::write(&composite, FLEET).unwrap();
        let mut child = command(&["run", "--reload", "--for", "60s", "--report"])
            .arg(folder.path().join("report.json"))
            .arg("--journal")
            .arg(folder.path().join("run.ndjson"))
            .arg(composite)
            .arg("--plugin")
            .arg(folder.path())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let lines = BufReader::new(child.stdout.take().unwrap()).lines();
        let mut run = Run { folder, child, lines, seen: Vec::new() };
        run.wait_for("build 1 counts 1");
        run
    }

    fn build(&self, definitions: &[&str]) {
        build(self.folder.path(), definitions);
    }

    /// Reads on to a line with this text, and gives it.
    fn wait_for(&mut self, text: &str) -> String {
        for line in self.lines.by_ref() {
            self.seen.push(line.unwrap());
            if self.seen.last().unwrap().contains(text) {
                return self.seen.last().unwrap().clone();
            }
        }
        panic!("`{text}` was never said: {:#?}", self.seen)
    }

    /// Ends the run; what it said, its report and its exit code.
    fn end(mut self) -> (Vec<String>, Value, Option<i32>) {
        let pid = i32::try_from(self.child.id()).unwrap();
        // SAFETY: `kill` takes no pointers; the process is our own child, not yet waited for.
        assert_eq!(unsafe { libc::kill(pid, libc::SIGINT) }, 0);
        self.seen.extend(self.lines.by_ref().map(Result::unwrap));
        let code = self.child.wait().unwrap().code();
        let report = fs::read(self.folder.path().join("report.json")).unwrap();
        let journal = fs::read_to_string(self.folder.path().join("run.ndjson")).unwrap();
        let records = journal.lines().map(|line| serde_json::from_str::<Value>(line).unwrap());
        let changes: Vec<Value> = records.filter(|record| record["record"] == "fleet_changed").collect();
        // Each says who wants it.
        assert!(changes.iter().all(|change| change["values"]["by"] == "reload"), "{changes:?}");
        let are_replaced = self.seen.iter().any(|line| line.contains("its components are replaced"));
        assert_eq!(!changes.is_empty(), are_replaced, "{journal}");
        (self.seen, serde_json::from_slice(&report).unwrap(), code)
    }
}

/// What is told of code of the library, with its name.
fn of_library(run: &Run, told: &str) -> String {
    format!("{told} (library `{}`)", library(run.folder.path()).display())
}

/// The number that a line says last.
fn counted(line: &str) -> u64 {
    line.rsplit(' ').next().unwrap().parse().unwrap()
}

#[test]
fn a_new_build_goes_on_where_the_earlier_one_was() {
    let mut run = Run::start(&["-DBUILD=1"]);
    run.build(&["-DBUILD=2", "-DDOC=\"Counts on.\""]);
    run.wait_for(&of_library(&run, "is replaced later: it has not counted to 100 yet"));
    run.wait_for("is replaced, and continues with the earlier state");
    let first = counted(&run.wait_for("build 2 counts"));
    run.build(&["-DBUILD=3"]);
    let later = counted(&run.wait_for("build 3 counts"));
    let (seen, report, code) = run.end();
    let before = seen.iter().rev().find(|line| line.contains("build 1 counts")).unwrap();
    assert_eq!(first, counted(before) + 1, "no execution is lost, none is counted twice");
    assert!(later > first);
    let ends: Vec<_> = seen.iter().filter(|line| line.contains(" ends")).collect();
    assert!(ends.len() == 1 && ends[0].contains("build 3 ends"), "only the last one is shut down: {ends:?}");
    assert_eq!(report["components"][0]["replaced"], 2);
    assert_eq!(report["components"][0]["failures"], 0);
    assert_eq!(code, Some(130));
}

#[test]
fn a_build_that_hangs_leaves_the_earlier_one_running() {
    let mut run = Run::start(&["-DBUILD=1", "-DHANGS_AT_END"]);
    run.wait_for("build 1 counts 100");
    run.build(&["-DBUILD=2", "-DHANGS"]);
    let told = "is not replaced, the earlier one continues: `initialize` or `restore` has not returned within 2s, \
                and its thread is left behind";
    run.wait_for(&of_library(&run, told));
    let before = counted(&run.wait_for("build 1 counts"));
    assert!(counted(&run.wait_for("build 1 counts")) > before);
    // Nobody waits for the destructor of the earlier one.
    run.build(&["-DBUILD=3"]);
    run.wait_for("build 3 counts");
    run.wait_for("build 3 counts");
    let mut errors = BufReader::new(run.child.stderr.take().unwrap()).lines().map(Result::unwrap);
    for function in ["`initialize`", "the destructor"] {
        let expected = format!("the program waits for {function} of component `Counter` of library `");
        assert!(errors.any(|line| line.contains(&expected)), "{expected} is missing");
    }
    let (_, report, code) = run.end();
    assert_eq!(report["components"][0]["replaced"], 1);
    assert_eq!(code, Some(130));
}

#[test]
fn nobody_waits_for_the_hardware_of_an_earlier_build_to_be_released() {
    let mut run = Run::start(&["-DBUILD=1", "-DMOTOR"]);
    run.wait_for("build 1 counts 100");
    run.build(&["-DBUILD=2", "-DMOTOR"]);
    run.wait_for("build 2 counts");
    run.wait_for("build 2 counts");
    let (_, report, _) = run.end();
    assert_eq!(report["components"][0]["replaced"], 1);
    assert_eq!(report["components"][0]["failures"], 0);
}

#[test]
fn hardware_stops_although_a_new_build_hangs_while_it_is_loaded() {
    let mut run = Run::start(&["-DBUILD=1", "-DMOTOR", "-DFAILS_AT=500"]);
    run.build(&["-DBUILD=2", "-DMOTOR", "-DHANGS_WHILE_LOADED"]);
    let mut errors = BufReader::new(run.child.stderr.take().unwrap()).lines().map(Result::unwrap);
    let expected = "the program waits for the static constructors or the entry function of library `";
    assert!(errors.any(|line| line.contains(expected)), "{expected} is missing");
    run.wait_for("failed: this build fails");
    assert!(errors.any(|line| line == "the hardware stops"), "at once");
    let (_, report, code) = run.end();
    let rest: Vec<String> = errors.collect();
    assert!(!rest.iter().any(|line| line.contains("may still move")), "{rest:#?}");
    assert!(report["outcome"].to_string().contains("this build fails"), "{report}");
    assert_eq!(code, Some(130));
}

/// Also where nothing but the component itself has the function that stops its hardware any more.
#[test]
fn a_failure_is_told_although_the_end_of_the_component_hangs() {
    for ends in [&["-DMOTOR", "-DENDS_SLOWLY"][..], &["-DHANGS_AT_END"]] {
        let mut run = Run::start(&[&["-DBUILD=1", "-DFAILS_AT=50"], ends].concat());
        run.wait_for(&of_library(&run, "failed: this build fails"));
        let (_, report, code) = run.end();
        assert!(report["outcome"].to_string().contains("this build fails"), "{report}");
        assert_eq!(code, Some(130));
    }
}

#[test]
fn a_build_that_cannot_take_over_leaves_the_earlier_one_in_place() {
    let mut run = Run::start(&["-DBUILD=1"]);
    run.wait_for("build 1 counts 100");
    run.build(&["-DBUILD=2", "-DSTUMBLES"]);
    run.wait_for(&of_library(&run, "is not replaced, the earlier one continues: this build cannot initialize"));
    run.wait_for("build 1 counts");
    fs::write(library(run.folder.path()), "no library at all").unwrap();
    run.wait_for("the fleet continues with the earlier build");
    run.wait_for("build 1 counts");
    run.build(&["-DBUILD=3", "-DREFUSES"]);
    run.wait_for("the fleet continues with the earlier build");
    run.wait_for("build 1 counts");
    run.build(&["-DBUILD=4", "-DFORGETS"]);
    run.wait_for("build 4 counts");
    run.build(&["-DBUILD=5"]);
    run.wait_for("is replaced, and starts without the earlier state");
    assert!(counted(&run.wait_for("build 5 counts")) <= 2);
    let (_, report, _) = run.end();
    assert_eq!(report["components"][0]["replaced"], 2);
}

#[test]
fn a_new_build_brings_back_what_failed() {
    let mut run = Run::start(&["-DBUILD=1", "-DFAILS_AT=3"]);
    run.wait_for("failed: this build fails");
    run.build(&["-DBUILD=2"]);
    run.wait_for("build 2 counts 1");
    let (_, report, _) = run.end();
    assert_eq!(report["components"][0]["failures"], 1);
    assert!(report["outcome"].to_string().contains("this build fails"), "what failed once is not forgotten");
}
