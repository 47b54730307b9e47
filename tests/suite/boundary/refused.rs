//! Libraries that are refused: each with one message, exit code 2, and nothing started.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use proptest::prelude::*;
use saoms_core::plugin::Plugin;

use super::build::library;
use super::run::{component, in_folder, property, saoms};

/// The output of a fleet with a component of `good` when this library is named.
fn refused_with(path: &Path, components: &str) -> String {
    let folder = in_folder(components);
    let arguments =
        ["run", "t.composite", "--virtual", "--for", "1s", "--report", "-", "--plugin", path.to_str().unwrap()];
    let run = saoms(folder.path(), &arguments);
    assert_eq!(run.code, Some(2), "{}", run.text);
    assert!(!run.text.contains("\"components\""), "something ran:\n{}", run.text);
    let errors = run.text.lines().filter(|line| line.starts_with("error"));
    assert_eq!(errors.count(), 1, "{}", run.text);
    run.text
}

fn refused(path: &Path) -> String {
    refused_with(path, &component("A", "good.Sender", ""))
}

/// The library `good` with other bytes.
fn changed(name: &str, change: impl FnOnce(&mut Vec<u8>)) -> PathBuf {
    let mut bytes = fs::read(library("good")).unwrap();
    change(&mut bytes);
    let path = folder().join(name);
    fs::write(&path, bytes).unwrap();
    path
}

/// The folder where libraries are written. Other tests have their composites beside it, and would find libraries there.
fn folder() -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("refused");
    fs::create_dir_all(&folder).unwrap();
    folder
}

/// The library `good` with another text in its metadata, where `from` is first.
fn said(name: &str, from: &str, to: &[u8]) -> PathBuf {
    assert_eq!(from.len(), to.len());
    let find = |bytes: &[u8], part: &[u8]| bytes.windows(part.len()).position(|one| one == part);
    changed(name, |bytes| {
        let start = find(bytes, b"{\"saoms\":\"plugin\"").unwrap();
        let place = start + find(&bytes[start..], from.as_bytes()).unwrap();
        bytes[place..place + to.len()].copy_from_slice(to);
    })
}

/// A library from C, with these metadata and these arguments more.
fn from_c(name: &str, metadata: Option<&str>, more: &[&str]) -> PathBuf {
    let folder = folder();
    let (source, path) = (folder.join(format!("{name}.c")), folder.join(format!("{name}.so")));
    let text = metadata.map_or_else(String::new, |text| {
        let text = text.replace('"', "\\\"");
        format!("__attribute__((section(\".saoms.plugin\"), used)) static const char text[] = \"{text}\";\n")
    });
    fs::write(&source, text + "int something(void) { return 1; }\n").unwrap();
    let mut cc = Command::new("cc");
    cc.args(["-shared", "-fPIC", "-o"]).args([&path, &source]).args(more).current_dir(&folder);
    let output = cc.output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    path
}

fn assert_says(text: &str, parts: &[&str]) {
    for part in parts {
        assert!(text.contains(part), "{part} is missing in\n{text}");
    }
}

#[test]
fn what_is_no_library() {
    let folder = tempfile::tempdir().unwrap();
    let text = folder.path().join("libtext.so");
    fs::write(&text, "a text").unwrap();
    assert_says(&refused(&text), &["libtext.so` is not a shared library", "cdylib"]);
    fs::write(&text, "").unwrap();
    assert_says(&refused(&text), &["is not a shared library"]);
    assert_says(&refused(Path::new(env!("CARGO_BIN_EXE_saoms"))), &["has no section `.saoms.plugin`"]);
    fs::remove_file(&text).unwrap();
    assert_says(&refused(&text), &["libtext.so` cannot be read: No such file"]);
    assert_says(&refused(folder.path()), &["there is no library (`*.so`) in this folder"]);
    assert!(Command::new("mkfifo").arg(&text).status().unwrap().success());
    assert_says(&refused(&text), &["cannot be read: it is neither a file nor a folder"]);
    assert_says(&refused(Path::new("/proc/self/mem")), &["/proc/self/mem` cannot be read"]);
}

#[test]
fn a_library_for_another_machine() {
    let other = if cfg!(target_arch = "aarch64") { (62, "x86_64") } else { (183, "aarch64") };
    let path = changed("machine.so", |bytes| bytes[18..20].copy_from_slice(&[other.0, 0]));
    assert_says(&refused(&path), &[&format!("was built for {}, this program runs on", other.1), "--target"]);
    let path = changed("narrow.so", |bytes| bytes[4] = 1);
    assert_says(&refused(&path), &["was built for a 32-bit machine"]);
}

