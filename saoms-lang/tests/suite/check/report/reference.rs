//! `docs/diagnostics.md`: every diagnostic with an example, generated from the table of codes and the files in
//! `../examples/`, each of which has that one fault.
//!
//! `UPDATE_EXPECT=1 cargo test -p saoms-lang --test suite reference` writes the page anew.

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use expect_test::expect_file;
use saoms_api::Failure;
use saoms_api::host::{DynComponent, PropertyValue, SmolStr};
use saoms_core::plugin::Search;
use saoms_lang::diagnostic::{Code, Diagnostic, Diagnostics, codes};
use saoms_lang::load::MAX_SIZE;
use saoms_lang::project::{ClassPath, Classes, Compilation, Project, read};
use saoms_lang::registry::{Provider, Registry};
use saoms_lang::source::Sources;
use saoms_tools::diagnostics::human;

use crate::check::classes::registry;

const HEAD: &str = "\
# Diagnostics

These are the diagnostics of `saoms check` and `saoms run`. The meaning of a code never changes. With an error, nothing
starts; a warning stops nothing. If the SCA Assembly specification has the same rule, its name follows the code.

`--format json` prints diagnostics as data: an object each, with `severity`, `code`, `rule`, `message`, `help`, place
(`file`, `line`, `column`, `end_line`, `end_column`; ends exclusive), `labels` (other places) and `suggestions`, whose
`edits` mend it. Where five or more in a file say the same, such as ten uses of a property that is not there, the text
shows the first with the lines of the others. The data have each, since each place is mended by itself: all but the
first have `like`, the index of the first, so that a program counts the mistake once.

| codes | about |
| --- | --- |
| `S00` | files |
| `S01` | XML |
| `S10` | the vocabulary of SCA |
| `S20` | names, composite properties, services, references and wires |
| `S30` | classes and properties |
| `S40` | tasks and topics |
| `S45` | the loops of components |
| `S50` | the fleet as a whole, by rules of crates of components |

The table of codes is `saoms-lang/src/diagnostic/codes.rs`. The examples are the files in `saoms-lang/tests/suite/check/examples`;
the classes that they name are those of the tests beside them. The rules of `S50` are in `saoms-components/src/rules`, their examples in
`tests/rules`. This page is generated from all of these.
";

#[test]
fn every_diagnostic_is_documented_with_an_example() {
    let mut page = HEAD.to_owned();
    let mut faults = String::new();
    for code in codes::ALL {
        let severity = code.severity.name();
        let rule = code.rule.map_or_else(String::new, |rule| format!(", {rule}"));
        let _ = write!(page, "\n## {} {}\n\n*{severity}{rule}.* {}\n\n", code.id, code.name, code.meaning);
        match example(code) {
            Ok(example) => _ = write!(page, "```text\n{example}```\n"),
            Err(fault) => faults += &fault,
        }
    }
    assert!(faults.is_empty(), "{faults}");
    // What follows is of crates of components, which the core does not know: `tests/suite/check/rules.rs` writes it.
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/diagnostics.md");
    let present = fs::read_to_string(path).unwrap_or_default();
    if let Some(rules) = present.find("\n## S5") {
        page += &present[rules..];
    }
    expect_file!["../../../../../docs/diagnostics.md"].assert_eq(&page);
}

#[test]
fn codes_and_names_are_unique_and_meanings_are_sentences() {
    let mut ids: Vec<_> = codes::ALL.iter().map(|code| code.id).collect();
    assert!(ids.is_sorted(), "the table is in the order of the codes");
    ids.dedup();
    assert_eq!(ids.len(), codes::ALL.len());
    let mut names: Vec<_> = codes::ALL.iter().map(|code| code.name).collect();
    names.sort_unstable();
    names.dedup();
    assert_eq!(names.len(), codes::ALL.len());
    for code in codes::ALL {
        assert!(code.meaning.ends_with('.'), "{}", code.id);
        assert!(code.id.len() == 5 && code.id.starts_with('S'), "{}", code.id);
    }
}

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/suite/check/examples")
}

