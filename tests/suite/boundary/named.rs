//! Composites that name the library of a class.

use std::fs;
use std::path::Path;

use tempfile::TempDir;

use super::build::library;
use super::run::{component, composite, saoms};

/// A component of a class in this library.
fn of_library(name: &str, class: &str, library: &str) -> String {
    component(name, class, "").replace("\"/><property", &format!("\" library=\"{library}\"/><property"))
}

/// A folder with `fleet/t.composite` with these components, and the library `good` at this place.
fn folder(components: &str, place: &str) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path().join(place);
    fs::create_dir_all(place.parent().unwrap()).unwrap();
    fs::create_dir_all(folder.path().join("fleet")).unwrap();
    fs::copy(library("good"), place).unwrap();
    fs::write(folder.path().join("fleet/t.composite"), composite(components)).unwrap();
    folder
}

const RUN: [&str; 5] = ["run", "fleet/t.composite", "--virtual", "--for", "450ms"];

/// Runs a fleet with a library that was named, and does not without.
fn runs(folder: &Path, library: &str) {
    let checked = saoms(folder, &["check", "fleet/t.composite"]);
    let expected = ["error[S3015]", "note[S3016]", "error[S0009]"];
    assert!(expected.iter().any(|one| checked.text.contains(one)), "{}", checked.text);
    let unnamed = saoms(folder, &RUN);
    assert_eq!(unnamed.code, Some(2), "{}", unnamed.text);
    let run = saoms(folder, &[&RUN[..], &["--plugin", library]].concat());
    assert_eq!(run.code, Some(0), "{}", run.text);
    assert!(run.text.contains("good.Sender") && run.text.contains(" 5 "), "{}", run.text);
}

fn refused(folder: &Path, expected: &[&str]) {
    let run = saoms(folder, &RUN);
    assert_eq!(run.code, Some(2), "{}", run.text);
    for expected in expected {
        assert!(run.text.contains(expected), "{expected} is missing in\n{}", run.text);
    }
}

#[test]
fn a_library_is_found_from_the_composite_and_by_the_search_path() {
    let one = |name: &str| of_library("A", "good.Sender", name);
    for (name, place) in [
        ("libmy_good.so", "fleet/libmy_good.so"),
        ("my_good", "fleet/libmy_good.so"),
        ("my-good", "fleet/libmy_good.so"),
        ("my_good.so", "fleet/libmy_good.so"),
        ("plain", "fleet/plain.so"),
        ("../built/my_good", "built/libmy_good.so"),
        ("my_good", "fleet/plugins/libmy_good.so"),
        ("my_good", "plugins/libmy_good.so"),
    ] {
        runs(folder(&one(name), place).path(), place);
    }
    let elsewhere = folder(&one("my_good"), "built/debug/libmy_good.so");
    runs(elsewhere.path(), "built/debug");
    runs(elsewhere.path(), "built/debug/libmy_good.so");
    refused(
        elsewhere.path(),
        &[
            "error[S3015]: there is no library `my_good`",
            "looked for `fleet/libmy_good.so`, `fleet/my_good.so`, `fleet/plugins/libmy_good.so`",
            "--plugin",
        ],
    );
}

#[test]
fn a_library_outside_the_folder_is_not_read() {
    let folder = folder(&of_library("A", "good.Sendr", "../built/good"), "built/libgood.so");
    let check = |more: &[&str]| saoms(folder.path(), &[&["check", "fleet/t.composite"], more].concat()).text;
    let told = check(&[]);
    assert!(told.contains("error[S0009]: this library is outside") && !told.contains("good.Keeper"), "{told}");
    fs::write(folder.path().join("fleet/t.composite"), composite(&of_library("A", "good.Sendr", "../built/none")))
        .unwrap();
    assert!(check(&[]).contains("error[S0009]: this library is outside"), "whether it is there is not revealed");
    let absolute = folder.path().join("built/libgood.so").display().to_string();
    fs::write(folder.path().join("fleet/t.composite"), composite(&of_library("A", "good.Sendr", &absolute))).unwrap();
    assert!(check(&[]).contains("error[S0009]: this library is outside"));
    for more in [&["--allow-outside"][..], &["--plugin", "built"], &["--plugin", &absolute]] {
        let told = check(more);
        assert!(told.contains("S3015") && told.contains("good.Keeper"), "{more:?}: {told}");
    }
}

