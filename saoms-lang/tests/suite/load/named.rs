//! Finding the composites that others name.

use std::fs;
use std::path::Path;

use expect_test::expect;
use saoms_lang::model::{Link, Naming};
use saoms_lang::source::OpenTexts;

use crate::load::support::loaded_with_named;

pub(crate) fn composite(namespace: &str, name: &str, inside: &str) -> String {
    format!(
        "<!-- {} --><composite xmlns='http://www.osoa.org/xmlns/sca/1.0' targetNamespace='{namespace}' xmlns:a='urn:a' xmlns:b='urn:b' name='{name}'>{inside}</composite>",
        "long ".repeat(900)
    )
}

/// Writes files into a folder and says where each include of all composites that are read for `asked_for` leads.
pub(crate) fn links(files: &[(&str, String)], asked_for: &str) -> String {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in files {
        let path = folder.path().join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    }
    let shown = |path: &str| {
        path.replace(&format!("{}/", folder.path().display()), "")
            .replace(&folder.path().display().to_string(), "FOLDER")
    };
    let (all, sources, diagnostics) = loaded_with_named(&folder.path().join(asked_for), OpenTexts::default());
    let mut out = String::new();
    let path = |place: usize| shown(sources.get(all.composites()[place].file()).path());
    for (place, composite) in all.composites().iter().enumerate() {
        for include in &composite.includes {
            let naming = Naming::of_include(include).unwrap();
            out += &match all.link(naming.origin).unwrap() {
                Link::To(to) => format!("{}: {} -> {}\n", path(place), naming.name, path(*to)),
                Link::Faulty => format!("{}: {} is faulty\n", path(place), naming.name),
                Link::Missing(missing) => {
                    let searched: Vec<String> = missing.searched.iter().map(|text| shown(text)).collect();
                    format!(
                        "{}: {} is missing, near {:?}; {}\n",
                        path(place),
                        naming.name,
                        missing.near,
                        searched.join("; ")
                    )
                }
            };
        }
    }
    for one in &diagnostics {
        out += &format!("{} {}\n", shown(sources.get(one.location.file).path()), one.code.id);
    }
    out
}

#[test]
fn composites_are_found_by_namespace_and_name_near_the_one_that_names_them() {
    let files = [
        (
            "fleet.composite",
            composite(
                "urn:a",
                "fleet",
                "<include name='a:hall'/><include name='b:hall'/><include name='a:far'/><include name='hall'/>",
            ),
        ),
        // Another one stands where the name leads one to look first.
        ("hall.composite", composite("urn:b", "hall", "")),
        ("x.composite", composite("urn:a", "hall", "<include name='a:fleet'/>")),
        ("deep/er/y.composite", composite("urn:a", "far", "<include name='b:hall'/><include name='a:own'/>")),
        ("deep/er/own.composite", composite("urn:a", "own", "")),
        ("own.composite", composite("urn:a", "own", "")),
        ("deep/er/not.xml", "<".to_owned()),
        ("bad.composite", "<composite".to_owned()),
    ];
    assert_eq!(
        links(&files, "fleet.composite"),
        "\
fleet.composite: a:hall -> x.composite
fleet.composite: b:hall -> hall.composite
fleet.composite: a:far -> deep/er/y.composite
fleet.composite: hall -> x.composite
x.composite: a:fleet -> fleet.composite
deep/er/y.composite: b:hall -> hall.composite
deep/er/y.composite: a:own -> deep/er/own.composite
"
    );
}

#[test]
fn a_description_above_makes_its_folder_the_contribution() {
    for description in ["META-INF/sca-contribution.xml", "sca-contribution.xml"] {
        let files = [
            (description, "<contribution xmlns='http://www.osoa.org/xmlns/sca/1.0'/>".to_owned()),
            ("a/b/fleet.composite", composite("urn:a", "fleet", "<include name='b:hall'/>")),
            ("c/hall.composite", composite("urn:b", "hall", "<include name='a:fleet'/>")),
        ];
        let expected =
            "a/b/fleet.composite: b:hall -> c/hall.composite\nc/hall.composite: a:fleet -> a/b/fleet.composite\n";
        assert_eq!(links(&files, "a/b/fleet.composite"), expected);
    }
}