/// The diagnostics of the example of a code, as people see them; an error when it has not that fault alone.
fn example(code: &Code) -> Result<String, String> {
    let (diagnostics, sources) = match code.id {
        "S0001" | "S0002" | "S0003" | "S0004" | "S0005" | "S0006" | "S0007" => unreadable(code.id),
        "S0008" => {
            let components = "<component name=\"Gps\"><implementation.java class=\"example.Gsp\"/></component>\n";
            let text = crate::check::support::fleet(&components.repeat(1500));
            checked(&[("fleet.composite".to_owned(), text)], 1, &[])
        }
        "S0009" => {
            let folder = tempfile::tempdir().unwrap();
            fs::create_dir(folder.path().join("fleet")).unwrap();
            fs::write(folder.path().join("secret.txt"), "secret").unwrap();
            let text = fs::read_to_string(self::folder().join("S3007.composite")).unwrap();
            let text = text.replace("\"speed\">fast</property>", "\"speed\" file=\"../secret.txt\"/>");
            let path = folder.path().join("fleet/fleet.composite");
            fs::write(&path, text).unwrap();
            let found = Project::new().file(path).compile(&registry());
            without_folder(found.diagnostics, &found.sources, folder.path())
        }
        "S2064" => {
            let text = fs::read_to_string(folder().join("S2064.composite")).unwrap();
            compiled(&Project::new().in_memory().text("fleet.composite", text).node(Some("gate_a".to_owned())))
        }
        "S3016" => {
            let mut registry = Registry::new();
            let declaration = r#"{"contract": 1, "class": "example.Gps", "kind": "passive"}"#;
            registry.add_provided(declaration, Arc::new(Unnamed)).unwrap();
            let text = fs::read_to_string(folder().join("S3001.composite")).unwrap();
            let found = Project::new().in_memory().text("fleet.composite", text.replace("example.Gsp", "example.Gps"));
            let found = found.to_start().compile(&registry);
            (found.diagnostics, found.sources)
        }
        "S4028" => {
            let text = fs::read_to_string(folder().join("S4028.composite")).unwrap();
            let found = Project::new().in_memory().text("fleet.composite", text).compile(&registry());
            let place = found.output.unwrap().places.get("Robot001", "passwordFile").unwrap();
            let message = "component `Robot001`, property `passwordFile`: other users can read or change `robots.password`: \
                restrict it with `chmod 600`";
            let one = Diagnostic::new(&codes::NETWORK_FILE, place, message)
                .help("docs/security.md says how a network is protected");
            (vec![one], found.sources)
        }
        "S4031" => {
            let text = fs::read_to_string(folder().join("S4031.composite")).unwrap();
            let found = Project::new().in_memory().text("fleet.composite", text).compile(&registry());
            let place = found.output.unwrap().places.get("Robot001", "url").unwrap();
            let message = "component `Robot001` is on the network `mqtt://localhost:1883`, but there is no transport for urls \
                with `mqtt://`; those that were found serve `host:port`, `tls://`";
            let one = Diagnostic::new(&codes::NO_TRANSPORT, place, message)
                .help("docs/networks.md says where the libraries of transports are looked for");
            (vec![one], found.sources)
        }
        "S2072" => {
            let text = fs::read_to_string(folder().join("S2072.composite")).unwrap();
            let found = Project::new().in_memory().text("fleet.composite", text).compile(&registry());
            let place = found.output.unwrap().components[0].web[0].place;
            let message = "the services that are offered over the web are not served: this run has no control server";
            let one = Diagnostic::new(&codes::WEB_UNSERVED, place, message);
            (vec![one.help("serve them: `--serve 127.0.0.1:8080`")], found.sources)
        }
        "S2073" => {
            let text = fs::read_to_string(folder().join("S2073.composite")).unwrap();
            let found = Project::new().in_memory().text("fleet.composite", text);
            let found = found.compile(&crate::check::classes::with_surveyor());
            let place = found.output.unwrap().components[0].references[0].web[0].place;
            let message = "references lead to the web, to `http://127.0.0.1:8080`: `--allow-web` is missing";
            let one = Diagnostic::new(&codes::WEB_NOT_ALLOWED, place, message).help(
                "allow it with `--allow-web`, if you trust the composite: it decides where requests and tokens of the \
                 environment go",
            );
            (vec![one], found.sources)
        }
        "S2035" => {
            let level = |level: u32| {
                let inner = format!("<implementation.composite name=\"t:hall{}\"/>", level - 1);
                let one = |name| format!("    <component name=\"{name}\">{inner}</component>\n");
                (
                    format!("hall{level}.composite"),
                    crate::check::support::part(&format!("hall{level}"), "", &(one("a") + &one("b"))),
                )
            };
            let gps = "    <component name=\"Gps\"><implementation.java class=\"example.Gps\"/></component>";
            let mut files: Vec<_> = (1..=20).rev().map(level).collect();
            files.push(("hall0.composite".to_owned(), crate::check::support::part("hall0", "", gps)));
            checked(&files, 1, &[])
        }
        id @ ("S2043" | "S2044" | "S2047" | "S2052" | "S2053" | "S2054" | "S2055" | "S2056" | "S2060") => {
            from_folder(id)
        }
        id @ ("S2051" | "S2057" | "S2058" | "S2059") => contribution(id),
        id => from_files(id),
    };
    let found: Vec<Diagnostic> = diagnostics.iter().filter(|one| one.code == code).cloned().collect();
    let others = if code.id == "S0008" { 0 } else { diagnostics.len() - found.len() };
    if found.is_empty() || others > 0 {
        let all: String = diagnostics.iter().map(|one| crate::check::support::shown(one, &sources)).collect();
        return Err(format!("the example of {} has to have this fault alone, and has\n{all}", code.id));
    }
    let says_what_to_do = !found[0].help.is_empty() || !found[0].suggestions.is_empty();
    assert!(says_what_to_do || code.id < "S2", "{} does not say what to do", code.id);
    Ok(human(&found[..1], &sources, false))
}

