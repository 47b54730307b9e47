//! Folders as contributions.

use std::fmt::Write as _;
use std::fs;

use expect_test::expect;
use saoms_lang::contribution::{Finder, composites_below};
use saoms_lang::diagnostic::Diagnostics;
use saoms_lang::load::MAX_SIZE;
use saoms_lang::source::{OpenTexts, Sources};

use crate::load::imports::description;
use crate::load::named::composite;
use crate::load::support::{loaded_folder, shown, written};

/// The fleets in a folder of these files, and what is wrong with it.
fn fleets(files: &[(&str, String)]) -> String {
    let folder = written(files);
    let (fleets, sources, diagnostics) = loaded_folder(folder.path());
    let mut out = String::new();
    for fleet in fleets {
        let files: Vec<String> = fleet.files.iter().map(|path| path.display().to_string()).collect();
        let _ = writeln!(out, "{}{}", files.join(" + "), if fleet.is_deployable { " runs" } else { "" });
    }
    out.push_str(&shown(folder.path(), &sources, diagnostics));
    out.replace(&format!("{}/", folder.path().display()), "")
}

fn deployables(names: &[&str]) -> String {
    let all: String = names.iter().map(|name| format!("<deployable composite='{name}'/>")).collect();
    format!(
        "<contribution xmlns='http://docs.oasis-open.org/ns/opencsa/sca/200912' xmlns:a='urn:a'>\n{all}</contribution>"
    )
}