#[test]
fn a_library_without_metadata_or_with_damaged_ones() {
    assert_says(&refused(&from_c("bare", None, &[])), &["bare.so` has no section", "plugin!"]);
    for (name, from, to, expected) in [
        ("brace.so", "{\"saoms\"", b"x\"saoms\"".as_slice(), "expected value at line 1 column 1"),
        ("bytes.so", "\"plugin\"", b"\"\xff\xfe\xfd\xfc\xfb\xfa\"", "they are not text"),
        ("other.so", "\"plugin\"", b"\"plugon\"", "found `plugon` for `saoms`, expected `plugin`"),
        ("entry.so", "\"entry\":", b"\"antry\":", "missing field `entry`"),
        ("list.so", "\"classes\":[", b"\"classes\":{", "key must be a string"),
    ] {
        let said = refused(&said(name, from, to));
        assert_says(&said, &["has metadata that cannot be read: ", expected]);
    }
    let path = said("kind.so", "\"periodic\"", b"\"peliodic\"");
    assert_says(&refused(&path), &["kind.so", "class `good.Sender` is malformed", "peliodic"]);
    let path = said("severity.so", "\"warning\"", b"\"warming\"");
    assert_says(&refused(&path), &["found the severity `warming`, expected `note`, `warning` or `error`"]);
}

#[test]
fn a_library_with_names_that_steer_the_terminal() {
    // Escapes in JSON, and in C around it.
    for (name, from, to, shown) in [
        ("class", "good.Sender", "good\\\\u001b[2J", "`good\\u{1b}[2J` (class)"),
        ("package", "from-c", "from\u{202e}c", "`from\\u{202e}c` (package)"),
        ("line", "good.Sender", "good\\\\nerror: no", "`good\\nerror: no` (class)"),
        (
            "property",
            "\"periodic\"",
            "\"periodic\",\"properties\":[{\"name\":\"a\\\\u0007\",\"type\":\"string\"}]",
            "`a\\u{7}` (name)",
        ),
    ] {
        let path = from_c(&format!("steers-{name}"), Some(&METADATA.replacen(from, to, 1)), &[]);
        let said = refused(&path);
        assert_says(&said, &["has metadata that cannot be read: the name ", shown, "choose another name"]);
        assert!(!said.contains(['\u{1b}', '\u{202e}', '\u{7}']), "{said}");
    }
}

#[test]
fn a_library_with_a_name_without_end() {
    let long = "n".repeat(100_000);
    let path = from_c("long", Some(&METADATA.replacen("good.Sender", &long, 1)), &[]);
    let said = refused(&path);
    assert_says(
        &said,
        &["metadata that cannot be read: the name `nnn", "(class) has 100000 bytes, expected at most 1000"],
    );
    assert!(said.len() < 1000, "{} bytes", said.len());
    let listed = saoms(&folder(), &["components", "--plugin", path.to_str().unwrap()]);
    assert_eq!(listed.code, Some(2), "{}", listed.text);
    assert_says(&listed.text, &["has 100000 bytes"]);
}

#[test]
fn a_library_for_an_older_or_newer_boundary() {
    let expected = ["this program has version 3", "build the plugin with saoms-api"];
    let path = said("older.so", "\"abi\":3", b"\"abi\":1");
    assert_says(&refused(&path), &[&["was built for the older version 1 of the boundary"], &expected[..]].concat());
    let path = said("newer.so", "\"abi\":3", b"\"abi\":9");
    assert_says(&refused(&path), &[&["was built for the newer version 9 of the boundary"], &expected[..]].concat());
}

#[test]
fn a_library_whose_panics_abort() {
    let components = component("A", "aborts.Quiet", "");
    let said = refused_with(&library("aborts"), &components);
    assert_says(&said, &["was built with `panic = \"abort\"`", "the Cargo.toml of `test-aborts`"]);
}

#[test]
fn a_name_that_is_registered_twice() {
    let folder = in_folder(&component("A", "good.Sender", ""));
    let (one, other) = (folder.path().join("libone.so"), folder.path().join("libother.so"));
    for path in [&one, &other] {
        fs::copy(library("good"), path).unwrap();
    }
    let run = saoms(folder.path(), &["run", "t.composite", "--virtual"]);
    assert_eq!(run.code, Some(2), "{}", run.text);
    assert_says(
        &run.text,
        &["class `good.Sender` is registered twice: in plugin `./libone.so` and in plugin `./libother.so`"],
    );
    assert_eq!(run.text.matches("error").count(), 1, "{}", run.text);
    let path = said("built-in.so", "good.Sender", b"saoms.Robot");
    let expected = "class `saoms.Robot` is registered twice: in this program and in plugin";
    assert_says(&refused(&path), &[expected, "built-in.so`"]);
}

