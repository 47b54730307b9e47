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
    let (code, stdout, stderr) = saoms(&site, &["fmt", "fleet"]);
    assert!(code == 2 && stderr.contains("S0009") && !(stdout + &stderr).contains(SECRET), "{stderr}");
    let (code, _, stderr) = saoms(&site, &["fmt", "--allow-outside", "fleet"]);
    assert_eq!(code, 0, "{stderr}");
    let (_, stdout, stderr) = saoms(&site, &["check", "fleet"]);
    assert!(stderr.contains("S0009") && !(stdout + &stderr).contains(SECRET), "{stderr}");
}

#[test]
fn an_import_leads_to_no_folder_elsewhere() {
    let folder = site();
    let site = folder.path().join("site");
    let description = |inside: &str| {
        format!("<contribution xmlns=\"http://docs.oasis-open.org/ns/opencsa/sca/200912\">\n{inside}</contribution>")
    };
    write(
        folder.path(),
        "fleet.composite",
        &composite("<component name=\"P\"><implementation.composite name=\"p:part\" xmlns:p=\"urn:p\"/></component>"),
    );
    let secret = composite(&format!("<{SECRET}/>")).replace("\"fleet\"", "\"part\"").replace("urn:a", "urn:p");
    for part in ["far/part", "site/part"] {
        let part = folder.path().join(part);
        fs::create_dir_all(&part).unwrap();
        fs::write(part.join("part.composite"), &secret).unwrap();
        fs::write(part.join("sca-contribution.xml"), description("<export namespace=\"urn:p\"/>")).unwrap();
    }
    symlink("../far/part", site.join("linked")).unwrap();
    let beside = site.join("part");
    let absolute = folder.path().join("far/part").display().to_string();
    let check = |location: &str, more: &[&str]| {
        let import = format!("<import namespace=\"urn:p\" location=\"{location}\"/>");
        write(folder.path(), "sca-contribution.xml", &description(&import));
        let (code, stdout, stderr) = saoms(&site, &[&["check", "fleet/fleet.composite"], more].concat());
        assert_eq!(code, 2, "{stdout}{stderr}");
        stdout + &stderr
    };
    assert!(check("../part", &[]).contains(SECRET), "a contribution beside it may be read");
    fs::remove_dir_all(beside).unwrap();
    for location in ["../../far/part", &absolute, "../linked", "../../none", "/no/such"] {
        let told = check(location, &[]);
        assert!(told.contains("error[S0009]") && told.contains("sca-contribution.xml:2:"), "{location}: {told}");
        assert!(!told.contains(SECRET) && told.contains("1 error"), "{location}: {told}");
        assert!(check(location, &["--allow-outside"]).contains(SECRET), "{location}: the link leads there, too");
    }
    // Also where nothing needs the import: the folder is checked as a contribution.
    write(folder.path(), "fleet.composite", &composite(""));
    let import = |location: &str| {
        let import = format!("<import namespace=\"urn:p\" location=\"{location}\"/>");
        write(folder.path(), "sca-contribution.xml", &description(&import));
        saoms(&site, &["check", "fleet"]).2
    };
    assert!(import("../../far/part").contains("error[S0009]"));
    assert!(import("../none").contains("there is no folder `../none`"), "beside it that is no secret");
}

#[test]
fn the_description_of_a_contribution_stands_for_its_folder() {
    let folder = site();
    let site = folder.path().join("site");
    let description = "<contribution xmlns=\"http://docs.oasis-open.org/ns/opencsa/sca/200912\"/>";
    write(folder.path(), "sca-contribution.xml", description);
    write(folder.path(), "fleet.composite", &hostile("R1").replace("saoms.World", "saoms.Wrld"));
    for file in ["fleet/sca-contribution.xml", "fleet"] {
        for command in ["check", "expand"] {
            let (code, _, stderr) = saoms(&site, &[command, file]);
            assert!(code == 2 && stderr.contains("fleet/fleet.composite:2:"), "{file}: {stderr}");
        }
    }
}

/// A name that clears the screen, turns the direction, and adds a line.
const HOSTILE: &str = "R\u{202e}\u{9b}2J&#10;error[S9999]: forged&#10;    1.000 s  forged 1";