#[test]
fn what_is_deployable_runs_and_what_nobody_names_is_a_fleet_of_its_own() {
    let mut files = vec![
        ("fleet.composite", composite("urn:a", "fleet", "<include name='a:hall'/>")),
        ("deep/er/hall.composite", composite("urn:a", "hall", "<include name='a:door'/>")),
        ("deep/door.composite", composite("urn:a", "door", "")),
        ("other.composite", composite("urn:a", "other", "")),
        ("broken.composite", "<composite".to_owned()),
        ("target/made.composite", composite("urn:a", "made", "")),
        ("round.composite", composite("urn:a", "round", "<include name='a:about'/>")),
        ("about.composite", composite("urn:a", "about", "<include name='a:round'/>")),
    ];
    expect![[r#"
        about.composite
        broken.composite
        fleet.composite
        other.composite
    "#]]
    .assert_eq(&fleets(&files));
    files.push(("META-INF/sca-contribution.xml", deployables(&["a:fleet", "other", "u:fleet"])));
    files.push(("lib/sca-contribution.xml", deployables(&["a:fleet"])));
    files.push(("lib/fleet.composite", composite("urn:a", "fleet", "")));
    expect![[r#"
        fleet.composite + other.composite runs
        about.composite
        broken.composite
        lib/fleet.composite runs
        META-INF/sca-contribution.xml:2:57 [other] warning S1011 `other` has no namespace
          write it with a prefix of the composite's target namespace
        META-INF/sca-contribution.xml:2:88 [u:fleet] warning S1011 the prefix `u` is not declared
          write it with a prefix of the composite's target namespace
    "#]]
    .assert_eq(&fleets(&files));
}

#[test]
fn what_is_wrong_with_a_contribution_is_told() {
    let one = |inside: &str| {
        fleets(&[
            ("sca-contribution.xml", description(inside)),
            ("fleet.composite", composite("urn:a", "fleet", "")),
            ("more.composite", composite("urn:b", "hall", "")),
        ])
    };
    expect![[r#"
        fleet.composite runs
        more.composite
        sca-contribution.xml:2:24 [x:flet] error S2051 the contribution has no composite `x:flet`
          replace `x:flet` with `x:fleet`
        sca-contribution.xml:3:24 [x:hall] error S2051 the contribution has no composite `x:hall`
          it has `hall` in the namespace `urn:b`
        sca-contribution.xml:4:24 [x:hall] error S2051 the contribution has no composite `x:hall`
          it has `hall` in the namespace `urn:b`
          replace `urn:c` with `urn:b`
        sca-contribution.xml:5:2 [deployable] error S1008 `deployable` needs the attribute `composite`
          add `composite="..."` to it
        sca-contribution.xml:6:13 [composit] error S1007 `deployable` has no attribute `composit`
          replace `composit` with `composite`
        sca-contribution.xml:6:23 [fleet] warning S1011 `fleet` has no namespace
          write it with a prefix of the composite's target namespace
        sca-contribution.xml:8:27 [locaton] error S1007 `export` has no attribute `locaton`
          `export` has the attributes `namespace`
        sca-contribution.xml:9:2 [imports] error S1004 SCA 1.1 has no element `imports`
          replace `imports` with `import`
        sca-contribution.xml:10:1 [text] error S1012 unexpected text in `contribution`: it contains elements only
          remove it, or write a comment between `<!--` and `-->`
        sca-contribution.xml:10:6 [import.resource] error S1008 `import.resource` needs the attribute `uri`
          add `uri="..."` to it
        sca-contribution.xml:11:43 [component] error S1005 `component` is not allowed in `contribution`
          `contribution` can contain `deployable`, `import`, `import.java`, `import.resource`, `import.c`, `import.cpp`, `export`, `export.java`, `export.resource`, `export.c`, `export.cpp`, `documentation`, `extensions`
    "#]].assert_eq(&one(
        "\n<deployable composite='x:flet' xmlns:x='urn:a'/>\n<deployable composite='x:hall' xmlns:x='urn:a'/>\n<deployable composite='x:hall' xmlns:x='urn:c'/>\n<deployable/>\n<deployable composit='fleet'/>\n<import namespace=''/>\n<export namespace='urn:a' locaton='x'/>\n<imports/>\ntext<import.resource/>\n<import.sdo x='1'/><x:y xmlns:x='urn:x'/><component/>",
    ));
    expect![[r#"
        fleet.composite
        sca-contribution.xml:1:2 [contribution] error S1001 `contribution` is in the namespace `urn:c`, expected one of SCA
          a file of this name describes what a contribution runs, imports and exports
          that is `http://docs.oasis-open.org/ns/opencsa/sca/200912` (SCA 1.1), `http://docs.oasis-open.org/ns/opencsa/sca/200903` (SCA 1.1 (draft)) or `http://www.osoa.org/xmlns/sca/1.0` (SCA 1.0)
        a/sca-contribution.xml:2:4 [</b>] error S0102 `</b>` found where `</a>` is expected
          replace it with `</a>`
    "#]].assert_eq(&fleets(&[
        ("sca-contribution.xml", "<contribution xmlns='urn:c'/>".to_owned()),
        ("a/sca-contribution.xml", "<contribution>\n<a></b></contribution>".to_owned()),
        ("fleet.composite", composite("urn:a", "fleet", "")),
    ]));
    // Real ones have this, as composites do.
    let with_namespace = description("").replace("<contribution", "<contribution targetNamespace='urn:a'");
    assert_eq!(
        fleets(&[("sca-contribution.xml", with_namespace), ("fleet.composite", composite("urn:a", "fleet", ""))]),
        "fleet.composite\n"
    );
    expect![[r#"
        FOLDER:1:1 [] error S0002 the folder contains no composites
          the names of composites end with `.composite`
    "#]]
    .assert_eq(&fleets(&[("deep/readme.txt", String::new())]));
}

#[test]
fn composites_of_one_name_are_told_as_far_as_the_folder_is_one_contribution() {
    let mut files = vec![
        ("fleet.composite", composite("urn:a", "fleet", "<include name='a:hall'/>")),
        ("one/hall.composite", composite("urn:a", "hall", "")),
        ("two/hall.composite", composite("urn:a", "hall", "")),
        ("two/other.composite", composite("urn:b", "hall", "")),
    ];
    expect![[r#"
        fleet.composite
        two/hall.composite
        two/other.composite
        two/hall.composite:1:4625 [hall] warning S2001 there are two composites `hall` in one namespace
          give each its own name
    "#]]
    .assert_eq(&fleets(&files));
    files.push(("sca-contribution.xml", description("")));
    expect![[r#"
        fleet.composite
        two/hall.composite
        two/other.composite
        two/hall.composite:1:4625 [hall] error S2001 there are two composites `hall` in one namespace
          give each its own name
    "#]]
    .assert_eq(&fleets(&files));
    expect![[r#"
        fleet.composite: a:hall -> one/hall.composite
        fleet.composite S2001
    "#]]
    .assert_eq(&crate::load::named::links(&files, "fleet.composite"));
}

#[test]
fn deployables_say_their_namespace_once() {
    let text = deployables(&["a:fleet", "fleet", "zz:fleet", "a:fleet"])
        .replace("</contribution>", "<import.jva package='x'/></contribution>");
    let files = [("fleet.composite", composite("urn:a", "fleet", "")), ("sca-contribution.xml", text)];
    expect![[r#"
        fleet.composite runs
        sca-contribution.xml:2:57 [fleet] warning S1011 `fleet` has no namespace
          write it with a prefix of the composite's target namespace
        sca-contribution.xml:2:88 [zz:fleet] warning S1011 `zz:fleet` is listed as deployable twice
          keep one of them
        sca-contribution.xml:2:122 [a:fleet] warning S1011 `a:fleet` is listed as deployable twice
          keep one of them
        sca-contribution.xml:2:133 [import.jva] error S1004 SCA 1.1 has no element `import.jva`
          replace `import.jva` with `import.java`
    "#]]
    .assert_eq(&fleets(&files));
}

#[test]
fn what_a_tool_says_of_a_contribution_is_added_to_what_its_author_says() {
    let fleet = |name: &str| composite("urn:a", name, "");
    let mut files = vec![
        ("META-INF/sca-contribution-generated.xml", deployables(&["a:one", "a:two", "a:on"])),
        ("one.composite", fleet("one")),
        ("two.composite", fleet("two")),
        ("META-INF/sca-deployables/three.composite", fleet("three")),
        ("four.composite", fleet("four")),
    ];
    expect![[r#"
        one.composite + two.composite + META-INF/sca-deployables/three.composite runs
        four.composite
        META-INF/sca-contribution-generated.xml:2:86 [a:on] error S2051 the contribution has no composite `a:on`
          replace `a:on` with `a:one`
    "#]]
    .assert_eq(&fleets(&files));
    files.push(("sca-contribution.xml", deployables(&["a:two"]).replace("</", "<export namespace='urn:a'/></")));
    expect![[r#"
        two.composite + one.composite + META-INF/sca-deployables/three.composite runs
        four.composite
        META-INF/sca-contribution-generated.xml:2:86 [a:on] error S2051 the contribution has no composite `a:on`
          replace `a:on` with `a:one`
    "#]]
    .assert_eq(&fleets(&files));
    // The folder alone makes a contribution of what is around it.
    let folder = [
        ("META-INF/sca-deployables/fleet.composite", composite("urn:a", "fleet", "<include name='a:hall'/>")),
        ("parts/hall.composite", fleet("hall")),
    ];
    expect![[r#"
        META-INF/sca-deployables/fleet.composite runs
    "#]]
    .assert_eq(&fleets(&folder));
    expect![[r#"
        META-INF/sca-deployables/fleet.composite: a:hall -> parts/hall.composite
    "#]]
    .assert_eq(&crate::load::named::links(&folder, folder[0].0));
}

#[test]
fn a_wrong_deployable_is_told_once() {
    let files = [
        ("fleet.composite", composite("urn:a", "fleet", "")),
        ("sca-contribution.xml", deployables(&["flet", "u:hall"])),
    ];
    expect![[r#"
        fleet.composite
        sca-contribution.xml:2:24 [flet] error S2051 the contribution has no composite `flet`
          write it with a prefix of the composite's target namespace
          replace `flet` with `fleet`
        sca-contribution.xml:2:54 [u:hall] error S2051 the contribution has no composite `u:hall`
          write it with a prefix of the composite's target namespace
          it has `fleet`
    "#]]
    .assert_eq(&fleets(&files));
}

#[cfg(unix)]
#[test]
fn what_is_no_file_is_passed_over() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    fs::write(path("fleet.composite"), composite("urn:a", "fleet", "")).unwrap();
    let made = std::process::Command::new("mkfifo").arg(path("pipe.composite")).status().unwrap();
    assert!(made.success());
    let links = [
        ("fleet.composite", "link"),
        ("pipe.composite", "to_pipe"),
        ("/", "to_root"),
        ("nowhere", "dead"),
        ("around.composite", "around"),
        ("me@host.1:2", ".#fleet"),
    ];
    for (to, name) in links {
        std::os::unix::fs::symlink(to, path(&format!("{name}.composite"))).unwrap();
    }
    fs::write(path(".copy.composite"), "<composite").unwrap();
    let (mut sources, mut diagnostics) = (Sources::new(), Diagnostics::new());
    let all = composites_below(folder.path(), &mut sources, &mut diagnostics);
    let names: Vec<_> = all.iter().map(|path| path.file_name().unwrap().to_str().unwrap()).collect();
    assert_eq!(names, ["around.composite", "dead.composite", "fleet.composite", "link.composite"]);
    let finder = &mut Finder::new(OpenTexts::default());
    let fleets = finder.load_folder(folder.path(), MAX_SIZE, &mut sources, &mut diagnostics);
    let files: Vec<_> = fleets.iter().map(|fleet| fleet.files[0].file_stem().unwrap()).collect();
    assert_eq!(files, ["fleet", "link"]);
    let told = diagnostics.iter().map(|one| (one.code.id, one.message.as_str()));
    let told: Vec<_> = told.filter(|(code, _)| *code != "S2001").collect();
    let expected = ["this link leads back to itself", "this link leads to no file"];
    assert_eq!(told, expected.map(|message| ("S0001", message)));
}
