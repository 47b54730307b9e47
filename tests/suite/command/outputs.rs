//! Files that commands write: never over what they read, never over each other, never half.

use std::fs::{self, File, Permissions};
use std::os::unix::fs::{FileTypeExt, MetadataExt, PermissionsExt, symlink};
use std::path::Path;
use std::process::{Output, Stdio};
use std::thread;

use serde_json::Value;
use tempfile::TempDir;

use crate::plugins::library;
use crate::support::{answer, code, command, saoms_in, stderr, stdout};

const SITE: &str = r#"<composite xmlns="http://docs.oasis-open.org/ns/opencsa/sca/200912" xmlns:saoms="urn:saoms:1" xmlns:s="urn:site" name="site" targetNamespace="urn:site">
  <include name="s:yard"/>
  <component name="Environment">
    <implementation.rust class="saoms.Environment"/>
    <property name="ID">Environment</property>
    <property name="period">100</property>
    <property name="scenario" file="south.scenario"/>
  </component>
  <component name="Robot${index}" saoms:count="2" saoms:overrides="robots.csv">
    <implementation.rust class="saoms.Robot"/>
    <property name="ID">Robot${index}</property>
    <property name="period">100</property>
    <property name="chargeY">${index}</property>
    <reference name="world" target="World"/>
  </component>
</composite>
"#;

const YARD: &str = r#"<composite xmlns="http://docs.oasis-open.org/ns/opencsa/sca/200912" name="yard" targetNamespace="urn:site">
  <component name="World">
    <implementation.rust class="saoms.World"/>
    <property name="ID">World</property>
    <property name="period">100</property>
  </component>
  <component name="Master">
    <implementation.rust class="saoms.MasterEnvironment"/>
    <property name="ID">Master</property>
    <property name="period">100</property>
  </component>
</composite>
"#;

/// A fleet in several files, with a plugin beside it.
struct Site(TempDir);

impl Site {
    fn new() -> Site {
        let site = Site(tempfile::tempdir().unwrap());
        site.put("site.composite", SITE);
        site.put("yard.composite", YARD);
        site.put("south.scenario", "at 1s luggage (3,1) to (3,10)\n");
        site.put("robots.csv", "index,battery\n1,90\n");
        site.put("later.events", "at 2s luggage (4,1) to (4,10)\n");
        fs::copy(library("saoms_hello"), site.path().join("libhello.so")).unwrap();
        site
    }

    fn path(&self) -> &Path {
        self.0.path()
    }

    fn put(&self, name: &str, text: &str) {
        fs::write(self.path().join(name), text).unwrap();
    }

    fn text(&self, name: &str) -> String {
        fs::read_to_string(self.path().join(name)).unwrap()
    }