/// Checks `ID.composite`, and `ID.more.composite` with it, with the lines of `ID.set` as settings, where there are any.
/// They can name what is in `ID.inner.composite`.
fn from_files(id: &str) -> (Vec<Diagnostic>, Sources) {
    let read = |name: String| fs::read_to_string(folder().join(&name)).ok().map(|text| (name, text));
    let names = [format!("{id}.composite"), format!("{id}.more.composite")];
    let mut files: Vec<_> = names.into_iter().filter_map(read).collect();
    let asked_for = files.len();
    files.extend(read(format!("{id}.inner.composite")));
    assert!(!files.is_empty(), "there is no example of {id}");
    let settings = fs::read_to_string(folder().join(format!("{id}.set"))).unwrap_or_default();
    checked_with(&files, asked_for, &settings.lines().collect::<Vec<_>>(), codes::is_of_wiring(id))
}

/// Checks `ID.composite` in its folder, where there are component types, with unknown classes taken as given.
fn from_folder(id: &str) -> (Vec<Diagnostic>, Sources) {
    let project = Project::new().file(folder().join(format!("{id}.composite"))).assume_classes(true);
    let (diagnostics, sources) = compiled(&project);
    (diagnostics, by_file_name(&sources))
}

/// Looks at the folder of a contribution.
fn contribution(id: &str) -> (Vec<Diagnostic>, Sources) {
    let project = Project::new().file(folder().join(id));
    let (diagnostics, sources) = project.check_folders(&mut project.finder());
    (diagnostics, by_file_name(&sources))
}

/// The classes of these tests, and libraries beside composites.
struct WithLibraries;

