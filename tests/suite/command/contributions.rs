//! Folders and standard input in place of files.

use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::support::{answer, saoms_with};

/// Runs `saoms` in the folder.
fn saoms(folder: &Path, arguments: &[&str], input: &str) -> (i32, String, String) {
    answer(&saoms_with(folder, arguments, input.as_bytes()))
}

fn composite(name: &str, inside: &str) -> String {
    format!(
        "<composite xmlns=\"http://docs.oasis-open.org/ns/opencsa/sca/200912\" xmlns:a=\"urn:a\" targetNamespace=\"urn:a\" name=\"{name}\">\n{inside}\n</composite>\n"
    )
}

fn robot(number: u32, inside: &str) -> String {
    format!(
        "<component name=\"Robot{number}\"><implementation.rust class=\"saoms.Robot\"/><property name=\"ID\">R{number}</property><property name=\"period\">100</property>{inside}</component>"
    )
}

/// A folder with a fleet that includes a part that cannot run by itself, and another fleet with robots of the same
/// names.
fn contribution(deployables: &[&str]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| {
        let path = folder.path().join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    };
    write("fleet.composite", &composite("fleet", "<include name=\"a:part\"/>"));
    write("parts/part.composite", &composite("part", &robot(1, "")));
    write("other.composite", &composite("other", &(robot(1, "") + &robot(2, ""))));
    let must = "<property name=\"level\" mustSupply=\"true\"/>";
    let hall = must.to_owned() + &robot(7, "<property name=\"battery\" source=\"$level\"/>");
    write("hall.composite", &composite("hall", &hall));
    if !deployables.is_empty() {
        let all: String = deployables.iter().map(|name| format!("<deployable composite=\"{name}\"/>")).collect();
        write(
            "sca-contribution.xml",
            &format!(
                "<contribution xmlns=\"http://docs.oasis-open.org/ns/opencsa/sca/200912\" xmlns:a=\"urn:a\">{all}</contribution>"
            ),
        );
    }
    folder
}

#[test]
fn check_looks_at_every_fleet_of_a_folder() {
    let folder = contribution(&[]);
    let (code, stdout, stderr) = saoms(folder.path(), &["check", "."], "");
    assert_eq!((code, stdout.as_str()), (0, "3 fleets, 3 components: 0 errors, 0 warnings\n"), "{stderr}");
    let (_, stdout, _) = saoms(folder.path(), &["check", ".", "--set", "level=40"], "");
    assert_eq!(stdout, "3 fleets, 4 components: 0 errors, 0 warnings\n");
    let (code, _, stderr) = saoms(folder.path(), &["check", ".", "--set", "levle=40"], "");
    assert!(code == 2 && stderr.matches("error[").count() == 1 && stderr.contains("S2029"), "{stderr}");
    // What two fleets share has its faults once.
    fs::write(
        folder.path().join("parts/part.composite"),
        composite("part", &robot(1, "<property name=\"batery\">1</property>")),
    )
    .unwrap();
    fs::write(folder.path().join("second.composite"), composite("second", "<include name=\"a:part\"/>")).unwrap();
    let (code, stdout, stderr) = saoms(folder.path(), &["check", "."], "");
    assert_eq!((code, stdout.as_str()), (2, "4 fleets, 2 components: 1 error, 0 warnings\n"), "{stderr}");
    assert!(stderr.contains("parts/part.composite:2:"), "{stderr}");
}

