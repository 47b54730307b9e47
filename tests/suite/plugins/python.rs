//! Components in Python: `plugins/python`, which runs them, and the example.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::LazyLock;

use serde_json::Value;
use tempfile::TempDir;

use crate::plugins::library;
use crate::support::{PROGRAM, code, command, empty_folder, root, stderr, stdout, text};

/// True if there is a Python that the plugin can use; a test that is skipped says so.
#[expect(clippy::print_stdout, reason = "a test that is skipped says so")]
fn is_there() -> bool {
    let looks = "import sys, sysconfig; sys.exit(sys.version_info < (3, 9) or not sysconfig.get_config_var('Py_ENABLE_SHARED'))";
    let is_there = Command::new("python3").args(["-c", looks]).status().is_ok_and(|status| status.success());
    if !is_there {
        let missing = "there is no Python 3.9 with its shared library";
        assert!(std::env::var("SAOMS_PEERS").as_deref() != Ok("required"), "{missing}");
        println!("skipped: {missing}");
    }
    is_there
}

/// A folder with a module, and a composite with a component `A` of its class `Worker`.
fn folder(module: &str) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("work.py"), module).unwrap();
    let composite = r#"<composite xmlns="http://docs.oasis-open.org/ns/opencsa/sca/200912" name="f" targetNamespace="urn:f">
<component name="A"><implementation.python module="work" class="Worker"/>
<property name="ID" value="A"/><property name="period" value="10ms"/></component></composite>"#;
    fs::write(folder.path().join("fleet.composite"), composite).unwrap();
    folder
}

/// A folder that has the plugin alone, which packages have beside the command.
static PLUGIN: LazyLock<PathBuf> = LazyLock::new(|| {
    let folder = empty_folder("python-plugin");
    fs::copy(library("saoms_python"), folder.join("libsaoms_python.so")).unwrap();
    folder
});

/// Runs `saoms` in a folder, with the plugin.
fn saoms_in(folder: &Path, arguments: &[&str]) -> Output {
    command(arguments).current_dir(folder).env("SAOMS_PLUGIN_PATH", &*PLUGIN).output().unwrap()
}

fn saoms(arguments: &[&str]) -> Output {
    saoms_in(root(), arguments)
}

fn run(folder: &Path, more: &[&str]) -> Output {
    saoms_in(folder, &[&["run", "fleet.composite", "--plugin", "work.py"], more].concat())
}