#[test]
fn a_constructor_that_fails() {
    let refused = |library: PathBuf, class: &str, values: &str| refused_with(&library, &component("A", class, values));
    let limits = property("limits", "none");
    assert_says(&refused(library("good"), "good.Sender", &limits), &["S3014", "expected `least to most`"]);
    let at = property("at", "new");
    assert_says(&refused(library("bad"), "bad.Actor", &at), &["S3014", "panicked at", "no more of new"]);
    let does = |text| property("does", text);
    let said = refused(library("raw"), "raw.Actor", &does("refuses in bytes"));
    assert_says(&said, &["S3014", "\u{fffd}\u{fffd}x"]);
    let said = refused(library("raw"), "raw.Actor", &does("refuses without a word"));
    assert_says(&said, &["S3014", "failed without a message"]);
}

const METADATA: &str = r#"{"saoms":"plugin","abi":3,"package":"from-c","entry":"enter","classes":[{"contract":1,"class":"good.Sender","kind":"periodic"}]}"#;

#[test]
fn a_library_that_lacks_another_library() {
    from_c("libnotthere", None, &[]);
    let path = from_c("lacking", Some(METADATA), &["-Wl,--no-as-needed", "-L.", "-lnotthere"]);
    fs::remove_file(path.with_file_name("libnotthere.so")).unwrap();
    let said = refused(&path);
    assert_says(&said, &["lacking.so` (from-c) cannot be loaded: ", "libnotthere.so", "No such file"]);
}

#[test]
fn a_library_whose_code_is_not_what_its_metadata_say() {
    let path = from_c("empty", Some(METADATA), &[]);
    assert_says(&refused(&path), &["empty.so` (from-c) cannot be loaded: it has no function `enter`"]);
    let path = from_c("foreign", Some(&METADATA.replace("\"enter\"", "\"_exit\"")), &["-Wl,--no-as-needed", "-lc"]);
    assert_says(&refused(&path), &["it has no function `_exit`: it is one of another library"]);
    let path = said("entry2.so", "saoms_plugin_test_good", b"saoms_plugin_test_bood");
    assert_says(&refused(&path), &["it has no function `saoms_plugin_test_bood`"]);
}

#[test]
fn a_library_that_nobody_named_is_left_out_with_a_warning() {
    let folder = in_folder(&component("A", "good.Sender", ""));
    fs::copy(library("good"), folder.path().join("libgood.so")).unwrap();
    fs::create_dir(folder.path().join("plugins")).unwrap();
    fs::copy(library("aborts"), folder.path().join("plugins/libaborts.so")).unwrap();
    fs::write(folder.path().join("libtext.so"), "a text").unwrap();
    let run = saoms(folder.path(), &["run", "t.composite", "--virtual", "--for", "1s", "--plugin", "libgood.so"]);
    assert_eq!(run.code, Some(0), "{}", run.text);
    assert_says(&run.text, &["warning: plugin `./plugins/libaborts.so` was built with"]);
    assert!(!run.text.contains("libtext"), "{}", run.text);
    // Of one that is in order, no code runs, and its rules do not judge.
    let check = saoms(folder.path(), &["check", "t.composite"]);
    assert_eq!(check.code, Some(0), "{}", check.text);
    assert_says(
        &check.text,
        &["warning: plugin `./libgood.so` was found, but no option names it: its rules", "note[S3016]"],
    );
}

/// Reads what a file with these bytes offers. No part of it may be loaded.
fn opened(bytes: &[u8]) -> Result<(), String> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("libcut.so");
    fs::write(&path, bytes).unwrap();
    let result = Plugin::open(&path).map(drop).map_err(|error| error.to_string());
    let maps = fs::read_to_string("/proc/self/maps").unwrap();
    assert!(!maps.contains("libcut.so"), "it was loaded");
    if let Err(message) = &result {
        assert!(message.contains("libcut.so") && message.len() < 1000, "{message}");
    }
    result
}

#[test]
fn a_library_that_is_cut_off() {
    let bytes = fs::read(library("good")).unwrap();
    assert_eq!(opened(&bytes), Ok(()));
    for length in (0..200).chain((200..bytes.len()).step_by(bytes.len() / 50)).chain([bytes.len() - 1]) {
        assert!(opened(&bytes[..length]).is_err(), "{length} bytes of {} are a library", bytes.len());
    }
    let path = changed("cut.so", |bytes| bytes.truncate(bytes.len() / 2));
    assert_says(&refused(&path), &["cut.so` is damaged or cut off", "build or copy it again"]);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn damaged_headers_never_panic(changes in prop::collection::vec((0_usize..1200, any::<u8>()), 1..12), at_end: bool) {
        let mut bytes = fs::read(library("good")).unwrap();
        for (place, byte) in changes {
            // Headers are at the beginning, those of sections at the end.
            let place = if at_end { bytes.len() - 1 - place } else { place };
            bytes[place] = byte;
        }
        let _ = opened(&bytes);
    }
}