#[test]
fn a_deployable_that_is_made_for_use_in_others_is_blamed_for_what_it_lacks() {
    let folder = contribution(&["a:hall"]);
    let inside = "<component name=\"Hall\"><implementation.composite name=\"a:hall\"/>\
        <property name=\"level\">40</property></component>";
    let help = "= help: list only composites as deployable that run by themselves: `user` uses this one, and supplies what it lacks";
    for command in [&["check", "."][..], &["check", "sca-contribution.xml"], &["run", ".", "--virtual"]] {
        let (code, _, told) = saoms(folder.path(), command, "");
        assert!(code == 2 && told.contains("error[S2025, ASM60034]"), "{told}");
        assert!(!told.contains("deployable"), "nothing uses it: {told}");
    }
    fs::write(folder.path().join("user.composite"), composite("user", inside)).unwrap();
    for command in [&["check", "."][..], &["check", "sca-contribution.xml"], &["run", ".", "--virtual"]] {
        let (code, _, told) = saoms(folder.path(), command, "");
        let counts = ["error[", "it is deployable: it runs by itself", help].map(|text| told.matches(text).count());
        assert!(code == 2 && counts == [1, 1, 1], "{told}");
        assert!(told.contains("sca-contribution.xml:1:"), "{told}");
    }
}

#[test]
fn what_runs_of_a_folder_is_what_it_calls_deployable() {
    let folder = contribution(&[]);
    let (code, _, stderr) = saoms(folder.path(), &["run", "--virtual", "."], "");
    assert_eq!(code, 2);
    assert!(stderr.contains("error[S0002]: found 3 fleets in this folder, expected one"), "{stderr}");
    assert!(stderr.contains("name one: `./fleet.composite`, `./hall.composite`, `./other.composite`"), "{stderr}");
    assert!(stderr.contains("`<deployable composite=\"...\"/>`"), "{stderr}");

    let folder = contribution(&["a:other"]);
    let (code, stdout, stderr) = saoms(folder.path(), &["expand", "."], "");
    assert_eq!(code, 0, "{stderr}");
    assert!(stdout.contains("Robot1") && stdout.contains("Robot2") && !stdout.contains("Robot7"), "{stdout}");
    let (code, stdout, stderr) = saoms(folder.path(), &["graph", ".", "--format", "dot"], "");
    assert!(code == 0 && stdout.contains("Robot2") && !stdout.contains("Robot7"), "{stderr}");
    let (code, _, stderr) = saoms(folder.path(), &["run", "--virtual", "--for", "1s", "."], "");
    assert_eq!(code, 0, "{stderr}");

    // Two deployables are one fleet.
    let folder = contribution(&["a:other", "a:fleet"]);
    let (code, _, stderr) = saoms(folder.path(), &["check", "."], "");
    assert!(code == 2 && stderr.contains("S2002"), "{stderr}");
    // One with a missing value cannot run.
    let folder = contribution(&["a:hall"]);
    let (code, _, stderr) = saoms(folder.path(), &["check", "."], "");
    assert!(code == 2 && stderr.contains("S2025"), "{stderr}");
    // A missing one is reported beside all else.
    let folder = contribution(&["a:flet"]);
    let (code, stdout, stderr) = saoms(folder.path(), &["check", "."], "");
    assert!(code == 2 && stderr.contains("error[S2051]") && stdout.starts_with("3 fleets"), "{stderr}");
}

#[test]
fn a_wiring_report_of_a_folder_has_every_fleet() {
    let folder = contribution(&[]);
    let (_, stdout, _) = saoms(folder.path(), &["check", "--wiring", "--format", "json", "."], "");
    let found: Value = serde_json::from_str(&stdout).unwrap();
    let fleets: Vec<&String> = found["wiring"].as_object().unwrap().keys().collect();
    assert_eq!(fleets, ["./fleet.composite", "./other.composite"]);
}

#[test]
fn standard_input_is_a_composite_in_the_current_folder() {
    let folder = contribution(&[]);
    let fleet = composite("piped", &("<include name=\"a:part\"/>".to_owned() + &robot(2, "")));
    let (code, stdout, stderr) = saoms(folder.path(), &["check", "-"], &fleet);
    assert_eq!((code, stdout.as_str()), (0, "2 components: 0 errors, 0 warnings\n"), "{stderr}");
    let (code, stdout, stderr) = saoms(folder.path(), &["expand", "-"], &fleet);
    assert!(code == 0 && stdout.contains("Robot1"), "{stderr}");
    let (code, _, stderr) = saoms(folder.path(), &["check", "-"], "<composite");
    assert!(code == 2 && stderr.contains("<stdin>:1:"), "{stderr}");
    let (code, _, stderr) = saoms(folder.path(), &["run", "--reload", "-"], &fleet);
    assert!(code == 2 && stderr.contains("standard input"), "{stderr}");
}

