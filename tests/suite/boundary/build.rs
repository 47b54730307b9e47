//! The libraries of `tests/plugins`, built once.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;
use std::{env, fs};

use crate::support::root;

/// The library of this name.
pub(crate) fn library(name: &str) -> PathBuf {
    built().join(format!("libtest_{name}.so"))
}

/// The folder with all libraries.
fn built() -> &'static Path {
    static BUILT: OnceLock<PathBuf> = OnceLock::new();
    BUILT.get_or_init(|| {
        let target = Path::new(env!("CARGO_BIN_EXE_saoms")).parent().unwrap().parent().unwrap();
        let folder = target.join("test-plugins");
        let (sources, other) = (folder.join("source"), folder.join("other"));
        copy(&root().join("tests/plugins"), &sources, &|text| {
            let text = text.replace("@ROOT@", root().to_str().unwrap());
            text.replace("@OTHER@", other.to_str().unwrap())
        });
        // The same versions as here, so that nothing has to be fetched.
        copy_file(&root().join("Cargo.lock"), &sources.join("Cargo.lock"), &str::to_owned);
        copy_of_api(&other);
        let cargo = |arguments: &[&str]| {
            let output = Command::new(env::var_os("CARGO").unwrap_or_else(|| "cargo".into()))
                .args(arguments)
                .envs([("CARGO_TARGET_DIR", folder.join("target").as_os_str()), ("CARGO_NET_OFFLINE", "true".as_ref())])
                .current_dir(&sources)
                .output()
                .unwrap();
            assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        };
        cargo(&["build", "--workspace", "--exclude", "test-aborts"]);
        // What `panic = "abort"` in a profile hands to the compiler, for one crate.
        cargo(&["rustc", "-p", "test-aborts", "--", "-C", "panic=abort"]);
        folder.join("target/debug")
    })
}

/// `saoms-api` and the crates that it needs, with another version in another folder.
fn copy_of_api(folder: &Path) {
    let manifest = |text: &str| {
        let mut lines: Vec<String> = Vec::new();
        for line in text.lines() {
            match line {
                "[dev-dependencies]" | "[[bench]]" | "[lints]" => break,
                "version.workspace = true" => lines.push("version = \"0.1.99\"".to_owned()),
                _ => lines.push(line.to_owned()),
            }
        }
        lines.join("\n") + "\n"
    };
    let workspace = fs::read_to_string(root().join("Cargo.toml")).unwrap();
    let (_, package) = workspace.split_once("[workspace.package]").unwrap();
    let (package, _) = package.split_once("\n[workspace.lints").unwrap();
    let package = package.replace("version = \"0.1.0\" }", "version = \"0.1.99\" }");
    let members = "[workspace]\nmembers = [\"saoms-abi\", \"saoms-api\", \"saoms-derive\"]\n\n[workspace.package]";
    write(&folder.join("Cargo.toml"), &format!("{members}{package}\n"));
    for name in ["saoms-abi", "saoms-api", "saoms-derive"] {
        let (from, to) = (root().join(name).join("src"), folder.join(name).join("src"));
        remove_what_left(&from, &to);
        copy(&from, &to, &str::to_owned);
        copy_file(&root().join(name).join("Cargo.toml"), &folder.join(name).join("Cargo.toml"), &manifest);
    }
}

fn copy(from: &Path, to: &Path, change: &dyn Fn(&str) -> String) {
    for entry in fs::read_dir(from).unwrap() {
        let path = entry.unwrap().path();
        let to = to.join(path.file_name().unwrap());
        if path.is_dir() { copy(&path, &to, change) } else { copy_file(&path, &to, change) }
    }
}

fn copy_file(from: &Path, to: &Path, change: &dyn Fn(&str) -> String) {
    write(to, &change(&fs::read_to_string(from).unwrap()));
}

/// Removes from an earlier copy what its origin does not have any more.
fn remove_what_left(from: &Path, to: &Path) {
    for entry in fs::read_dir(to).into_iter().flatten() {
        let copied = entry.unwrap().path();
        let origin = from.join(copied.file_name().unwrap());
        match (copied.is_dir(), origin.is_dir()) {
            (true, true) => remove_what_left(&origin, &copied),
            (true, false) => fs::remove_dir_all(&copied).unwrap(),
            (false, _) if !origin.is_file() => fs::remove_file(&copied).unwrap(),
            (false, _) => {}
        }
    }
}

/// Writes what is new, so that the rest is not built again.
fn write(path: &Path, text: &str) {
    if fs::read_to_string(path).is_ok_and(|present| present == text) {
        return;
    }
    fs::create_dir_all(path.parent().unwrap()).unwrap();
    fs::write(path, text).unwrap();
}

/// The library `actor` of `tests/plugins/c` with these definitions, in a folder.
pub(crate) fn c_library(folder: &Path, definitions: &[&str]) -> PathBuf {
    c_library_of("actor", folder, definitions)
}

/// A library of `tests/plugins/c` with these definitions, in a folder.
pub(crate) fn c_library_of(name: &str, folder: &Path, definitions: &[&str]) -> PathBuf {
    let library = folder.join(format!("lib{name}.so"));
    let source = root().join(format!("tests/plugins/c/{name}.c"));
    let mut cc = Command::new("cc");
    cc.args([
        "-std=gnu99", "-O1", "-shared", "-fPIC", "-fvisibility=hidden", "-Wno-overlength-strings", "-pthread", "-I",
    ]);
    cc.arg(root().join("saoms-abi/include")).arg("-o").args([&library, &source]);
    cc.arg("-lm");
    let output = cc.args(definitions.iter().map(|one| format!("-D{one}"))).output().unwrap();
    assert!(output.status.success(), "{cc:?}: {}", String::from_utf8_lossy(&output.stderr));
    library
}