/// A fleet with such names, and a topic and an ID that are in order, where `id` is the ID of the robot.
fn hostile(id: &str) -> String {
    let one = |name: &str, class: &str, more: &str| {
        format!(
            "<component name=\"{name}\"><implementation.rust class=\"saoms.{class}\"/><property name=\"ID\">{name}</property><property name=\"period\">100</property>{more}</component>\n"
        )
    };
    let robot = one("Rob\u{202e}\u{9b}ot1", "Robot", "<reference name=\"world\" target=\"World\"/>")
        .replace("\"ID\">Rob\u{202e}\u{9b}ot1<", &format!("\"ID\">{id}<"));
    let scenario = "<property name=\"scenario\">at 1s luggage (3,1) to (3,10)</property>";
    composite(
        &[one("World", "World", ""), one("Master", "MasterEnvironment", ""), one("E", "Environment", scenario), robot]
            .concat(),
    )
    .replace("\"fleet\"", "\"fl\u{202e}eet\"")
}

fn assert_visible(what: &str, text: &str) {
    let steers = |one: &char| *one != '\n' && (one.is_control() || ('\u{202a}'..='\u{202e}').contains(one));
    assert_eq!(text.chars().find(steers), None, "{what}: {text:?}");
    let forged = ["error[S9999]", "1.000 s  forged"];
    let forged = text.lines().find(|line| forged.iter().any(|start| line.trim_start().starts_with(start)));
    assert_eq!(forged, None, "{what}: {text}");
}

#[test]
fn names_neither_steer_a_terminal_nor_forge_lines() {
    let folder = site();
    let site = folder.path().join("site");
    let file = "fleet/fl\u{1b}[31m\nerror[S9999]: forged.composite";
    fs::write(site.join(file), hostile("R").replace("name=\"period\"", &format!("name=\"{HOSTILE}\""))).unwrap();
    for arguments in [
        &["check", file][..],
        &["check", file, "--format", "json"],
        &["check", file, "--format", "sarif"],
        &["run", "--virtual", file],
        &["expand", file],
        &["fmt", "--check", file],
    ] {
        let (_, stdout, stderr) = saoms(&site, arguments);
        assert_visible(arguments[0], &(stdout + &stderr));
    }
    for arguments in [
        &["check", "--\u{1b}[31m", file][..],
        &["graph", file, "-o", file],
        &["run", file, "--events", "\u{9b}\nerror[S9999]"],
    ] {
        let (code, stdout, stderr) = saoms(&site, arguments);
        assert_eq!(code, 2, "{stderr}");
        assert_visible(arguments[0], &(stdout + &stderr));
    }
    write(folder.path(), "fleet.composite", &hostile(HOSTILE));
    let file = "fleet/fleet.composite";
    for console in ["plain", "classic"] {
        let arguments = ["run", "--virtual", file, "--console", console, "--report", "r.json", "--paths", "p.svg"];
        let (code, stdout, stderr) = saoms(&site, &arguments);
        assert_eq!(code, 0, "{stderr}");
        assert_visible(console, &(stdout + &stderr));
    }
    let of_robot = ["why", "Rob\u{202e}\u{9b}ot1", "--report", "r.json"];
    for arguments in [
        &["check", "--wiring", file][..],
        &["check", "--wiring", file, "--format", "json"],
        &["run", "--virtual", file, "--quiet", "--report", "-"],
        &of_robot,
        &[&of_robot[..], &["--format", "json"]].concat(),
    ] {
        let (code, stdout, stderr) = saoms(&site, arguments);
        assert_eq!(code, 0, "{stderr}");
        assert_visible(arguments[0], &(stdout + &stderr));
    }
    for format in ["svg", "dot", "mermaid"] {
        let (_, stdout, _) = saoms(&site, &["graph", file, "--format", format]);
        assert!(stdout.contains("u{202e}"), "{format}: {stdout}");
        // The lines of a value are indented in its tooltip.
        assert_visible(format, &stdout.replace("\n    ", " "));
    }
    assert_visible("paths", &fs::read_to_string(site.join("p.svg")).unwrap());
    // Programs get what is there.
    let (_, stdout, _) = saoms(&site, &["expand", file]);
    assert!(stdout.contains('\u{202e}'), "{stdout}");
    let (_, stdout, _) = saoms(&site, &["why", "Rob\u{202e}\u{9b}ot1", "--report", "r.json", "--format", "json"]);
    let answer: serde_json::Value = serde_json::from_str(&stdout).unwrap();
    assert_eq!(answer["component"], "Rob\u{202e}\u{9b}ot1");
}