#[test]
fn a_composite_beside_one_that_is_named_from_outside_is_one_file() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    fs::create_dir(folder.path().join("parts")).unwrap();
    write("sca-contribution.xml", "<contribution xmlns=\"http://docs.oasis-open.org/ns/opencsa/sca/200912\"/>");
    let inner = "<component name=\"A\"><implementation.composite name=\"a:body\"/></component>";
    write("parts/hall.composite", &composite("hall", inner));
    write("parts/body.composite", &composite("body", &robot(1, "")));
    for path in ["parts/hall.composite", "./parts/../parts/hall.composite"] {
        let (code, said, wrong) = saoms(folder.path(), &["check", path], "");
        assert_eq!((code, wrong.as_str()), (0, ""), "{said}");
    }
}

#[test]
fn what_fleets_share_is_told_once() {
    let folder = tempfile::tempdir().unwrap();
    let renamed = "<property name=\"topicRename\" source=\"$topics\"/>";
    let part = "<property name=\"topics\">NOWHERE,a</property>".to_owned() + &robot(1, renamed);
    fs::write(folder.path().join("part.composite"), composite("part", &part)).unwrap();
    let world = format!(
        "<component name=\"World\"><implementation.rust class=\"saoms.World\"/><property name=\"ID\">W</property><property name=\"period\">100</property>{renamed}</component>"
    );
    let include = "<include name=\"a:part\"/>";
    fs::write(folder.path().join("one.composite"), composite("one", include)).unwrap();
    fs::write(folder.path().join("two.composite"), composite("two", &(include.to_owned() + &world))).unwrap();
    let (_, _, told) = saoms(folder.path(), &["check", "."], "");
    assert_eq!(told.matches("S4003").count(), 1, "{told}");
}

/// An exported composite that does not run is for others, also where it is alone.
#[test]
fn the_only_composite_of_a_library_may_lack_what_others_give_it() {
    let folder = tempfile::tempdir().unwrap();
    let must = "<property name=\"level\" mustSupply=\"true\"/>";
    let hall = must.to_owned() + &robot(7, "<property name=\"battery\" source=\"$level\"/>");
    fs::write(folder.path().join("hall.composite"), composite("hall", &hall)).unwrap();
    let described = |inside: &str| {
        let text = format!(
            "<contribution xmlns=\"http://docs.oasis-open.org/ns/opencsa/sca/200912\" xmlns:a=\"urn:a\">{inside}</contribution>"
        );
        fs::write(folder.path().join("sca-contribution.xml"), text).unwrap();
        let (code, _, stderr) = saoms(folder.path(), &["check", "."], "");
        assert_eq!(code == 0, !stderr.contains("S2025"), "{stderr}");
        code
    };
    assert_eq!(described(""), 2);
    assert_eq!(described("<export namespace=\"urn:b\"/>"), 2);
    assert_eq!(described("<export namespace=\"urn:a\"/>"), 0);
    assert_eq!(described("<export namespace=\"urn:a\"/><deployable composite=\"a:hall\"/>"), 2);
}

