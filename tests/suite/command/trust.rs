//! Composites of others: what they can read.

use std::fs;
use std::os::unix::fs::symlink;
use std::path::Path;

use crate::support::{answer, saoms_in};

/// A text that no output may have.
const SECRET: &str = "hunter2";

fn saoms(folder: &Path, arguments: &[&str]) -> (i32, String, String) {
    answer(&saoms_in(folder, arguments))
}

fn composite(inside: &str) -> String {
    format!(
        "<composite xmlns=\"http://docs.oasis-open.org/ns/opencsa/sca/200912\" xmlns:saoms=\"urn:saoms:1\" xmlns:a=\"urn:a\" targetNamespace=\"urn:a\" name=\"fleet\">\n{inside}\n</composite>\n"
    )
}

/// A robot whose battery stands in a file.
fn robot(file: &str) -> String {
    composite(&format!(
        "<component name=\"Robot1\"><implementation.rust class=\"saoms.Robot\"/><property name=\"ID\">R1</property><property name=\"period\">100</property><property name=\"battery\" file=\"{file}\"/></component>"
    ))
}

/// A folder `site/fleet` for composites, with a secret two folders above.
fn site() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir_all(folder.path().join("site/fleet")).unwrap();
    fs::write(folder.path().join("secret.txt"), SECRET).unwrap();
    folder
}

fn write(folder: &Path, name: &str, text: &str) {
    fs::write(folder.join("site/fleet").join(name), text).unwrap();
}

#[test]
fn a_value_outside_the_folder_is_refused_and_not_shown() {
    let folder = site();
    let site = folder.path().join("site");
    symlink("../../secret.txt", site.join("fleet/link.txt")).unwrap();
    let absolute = folder.path().join("secret.txt").display().to_string();
    // Whether a file is there is not told either.
    let names = ["../../secret.txt", &absolute, "link.txt", "../../none.txt", "no/../../../none.txt", "/no/such"];
    for name in names {
        write(folder.path(), "fleet.composite", &robot(name));
        for command in ["check", "check --format json", "check --format sarif", "run --virtual", "expand"] {
            let mut arguments: Vec<&str> = command.split(' ').collect();
            arguments.push("fleet/fleet.composite");
            let (code, stdout, stderr) = saoms(&site, &arguments);
            let all = stdout + &stderr;
            assert!(all.contains("S0009") && !all.contains(SECRET), "{name} {command}: {all}");
            assert_eq!(code, 2, "{name} {command}: {all}");
        }
        // What is wrong does not keep a picture from being drawn.
        saoms(&site, &["graph", "fleet/fleet.composite", "-o", "x.svg"]);
        assert!(!fs::read_to_string(site.join("x.svg")).unwrap().contains(SECRET), "{name}");
    }
    write(folder.path(), "fleet.composite", &robot("link.txt"));
    let (code, _, stderr) = saoms(&site, &["check", "--allow-outside", "fleet/fleet.composite"]);
    assert!(code == 2 && stderr.contains("S3007"), "it was read, and is no number: {stderr}");
}

#[test]
fn what_a_user_names_and_its_contribution_are_inside() {
    let folder = site();
    let site = folder.path().join("site");
    fs::write(site.join("battery.txt"), "50").unwrap();
    write(folder.path(), "fleet.composite", &robot("../battery.txt"));
    let refused = |arguments: &[&str]| saoms(&site, arguments).0 == 2;
    assert!(refused(&["check", "fleet/fleet.composite"]));
    assert!(!refused(&["check", "."]), "the folder is named");
    let description = "<contribution xmlns=\"http://docs.oasis-open.org/ns/opencsa/sca/200912\"/>";
    fs::write(site.join("sca-contribution.xml"), description).unwrap();
    assert!(!refused(&["check", "fleet/fleet.composite"]), "its contribution is the folder above");
    // A composite that is a link itself is what the user named.
    symlink(site.join("fleet/fleet.composite"), folder.path().join("link.composite")).unwrap();
    fs::write(folder.path().join("secret.txt"), "50").unwrap();
    write(folder.path(), "fleet.composite", &robot("secret.txt"));
    assert!(!refused(&["check", "../link.composite"]));
}

#[test]
fn tables_and_includes_outside_the_folder_are_refused() {
    let folder = site();
    let site = folder.path().join("site");
    let check = || {
        let (code, stdout, stderr) = saoms(&site, &["check", "fleet/fleet.composite"]);
        assert!(code == 2 && !(stdout.clone() + &stderr).contains(SECRET), "{stdout}{stderr}");
        stderr
    };
    let robots = "<component name=\"Robot${index}\" saoms:count=\"2\" saoms:overrides=\"../../secret.txt\"><implementation.rust class=\"saoms.Robot\"/><property name=\"ID\">R${index}</property><property name=\"period\">100</property></component>";
    write(folder.path(), "fleet.composite", &composite(robots));
    assert!(check().contains("S0009"));
    write(folder.path(), "fleet.composite", &composite("<include name=\"a:part\"/>"));
    let part = composite("<x/>").replace("name=\"fleet\"", &format!("name=\"part\" hunter2=\"{SECRET}\""));
    fs::write(folder.path().join("secret.txt"), part).unwrap();
    symlink("../../secret.txt", site.join("fleet/part.composite")).unwrap();
    let told = check();
    assert!(told.contains("S0009") && told.contains("fleet/part.composite"), "{told}");
    let (_, stdout, stderr) = saoms(&site, &["check", "fleet"]);
    assert!(stderr.contains("S0009") && !(stdout + &stderr).contains(SECRET), "{stderr}");
}