#[test]
fn what_is_not_found_says_where_and_what_is_near() {
    let files = [
        (
            "fleet.composite",
            composite(
                "urn:a",
                "fleet",
                "<include name='a:hal'/><include name='b:hall'/><include name='c:hall'/><include name='a:torn'/>",
            ),
        ),
        ("hall.composite", composite("urn:a", "hall", "")),
        ("torn.composite", composite("urn:a", "torn", "").replace("</composite>", "")),
        (".hidden/hall.composite", composite("urn:b", "hall", "")),
        ("target/hall.composite", composite("urn:b", "hall", "")),
    ];
    assert_eq!(
        links(&files, "fleet.composite"),
        "\
fleet.composite: a:hal is missing, near [\"a:hall\"]; searched the files `*.composite` in `FOLDER` and below
fleet.composite: b:hall is missing, near []; searched the files `*.composite` in `FOLDER` and below; \
`hall.composite` has a composite `hall` of the namespace `urn:a`
fleet.composite: c:hall -> hall.composite
fleet.composite: a:torn -> torn.composite
torn.composite S0103
"
    );
}

#[test]
fn thousands_of_composites_that_one_names_are_found_each_at_once() {
    const ALL: usize = 2_000;
    let folder = tempfile::tempdir().unwrap();
    let text = |namespace: &str, name: &str, inside: &str| {
        composite(namespace, name, inside).replace(&"long ".repeat(900), "")
    };
    let write = |path: &str, text: String| {
        let path = folder.path().join(path);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    };
    // Some beside it, some called otherwise than their files, some in folders of their own, and some that are not
    // there.
    for number in 0..ALL {
        let path = match number % 4 {
            0 => format!("c{number}.composite"),
            1 => format!("file{number}.composite"),
            2 => format!("f{number}/c{number}.composite"),
            _ => continue,
        };
        write(&path, text("urn:a", &format!("c{number}"), ""));
        if number == 2 {
            write("f1998/twin/c2.composite", text("urn:a", "c2", ""));
        }
    }
    let includes: String = (0..ALL).rev().map(|number| format!("<include name='a:c{number}'/>")).collect();
    write("fleet.composite", text("urn:a", "fleet", &includes));
    write("sca-contribution.xml", "<contribution xmlns='http://www.osoa.org/xmlns/sca/1.0'/>".to_owned());
    let (all, _, diagnostics) = loaded_with_named(&folder.path().join("fleet.composite"), OpenTexts::default());
    for include in &all.asked_for()[0].includes {
        let name = include.name.as_str().trim_start_matches("a:");
        let number: usize = name[1..].parse().unwrap();
        match all.link(include.origin).unwrap() {
            Link::To(to) => assert_eq!(all.composites()[*to].name, *name),
            link => assert!(matches!(link, Link::Missing(_)) && number % 4 == 3, "{name}"),
        }
    }
    assert_eq!(all.composites().len(), 1 + ALL / 4 * 3);
    let codes: Vec<&str> = diagnostics.iter().map(|one| one.code.id).collect();
    assert_eq!(codes, ["S2001"], "the two called `c2`: {diagnostics:?}");
}

#[cfg(unix)]
#[test]
fn circles_of_links_and_large_folders_end() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("fleet.composite");
    fs::write(&path, composite("urn:a", "fleet", "<include name='a:hall'/>")).unwrap();
    std::os::unix::fs::symlink(folder.path(), folder.path().join("around")).unwrap();
    std::os::unix::fs::symlink(Path::new("/"), folder.path().join("root")).unwrap();
    let (all, _, _) = loaded_with_named(&path, OpenTexts::default());
    assert_eq!(all.composites().len(), 1);
}

#[test]
fn what_an_editor_holds_counts_in_place_of_files() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    fs::write(path("outer.composite"), composite("urn:a", "outer", "<include name='other'/>")).unwrap();
    fs::write(path("inner.composite"), composite("urn:a", "inner", "")).unwrap();
    fs::write(path("value.txt"), "saved").unwrap();
    let component =
        "<component name='c'><implementation.java class='C'/><property name='p' file='value.txt'/></component>";
    let inside = format!("<include name='inner'/><include name='new'/>{component}");
    let mut open = OpenTexts::default();
    open.insert(&path("./outer.composite"), composite("urn:a", "outer", &inside));
    open.insert(&path("inner.composite"), composite("urn:a", "renamed", ""));
    open.insert(&path("new.composite"), composite("urn:a", "new", ""));
    open.insert(&path("value.txt"), " typed ".to_owned());
    let (all, _, diagnostics) = loaded_with_named(&path("outer.composite"), open);
    assert_eq!(all.composites()[0].components[0].properties[0].from_file().unwrap(), &"typed");
    let link = |place: usize| all.link(all.composites()[0].includes[place].origin).unwrap();
    assert!(matches!(link(0), Link::Missing(_)), "it has another name now");
    assert_eq!(*link(1), Link::To(1), "it is not on disk");
    assert!(diagnostics.is_empty());
}