#[test]
fn the_example_reads_calls_and_is_the_same_in_each_run() {
    if !is_there() {
        return;
    }
    let example = "plugins/counter-in-python";
    let composite = format!("{example}/fleet.composite");
    let run = || {
        let run =
            saoms(&["run", &composite, "--virtual", "--for", "3s", "--quiet", "--report", "-", "--plugin", example]);
        assert!(run.status.success(), "{}", text(&run));
        serde_json::from_slice::<Value>(&run.stdout).unwrap()
    };
    let (first, second) = (run(), run());
    assert_eq!(first["reader"]["count"], 52, "{first:#}");
    assert!(first["trace_hash"].is_string());
    assert_eq!(first["trace_hash"], second["trace_hash"]);
    let expanded = saoms(&["expand", &composite]);
    assert!(
        stdout(&expanded).contains(r#"<implementation.python module="counter" class="Reader"/>"#),
        "{}",
        text(&expanded)
    );
}

#[test]
fn a_new_plugin_passes_its_own_tests() {
    if !is_there() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let made = saoms_in(folder.path(), &["new", "plugin", "my-counter", "--kind", "python"]);
    assert!(made.status.success() && stdout(&made).contains("python3 -m unittest"), "{}", text(&made));
    let mut tests = Command::new("python3");
    tests.args(["-m", "unittest"]).current_dir(folder.path().join("my-counter")).env("SAOMS", PROGRAM);
    tests.env("SAOMS_PLUGIN_PATH", &*PLUGIN);
    let tests = tests.output().unwrap();
    assert!(tests.status.success() && stderr(&tests).contains("Ran 2 tests"), "{}", text(&tests));
    let refused = saoms_in(folder.path(), &["new", "plugin", "import", "--kind", "python"]);
    assert!(stderr(&refused).contains("a name of Python itself"), "{}", text(&refused));
}

#[test]
fn it_runs_in_real_time_and_in_the_order_of_its_seed() {
    if !is_there() {
        return;
    }
    let folder = folder(
        "import saoms
class Worker(saoms.Component):
    def initialize(self):
        self.context.work_left()
    def execute(self):
        if self.context.execution == 3:
            self.context.report('drawn', self.context.random.random())
            self.context.report('order', ' '.join({'a', 'b', 'c', 'd'}))
            self.context.work_done()
",
    );
    let report = |more: &[&str]| -> Value {
        let run = run(folder.path(), &[&["--seed", "7", "--quiet", "--report", "-"], more].concat());
        assert!(run.status.success(), "{}", text(&run));
        serde_json::from_slice(&run.stdout).unwrap()
    };
    let (real, virtually) = (report(&[]), report(&["--virtual"]));
    assert_eq!([&real["drawn"], &real["order"]], [&virtually["drawn"], &virtually["order"]]);
}

#[test]
fn a_check_runs_nothing_and_a_run_needs_the_module_to_be_named() {
    if !is_there() {
        return;
    }
    let folder = folder("import saoms\nopen('ran', 'w')\nclass Worker(saoms.Component):\n    def execute(self): ...\n");
    for named in [&[] as &[&str], &["--plugin", "work.py"]] {
        let check = saoms_in(folder.path(), &[&["check", "fleet.composite"], named].concat());
        assert!(check.status.success(), "{}", text(&check));
    }
    let refused = saoms_in(folder.path(), &["run", "fleet.composite", "--virtual", "--for", "1s"]);
    assert_eq!(code(&refused), 2, "{}", text(&refused));
    assert!(stderr(&refused).contains("S3016") && stderr(&refused).contains("work.py"), "{}", text(&refused));
    assert!(!folder.path().join("ran").exists());
    let run = run(folder.path(), &["--virtual", "--for", "1s"]);
    assert!(run.status.success() && folder.path().join("ran").exists(), "{}", text(&run));
}

#[test]
fn faults_of_the_code_are_told_with_their_place_and_what_was_meant() {
    if !is_there() {
        return;
    }
    let component =
        |body: &str| format!("import saoms\nfrom saoms import uint32\nclass Worker(saoms.Component):\n{body}");
    for (module, expected) in [
        (component("    step: uint23 = 1\n"), "work.py:4:11: `step` has the type `uint23`"),
        (component("    step: uint23 = 1\n"), "did you mean `uint32`?"),
        (component("    step: uint32 = len('')\n"), "work.py:4:20: expected a literal"),
        (component("    def execute(self)\n"), "work.py:4:"),
        (
            component("    count: saoms.Publisher[uint32] = saoms.state('C')\n"),
            "expected a class with `@saoms.message`",
        ),
        ("class Wroker: ...\n".to_owned(), "has no class `Worker`"),
        ("class Wroker: ...\n".to_owned(), "replace `Worker` with `Wroker`"),
        ("class Worker: ...\n".to_owned(), "the class `Worker` is no component"),
    ] {
        let folder = folder(&module);
        let check = saoms_in(folder.path(), &["check", "fleet.composite"]);
        let told = text(&check);
        assert_eq!(code(&check), 2, "{told}");
        assert!(told.contains("S3015") && told.contains("fleet.composite:2:"), "{told}");
        assert!(told.contains(expected), "{expected}:\n{told}");
    }
}

#[test]
fn an_exception_is_a_failure_with_its_place_and_a_traceback() {
    if !is_there() {
        return;
    }
    let folder = folder(
        "import saoms
def helper():
    raise ValueError('found 13,\\nexpected 14')
class Worker(saoms.Component):
    step: int = 1
    def execute(self):
        helper()
",
    );
    let run = run(folder.path(), &["--virtual", "--for", "1s"]);
    let told = text(&run);
    assert_eq!(code(&run), 1, "{told}");
    let place = folder.path().canonicalize().unwrap().join("work.py").display().to_string();
    assert!(told.contains(&format!("ValueError: found 13, expected 14 ({place}:3, in helper)")), "{told}");
    assert!(told.contains("line 7, in execute"), "{told}");
}

#[test]
fn one_that_never_releases_the_lock_hinders_components_in_python_alone() {
    if !is_there() {
        return;
    }
    let folder = folder(
        "import ctypes
import saoms
class Worker(saoms.Component):
    def execute(self):
        ctypes.PyDLL(None).sleep(1000)
",
    );
    let path = folder.path().join("fleet.composite");
    let other = r#"<component name="Other"><implementation.rust class="saoms.World"/>
<property name="ID" value="Other"/><property name="period" value="10ms"/></component></composite>"#;
    let composite = fs::read_to_string(&path).unwrap().replace("</composite>", other);
    fs::write(&path, composite).unwrap();
    let run = run(folder.path(), &["--for", "500ms", "--grace", "100ms", "--report", "-", "--quiet"]);
    assert_eq!(code(&run), 1, "{}", text(&run));
    let report: Value = serde_json::from_slice(&run.stdout).unwrap();
    let executions = |name: &str| {
        let all = report["components"].as_array().unwrap();
        all.iter().find(|one| one["name"] == name).unwrap()["executions"].as_u64().unwrap()
    };
    assert_eq!(executions("A"), 1, "{report:#}");
    assert!(executions("Other") > 5, "{report:#}");
    assert!(stderr(&run).contains("`A`"), "{}", text(&run));
}