impl ClassPath for WithLibraries {
    fn classes(&self, _: &[PathBuf]) -> Classes {
        Search::default().classes(registry())
    }
}

fn compiled(project: &Project) -> (Vec<Diagnostic>, Sources) {
    let Compilation { mut diagnostics, sources, .. } = project.compile(&WithLibraries);
    diagnostics.retain(|one| !one.is_allowed());
    (diagnostics, sources)
}

fn by_file_name(sources: &Sources) -> Sources {
    let mut renamed = Sources::new();
    for (_, file) in sources.iter() {
        renamed.add(Path::new(file.path()).file_name().unwrap().to_string_lossy(), file.text().as_str());
    }
    renamed
}

fn checked(files: &[(String, String)], asked_for: usize, settings: &[&str]) -> (Vec<Diagnostic>, Sources) {
    checked_with(files, asked_for, settings, false)
}

fn checked_with(
    files: &[(String, String)],
    asked_for: usize,
    settings: &[&str],
    wiring: bool,
) -> (Vec<Diagnostic>, Sources) {
    let project = Project::new().in_memory().set_all(settings.iter().copied()).wiring(wiring);
    let (fleet, others) = files.split_at(asked_for);
    let project = fleet.iter().fold(project, |project, (name, text)| project.text(name, text));
    compiled(&others.iter().fold(project, |project, (name, text)| project.other_text(name, text)))
}

/// Reads a file that cannot be read, by the step of a project that reads: some of these paths would be folders to it.
fn unreadable(id: &str) -> (Vec<Diagnostic>, Sources) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("fleet.composite");
    let mut limit = MAX_SIZE;
    let path = match id {
        "S0001" => {
            fs::write(path, " ").unwrap();
            folder.path().join("flet.composite")
        }
        "S0002" => {
            fs::write(path, " ").unwrap();
            folder.path().to_owned()
        }
        // There is no memory at address 0.
        "S0003" => PathBuf::from("/proc/self/mem"),
        "S0004" => {
            limit = 100;
            fs::write(&path, "x".repeat(101)).unwrap();
            path
        }
        "S0005" => {
            fs::write(&path, "\n").unwrap();
            path
        }
        "S0006" => {
            fs::write(&path, b"\x7fELF\x02\x01\x01\0\0\0\0\0").unwrap();
            path
        }
        _ => {
            fs::write(&path, b"<composite name=\"Caf\xe9\"/>").unwrap();
            path
        }
    };
    let (mut sources, mut diagnostics) = (Sources::new(), Diagnostics::new());
    assert!(read(&path, limit, &mut sources, &mut diagnostics).is_none());
    without_folder(diagnostics.into_sorted(), &sources, folder.path())
}

/// The same diagnostics with paths from this folder: the page must not depend on where temporary files are.
fn without_folder(mut diagnostics: Vec<Diagnostic>, sources: &Sources, folder: &Path) -> (Vec<Diagnostic>, Sources) {
    let here = folder.display().to_string();
    let shown = |text: &str| text.replace(&format!("{here}/"), "").replace(&here, "fleets");
    let mut renamed = Sources::new();
    for (_, file) in sources.iter() {
        renamed.add(shown(file.path()), file.text().as_str());
    }
    for one in &mut diagnostics {
        one.message = shown(&one.message);
        one.help = one.help.iter().map(|help| shown(help)).collect();
    }
    (diagnostics, renamed)
}

/// The source of a class whose library was found, and not named.
#[derive(Debug)]
struct Unnamed;

impl Provider for Unnamed {
    fn construct(&self, _: &[(SmolStr, PropertyValue)]) -> Result<Box<dyn DynComponent>, Failure> {
        Err("its code must not run".into())
    }

    fn origin(&self) -> Option<&Path> {
        Some(Path::new("fleets/libgps.so"))
    }

    fn is_only_read(&self) -> bool {
        true
    }
}