#[test]
fn of_two_composites_of_one_name_in_a_folder_one_is_taken_and_both_are_told() {
    let twice = "<include name='a:hall'/><component name='h'><implementation.composite name='a:hall'/></component>";
    let files = [
        ("fleet.composite", composite("urn:a", "fleet", twice)),
        ("hall.composite", composite("urn:a", "hall", "")),
        ("copy.composite", composite("urn:a", "hall", "")),
        // Those of other folders are farther off, and of other namespaces others.
        ("below/hall.composite", composite("urn:a", "hall", "")),
        ("other.composite", composite("urn:b", "hall", "")),
    ];
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in &files {
        let path = folder.path().join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    }
    let (_, sources, diagnostics) = loaded_with_named(&folder.path().join("fleet.composite"), OpenTexts::default());
    let found: Vec<_> = diagnostics
        .iter()
        .map(|one| (one.code.id, one.severity.name(), sources.snippet(one.location), one.message.as_str()))
        .collect();
    let message = "there are two composites `hall` in one namespace: the one in `hall.composite` is used, not the \
        one in `copy.composite`";
    assert_eq!(found, [("S2001", "warning", "a:hall", message)]);
}

#[cfg(unix)]
#[test]
fn what_a_composite_names_is_no_pipe_and_no_device() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    for name in ["pipe", "hall.composite", "C.componentType", "sca-contribution.xml"] {
        let made = std::process::Command::new("mkfifo").arg(path(name)).status().unwrap();
        assert!(made.success());
    }
    fs::write(path("values.txt"), "7").unwrap();
    std::os::unix::fs::symlink("values.txt", path("link")).unwrap();
    let inside = "<include name='a:hall'/><component name='c' xmlns:s='urn:saoms:1' s:count='2' s:overrides='pipe'>\
                  <implementation.java class='C'/><property name='p' file='pipe'/><property name='q' file='/dev/zero'/>\
                  <property name='r' file='link'/></component>";
    fs::write(path("fleet.composite"), composite("urn:a", "fleet", inside)).unwrap();
    let (all, sources, diagnostics) = loaded_with_named(&path("fleet.composite"), OpenTexts::default());
    let properties = &all.composites()[0].components[0].properties;
    assert_eq!(properties[2].from_file().unwrap(), &"7", "links lead to files");
    assert!(matches!(all.link(all.composites()[0].includes[0].origin), Some(Link::Missing(_))));
    let found: Vec<_> =
        diagnostics.iter().map(|one| (one.code.id, sources.snippet(one.location), one.message.as_str())).collect();
    let message = "the file cannot be read: it is not a regular file";
    assert_eq!(found, ["pipe", "/dev/zero", "pipe"].map(|at| ("S0003", at, message)));
}

#[test]
fn files_that_are_no_composites_are_named_with_the_reason() {
    let names = "<include name='b:lounge'/><include name='b:hall'/><include name='a:gate'/>";
    let files = [
        ("fleet.composite", composite("urn:a", "fleet", names)),
        ("hall.composite", "<\0c\0".to_owned()),
        ("more.composite", " ".to_owned()),
        ("other.composite", "<contribution xmlns='http://www.osoa.org/xmlns/sca/1.0'/>".to_owned()),
        ("deep/gate.composite", "<composite".to_owned()),
    ];
    // What is called as the name is meant by it, and says itself what is wrong.
    expect![[r#"
        fleet.composite: b:lounge is missing, near []; searched the files `*.composite` in `FOLDER` and below; `hall.composite` is not a composite: the file is in UTF-16LE, expected UTF-8; `more.composite` is not a composite: the file is empty; `other.composite` is not a composite: the root element is `contribution`, expected `composite`
        fleet.composite: b:hall is faulty
        fleet.composite: a:gate -> deep/gate.composite
        hall.composite S0007
        deep/gate.composite S0103
    "#]]
    .assert_eq(&links(&files, "fleet.composite"));
}