#[test]
fn messages_quote_a_line_of_a_value_at_most() {
    let folder = site();
    let site = folder.path().join("site");
    let long = "Zq".repeat(50_000);
    let places =
        ["\"ID\">R1<", "\"period\">100<", "\"number\">1<", "(3,1)", "saoms.World", "name=\"world\"", "\"World\""];
    let whole = hostile("R1").replace("</component>", "<property name=\"number\">1</property></component>");
    for place in places {
        let end = place.find(['<', ')']).unwrap_or(place.len() - 1);
        let text = whole.replace(place, &format!("{}{long}{}", &place[..end], &place[end..]));
        write(folder.path(), "fleet.composite", &text);
        let (code, stdout, stderr) = saoms(&site, &["check", "fleet/fleet.composite", "--format", "json"]);
        assert_eq!(code, 2, "{place}: {stderr}");
        let found: serde_json::Value = serde_json::from_str(&stdout).unwrap();
        for one in found["diagnostics"].as_array().unwrap() {
            let help = one["help"].as_array().into_iter().flatten().chain([&one["message"]]);
            for text in help.filter_map(|text| text.as_str()) {
                assert!(!text.contains(&long[..101]), "{place}: {text:.200}");
            }
        }
        let (_, stdout, stderr) = saoms(&site, &["check", "fleet/fleet.composite"]);
        assert!(!(stdout + &stderr).contains(&long[..401]), "{place}: {stderr:.800}");
    }
}

#[test]
fn messages_quote_a_line_of_the_command_line_at_most() {
    let folder = site();
    write(folder.path(), "fleet.composite", &hostile("R1"));
    let (long, file) = ("y".repeat(5_000), "fleet/fleet.composite");
    let option = format!("--{long}");
    for arguments in [
        &["explain", &long][..],
        &["components", &long],
        &["run", file, "--for", &long],
        &["run", file, "--console", &long],
        &["run", file, "--virtual", "--report", &long],
        &["run", file, "--plugin", &long],
        &["run", file, "--virtual", "--events", &long],
        &["check", file, &option],
        &["check", file, "--set", &long],
        &["check", file, "--severity", &long],
        &[&long],
    ] {
        let (code, stdout, stderr) = saoms(&folder.path().join("site"), arguments);
        assert!(code == 2 && !(stdout + &stderr).contains(&long[..401]), "{arguments:.20?}: {stderr:.1000}");
    }
}

#[test]
fn a_folder_that_cannot_be_read_is_an_error() {
    let folder = site();
    let site = folder.path().join("site");
    write(folder.path(), "fleet.composite", &composite(""));
    // Nobody, whatever his rights, reads a folder whose path is longer than paths can be.
    let chain = |name: &str| (0..12).fold(site.join(name), |path, _| path.join("x".repeat(200)));
    fs::create_dir_all(chain("one")).unwrap();
    fs::create_dir_all(chain("two")).unwrap();
    fs::rename(site.join("two"), chain("one").join("two")).unwrap();
    for arguments in [&["check", "."][..], &["run", "--virtual", "."], &["fmt", "--check", "."]] {
        let (code, stdout, stderr) = saoms(&site, arguments);
        assert!(code == 2 && stderr.contains("error[S0003]: the folder cannot be read"), "{stdout}{stderr}");
    }
    // Where a name is not found, it may be there.
    fs::write(site.join("other.composite"), composite("<include name=\"a:none\"/>")).unwrap();
    fs::write(
        site.join("sca-contribution.xml"),
        "<contribution xmlns=\"http://docs.oasis-open.org/ns/opencsa/sca/200912\" xmlns:t=\"urn:there\">\
        <deployable composite=\"t:there\"/></contribution>",
    )
    .unwrap();
    let (_, _, stderr) = saoms(&site, &["check", "other.composite"]);
    assert!(stderr.contains("S2030") && stderr.contains("which cannot be read: File name too long"), "{stderr}");
    let (_, _, stderr) = saoms(&site, &["check", "."]);
    assert!(stderr.contains("S0003") && !stderr.contains("S2051"), "the deployable may be there: {stderr}");
    // A folder of plugins is told once, and not as `plugins` and `./plugins`.
    symlink("plugins", site.join("plugins")).unwrap();
    let (code, _, stderr) = saoms(&site, &["check", "other.composite"]);
    assert_eq!((code, stderr.matches("plugins` cannot be read").count()), (2, 1), "{stderr}");
}