/// A part that another contribution includes counts as a part of that, as within one contribution.
#[test]
fn what_a_contribution_exports_is_checked_where_another_one_takes_it() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| {
        let path = folder.path().join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    };
    let described = |inside: &str| {
        format!(
            "<contribution xmlns=\"http://docs.oasis-open.org/ns/opencsa/sca/200912\" xmlns:f=\"urn:f\">{inside}</contribution>"
        )
    };
    let world = "<include name=\"a:part\"/><component name=\"World\"><implementation.rust class=\"saoms.World\"/><property name=\"ID\">World</property><property name=\"period\">100</property></component>";
    let fleet = composite("fleet", world).replace("targetNamespace=\"urn:a\"", "targetNamespace=\"urn:f\"");
    write("fleet/fleet.composite", &fleet);
    write("fleet/sca-contribution.xml", &described("<import namespace=\"urn:a\"/><deployable composite=\"f:fleet\"/>"));
    write("a/sca-contribution.xml", &described("<export namespace=\"urn:a\"/>"));
    write("a/part.composite", &composite("part", &robot(1, "<reference name=\"world\" target=\"World\"/>")));
    let (code, stdout, stderr) = saoms(folder.path(), &["check", "."], "");
    assert_eq!((code, stdout.as_str()), (0, "2 components: 0 errors, 0 warnings\n"), "{stderr}");
    // Nobody else takes it here.
    let (code, _, stderr) = saoms(folder.path(), &["check", "a"], "");
    assert!(code == 2 && stderr.contains("there is no component `World`"), "{stderr}");
}

#[test]
fn files_beside_composites_are_checked_by_themselves() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    let sca = "xmlns=\"http://docs.oasis-open.org/ns/opencsa/sca/200912\"";
    write(
        "definitions.xml",
        &format!("<definitions {sca} targetNamespace=\"urn:a\"><intent name=\"safe\"/></definitions>"),
    );
    write("sca-contribution.xml", &format!("<contribution {sca}/>"));
    write("Radar.componentType", &format!("<componentType {sca}><service name=\"eye\"/></componentType>"));
    let files = ["check", "definitions.xml", "sca-contribution.xml", "Radar.componentType"];
    let (code, out, err) = saoms(folder.path(), &files, "");
    assert_eq!((code, out.as_str(), err.as_str()), (0, "0 errors, 0 warnings\n", ""));
    write("definitions.xml", &format!("<definitions {sca} targetNamespace=\"urn:a\"><intent/></definitions>"));
    write("sca-contribution.xml", &format!("<contribution {sca} xmlns:a=\"urn:a\"><deployable/></contribution>"));
    let two = "<service name=\"eye\"/><service name=\"eye\"/><reference/>";
    write("Radar.componentType", &format!("<componentType {sca}>{two}</componentType>"));
    write("a.composite", &composite("a", ""));
    let (code, out, err) = saoms(folder.path(), &[&files[..], &["a.composite"]].concat(), "");
    assert_eq!((code, out.as_str()), (2, "0 components: 4 errors, 0 warnings\n"));
    for told in ["definitions.xml:1:", "sca-contribution.xml:1:", "Radar.componentType:1:", "S2043", "S1008, ASM10003"]
    {
        assert!(err.contains(told), "{told}: {err}");
    }
    // Nothing of it can run.
    let (code, _, err) = saoms(folder.path(), &["run", "definitions.xml"], "");
    assert!(code == 2 && err.contains("this holds policies; name a composite"), "{err}");
}

#[cfg(unix)]
#[test]
fn a_file_that_cannot_be_read_is_told_once_and_no_fleet_where_there_is_none() {
    let folder = tempfile::tempdir().unwrap();
    let names =
        "<include name=\"a:dead\"/><component name=\"C\"><implementation.composite name=\"a:late\"/></component>";
    fs::write(folder.path().join("fleet.composite"), composite("fleet", names)).unwrap();
    fs::write(folder.path().join("late.composite"), b"<\0c\0").unwrap();
    for (to, name) in [("nowhere", "dead.composite"), ("loop.composite", "loop.composite")] {
        std::os::unix::fs::symlink(to, folder.path().join(name)).unwrap();
    }
    let (_, stdout, stderr) = saoms(folder.path(), &["check", "."], "");
    assert_eq!(stdout, "2 fleets, 0 components: 3 errors, 0 warnings\n", "{stderr}");
    let (_, stdout, stderr) = saoms(folder.path(), &["check", "fleet.composite"], "");
    assert_eq!(stdout, "2 errors, 0 warnings\n", "{stderr}");
    assert!(stderr.contains("error[S0001]") && stderr.contains("error[S0007]"), "{stderr}");
}