#[test]
fn a_class_has_to_be_in_the_library_that_is_named() {
    let wrong = |class: &str, library: &str| folder(&of_library("A", class, library), "fleet/libgood.so");
    refused(
        wrong("good.Sendr", "good").path(),
        &[
            "error[S3015]: the library `fleet/libgood.so` has no class `good.Sendr`",
            "its classes are `good.Keeper`, `good.Reader`, `good.Sender` and `good.Spotter`",
            "replace `good.Sendr` with `good.Sender`",
        ],
    );
    refused(
        wrong("saoms.Robot", "good").path(),
        &["has no class `saoms.Robot`", "remove `library`: the class is part of this program"],
    );
    let two = wrong("elsewhere.Echo", "good");
    fs::copy(library("elsewhere"), two.path().join("fleet/libelse.so")).unwrap();
    refused(two.path(), &["has no class `elsewhere.Echo`", "the class is in `fleet/libelse.so`"]);
    let damaged = wrong("good.Sender", "text");
    fs::write(damaged.path().join("fleet/libtext.so"), "a text").unwrap();
    refused(damaged.path(), &["error[S3015]", "libtext.so` is not a shared library"]);
    let twice = wrong("good.Sender", "other/good");
    fs::create_dir(twice.path().join("fleet/other")).unwrap();
    fs::copy(library("good"), twice.path().join("fleet/other/libgood.so")).unwrap();
    refused(
        twice.path(),
        &["class `good.Sender` is registered twice: in plugin `fleet/libgood.so` and in plugin \
            `fleet/other/libgood.so`"],
    );
}

#[test]
fn a_composite_in_a_composite_names_its_library_from_its_own_folder() {
    let outer = component("Hall", "x", "")
        .replace("<implementation.rust class=\"x\"/>", "<implementation.composite name=\"inner\"/>");
    let outer = &outer[..outer.find("<property").unwrap()];
    let folder = folder(&format!("{outer}</component>\n"), "fleet/parts/good.so");
    let inner = composite(&of_library("A", "good.Sender", "good")).replace("name=\"t\"", "name=\"inner\"");
    fs::write(folder.path().join("fleet/parts/inner.composite"), inner).unwrap();
    runs(folder.path(), "fleet/parts");
    let shown = saoms(folder.path(), &["expand", "fleet/t.composite"]);
    assert!(shown.code == Some(0) && shown.text.contains("library=\"parts/good.so\""), "{}", shown.text);
    // What was expanded runs as well, beside the composite that it was.
    fs::write(folder.path().join("fleet/all.composite"), &shown.text).unwrap();
    let run =
        saoms(folder.path(), &["run", "fleet/all.composite", "--virtual", "--for", "450ms", "--plugin", "fleet/parts"]);
    assert_eq!(run.code, Some(0), "{}", run.text);
}

#[test]
fn other_commands_know_the_libraries_too() {
    let folder = folder(&of_library("A", "good.Sender", "good"), "fleet/libgood.so");
    let check = saoms(folder.path(), &["check", "fleet/t.composite", "--format", "json"]);
    assert_eq!(check.code, Some(0), "{}", check.text);
    let graph = saoms(folder.path(), &["graph", "fleet/t.composite", "--format", "mermaid"]);
    assert!(graph.code == Some(0) && graph.text.contains("READINGS"), "{}", graph.text);
    let formatted = saoms(folder.path(), &["fmt", "fleet/t.composite"]);
    let text = fs::read_to_string(folder.path().join("fleet/t.composite")).unwrap();
    assert!(formatted.code == Some(0) && text.contains("library=\"good\""), "{text}");
    fs::remove_file(folder.path().join("fleet/libgood.so")).unwrap();
    let check = saoms(folder.path(), &["check", "fleet/t.composite", "--format", "json"]);
    assert!(check.code == Some(2) && check.text.contains("\"S3015\""), "{}", check.text);
}