    /// The names of all files, sorted.
    fn names(&self) -> Vec<String> {
        let entries = fs::read_dir(self.path()).unwrap();
        let mut names: Vec<String> = entries.map(|one| one.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    /// Runs the fleet for a second.
    fn run(&self, arguments: &[&str]) -> Output {
        let run = ["run", "site.composite", "--virtual", "--for", "1s", "--quiet", "--events", "later.events"];
        saoms_in(self.path(), &[&run, arguments].concat())
    }
}

#[test]
fn what_a_run_reads_is_no_output_by_whatever_path() {
    let site = Site::new();
    let run = site.run(&["--report", "report.json", "--journal", "journal", "--paths", "paths.svg"]);
    assert_eq!(answer(&run), (0, String::new(), String::new()));
    symlink("robots.csv", site.path().join("link.csv")).unwrap();
    fs::hard_link(site.path().join("south.scenario"), site.path().join("twin.scenario")).unwrap();
    let read = ["site.composite", "yard.composite", "south.scenario", "robots.csv", "later.events", "libhello.so"];
    let before = read.map(|name| fs::read(site.path().join(name)).unwrap());
    for option in ["--report", "--paths", "--journal"] {
        for name in read {
            let (code, out, error) = answer(&site.run(&[option, name]));
            assert_eq!((code, out.as_str()), (2, ""), "{option} {name}");
            assert!(error.contains(&format!("cannot be written to `{name}`")), "{error}");
            assert!(error.contains("input") && error.contains(&format!("give `{option}` another file")), "{error}");
            assert!(error.ends_with("\n1 error: nothing was started\n"), "{error}");
        }
        for (other, name) in
            [("link.csv", "robots.csv"), ("twin.scenario", "south.scenario"), ("./robots.csv", "robots.csv")]
        {
            let error = stderr(&site.run(&[option, other]));
            assert!(error.contains(&format!("to `{other}`: it is `{name}`, which is an input")), "{error}");
        }
    }
    assert_eq!(read.map(|name| fs::read(site.path().join(name)).unwrap()), before);
    let input = File::open(site.path().join("yard.composite")).unwrap();
    let mut run = command(&["run", "-", "--virtual", "--for", "1s", "--report", "yard.composite"]);
    let output = run.current_dir(site.path()).stdin(input).output().unwrap();
    assert_eq!(code(&output), 2);
    assert!(stderr(&output).contains("it is read from standard input"), "{}", stderr(&output));
    assert_eq!(site.text("yard.composite"), YARD);
}

/// The file, opened as a shell does for `>>`.
fn appended(site: &Site, name: &str) -> File {
    File::options().append(true).open(site.path().join(name)).unwrap()
}

#[test]
fn standard_output_is_no_file_that_is_read() {
    let site = Site::new();
    assert_eq!(code(&site.run(&["--journal", "journal"])), 0);
    symlink("robots.csv", site.path().join("link.csv")).unwrap();
    let cases: [(&[&str], &str); 11] = [
        (&["expand", "site.composite"], "site.composite"),
        (&["check", "site.composite"], "south.scenario"),
        (&["check", "site.composite", "--format", "json"], "link.csv"),
        (&["check", ".", "--format", "sarif"], "yard.composite"),
        (&["check", "site.composite"], "libhello.so"),
        (&["graph", "site.composite"], "robots.csv"),
        (&["run", "site.composite", "--virtual", "--for", "1s"], "robots.csv"),
        (&["run", "site.composite", "--virtual", "--for", "1s", "--events", "later.events"], "later.events"),
        (&["why", "Robot1", "--report", "journal"], "journal"),
        (&["report", "--from-journal", "journal"], "journal"),
        (&["fmt", "--check", "site.composite"], "site.composite"),
    ];
    for (arguments, name) in cases {
        let before = fs::read(site.path().join(name)).unwrap();
        let run = |arguments| {
            let mut run = command(arguments);
            run.current_dir(site.path());
            run
        };
        let output = run(arguments).stdout(appended(&site, name)).output().unwrap();
        let told = stderr(&output);
        let read = if name == "link.csv" { "robots.csv" } else { name };
        assert_eq!(code(&output), 2, "{arguments:?}");
        assert!(told.starts_with("error: standard output is `") && told.contains(read), "{arguments:?}: {told}");
        assert!(told.ends_with("`, which is an input\n  = help: send standard output to another file\n"), "{told}");
        let output = run(arguments).stderr(appended(&site, name)).output().unwrap();
        let told = stdout(&output);
        assert_eq!(code(&output), 2, "{arguments:?}");
        assert!(told.starts_with("error: standard error is `"), "{arguments:?}: {told}");
        let output = run(arguments).stdout(appended(&site, name)).stderr(appended(&site, name)).output().unwrap();
        assert_eq!(code(&output), 2, "nobody can be told");
        assert_eq!(fs::read(site.path().join(name)).unwrap(), before, "{arguments:?}");
    }
    let mut fmt = command(&["fmt", "-"]);
    fmt.current_dir(site.path()).stdin(File::open(site.path().join("site.composite")).unwrap());
    let output = fmt.stdout(appended(&site, "site.composite")).output().unwrap();
    assert_eq!(code(&output), 2);
    assert!(stderr(&output).contains("is the file that standard input reads"), "{}", stderr(&output));
    assert_eq!(site.text("site.composite"), SITE);
}

#[test]
fn two_outputs_are_two_files() {
    let site = Site::new();
    symlink("report.json", site.path().join("link")).unwrap();
    let folder = site.path().file_name().unwrap().to_str().unwrap();
    for other in ["report.json", "./report.json", "link", &format!("../{folder}/report.json")] {
        let (code, _, error) = answer(&site.run(&["--report", "report.json", "--journal", other]));
        assert_eq!(code, 2, "{other}");
        assert!(error.contains(&format!("the report and the journal cannot both be written to `{other}`")), "{error}");
    }
    assert!(!site.path().join("report.json").exists(), "nothing was started");
    let log = File::create(site.path().join("log")).unwrap();
    let mut run = command(&["run", "site.composite", "--virtual", "--for", "1s", "--report", "log"]);
    let output = run.current_dir(site.path()).stdout(log).output().unwrap();
    let shared = "error: standard output and the report cannot both be written to `log`";
    assert!(code(&output) == 2 && stderr(&output).contains(shared), "{}", stderr(&output));
    assert_eq!(code(&site.run(&["--report", "/dev/null", "--journal", "/dev/null"])), 0, "nobody reads it");
}

#[test]
fn a_picture_is_drawn_over_no_file_of_the_fleet() {
    let site = Site::new();
    for name in ["site.composite", "yard.composite", "robots.csv", "libhello.so"] {
        let before = fs::read(site.path().join(name)).unwrap();
        let output = saoms_in(site.path(), &["graph", "site.composite", "-o", name, "--format", "dot"]);
        assert_eq!(code(&output), 2, "{name}");
        assert!(stderr(&output).contains("which is an input"), "{}", stderr(&output));
        assert_eq!(fs::read(site.path().join(name)).unwrap(), before);
    }
}

#[test]
fn schemas_are_written_over_no_plugin() {
    let site = Site::new();
    fs::create_dir(site.path().join("schemas")).unwrap();
    symlink("../libhello.so", site.path().join("schemas/catalog.xml")).unwrap();
    let before = fs::read(site.path().join("libhello.so")).unwrap();
    let output = saoms_in(site.path(), &["schema", "-o", "schemas", "--plugin", "libhello.so"]);
    assert_eq!(code(&output), 2);
    assert!(stderr(&output).contains("`libhello.so`, which is an input"), "{}", stderr(&output));
    assert_eq!(fs::read(site.path().join("libhello.so")).unwrap(), before);
    assert_eq!(fs::read_dir(site.path().join("schemas")).unwrap().count(), 1, "nothing was written");
}

#[test]
fn new_follows_no_link_out_of_its_folder() {
    let site = Site::new();
    symlink("elsewhere.composite", site.path().join("fresh.composite")).unwrap();
    let output = saoms_in(site.path(), &["new", "composite", "fresh"]);
    assert_eq!(code(&output), 2);
    assert!(!site.path().join("elsewhere.composite").exists());
}

#[test]
fn files_are_replaced_whole_with_their_mode_and_behind_their_links() {
    let site = Site::new();
    site.put("report.json", "of an earlier run");
    let path = site.path().join("report.json");
    fs::set_permissions(&path, Permissions::from_mode(0o604)).unwrap();
    symlink("report.json", site.path().join("link")).unwrap();
    let earlier = fs::metadata(&path).unwrap().ino();
    let names = site.names();
    assert_eq!(code(&site.run(&["--report", "link"])), 0);
    assert_eq!(site.names(), names, "nothing else is left");
    assert!(fs::symlink_metadata(site.path().join("link")).unwrap().is_symlink());
    let about = fs::metadata(&path).unwrap();
    assert_eq!(about.permissions().mode() & 0o777, 0o604);
    assert_ne!(about.ino(), earlier, "whoever has the earlier one open keeps it whole");
    let report: Value = serde_json::from_str(&site.text("report.json")).unwrap();
    assert_eq!(report["outcome"]["status"], "elapsed");
    for name in ["site.svg", "site.dot"] {
        symlink(format!("of-{name}"), site.path().join(name)).unwrap();
        assert_eq!(code(&saoms_in(site.path(), &["graph", "site.composite", "-o", name])), 0);
        assert!(!site.text(&format!("of-{name}")).is_empty());
    }
}

/// The end of a pipe that somebody reads, as a shell makes it for `--report >(program)`.
#[test]
fn pipes_and_descriptors_are_written_in_place() {
    let site = Site::new();
    for (name, option) in [("report.pipe", "--report"), ("journal.pipe", "--journal")] {
        let pipe = site.path().join(name);
        let made = std::process::Command::new("mkfifo").arg(&pipe).status().unwrap();
        assert!(made.success());
        let reader = thread::spawn({
            let pipe = pipe.clone();
            move || fs::read_to_string(pipe).unwrap()
        });
        assert_eq!(answer(&site.run(&[option, name])), (0, String::new(), String::new()));
        let read = reader.join().unwrap();
        assert!(read.starts_with('{') && read.ends_with("}\n"), "{read}");
        assert!(fs::metadata(&pipe).unwrap().file_type().is_fifo());
    }
    site.put("log", "before\n");
    let log = File::options().append(true).open(site.path().join("log")).unwrap();
    let run = ["run", "site.composite", "--virtual", "--for", "1s", "--report", "/dev/stdout"];
    let run = command(&run).current_dir(site.path()).stdout(log).stderr(Stdio::piped()).output().unwrap();
    assert_eq!(run.status.code(), Some(0));
    assert!(stderr(&run).contains("time limit reached after 1.000 s"), "{}", stderr(&run));
    let text = site.text("log");
    assert!(text.starts_with("before\n{\n") && text.ends_with("}\n"), "{text}");
    let errors = command(&["run", "site.composite", "--virtual", "--for", "1s", "--journal", "/dev/stderr"])
        .current_dir(site.path())
        .stdout(Stdio::null())
        .output()
        .unwrap();
    assert!(stderr(&errors).lines().last().unwrap().starts_with("{\"end\""), "{}", stderr(&errors));
}
