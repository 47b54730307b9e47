//! What `saoms --version` says of the build: the commit of the sources, the target and the profile.

#![allow(clippy::print_stdout, reason = "this is how a build script speaks with cargo")]

use std::env;
use std::path::{Path, PathBuf};
use std::process::Command;

/// What sets the commit, for who builds a package from an archive.
const GIVEN: &str = "SAOMS_COMMIT";

/// What `cargo package` writes into an archive.
const PACKAGED: &str = ".cargo_vcs_info.json";

/// The digits of a commit that are shown.
const DIGITS: usize = 12;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-env-changed={GIVEN}");
    let value = |name: &str| env::var(name).unwrap_or_default();
    let (target, profile) = (value("TARGET"), value("PROFILE"));
    let root = PathBuf::from(value("CARGO_MANIFEST_DIR"));
    let is_given = |commit: &String| !commit.is_empty();
    let commit = env::var(GIVEN).ok().filter(is_given).or_else(|| packaged(&root));
    // In a debug build, each commit would have the program built and linked once more.
    let commit = match commit {
        None if profile == "debug" => "not noted in a debug build".to_owned(),
        found => found.or_else(|| of_git(&root)).unwrap_or_else(|| "unknown".to_owned()),
    };
    println!("cargo::rustc-env=SAOMS_BUILD_COMMIT={commit}");
    println!("cargo::rustc-env=SAOMS_BUILD_TARGET={target}, {profile}");
}

/// The commit that `cargo package` noted.
fn packaged(root: &Path) -> Option<String> {
    let text = std::fs::read_to_string(root.join(PACKAGED)).ok()?;
    let (_, commit) = text.split_once("\"sha1\": \"")?;
    let digits = commit.chars().take(DIGITS).collect::<String>();
    Some(if text.contains("\"dirty\": true") { digits + "+changes" } else { digits })
}

/// The commit of the checkout; `None` without git or its folder: a repository around a copy of the sources has commits
/// of its own.
fn of_git(root: &Path) -> Option<String> {
    if !root.join(".git").exists() {
        return None;
    }
    let git = |arguments: &[&str]| {
        let output = Command::new("git").args(arguments).current_dir(root).output().ok()?;
        let text = String::from_utf8(output.stdout).ok()?;
        output.status.success().then(|| text.trim().to_owned())
    };
    // The log changes with each commit and checkout. What is compiled into the program decides on `+changes`.
    let log = ["HEAD", "logs/HEAD"].into_iter().filter_map(|name| git(&["rev-parse", "--git-path", name]));
    let entries = std::fs::read_dir(root).into_iter().flatten().flatten().map(|entry| entry.file_name());
    let sources = entries.filter_map(|name| name.into_string().ok());
    let sources = sources.filter(|name| name == "src" || name == "Cargo.toml" || name.starts_with("saoms-"));
    for path in log.chain(sources).filter(|path| root.join(path).exists()) {
        println!("cargo::rerun-if-changed={path}");
    }
    git(&["describe", "--always", "--exclude=*", &format!("--abbrev={DIGITS}"), "--dirty=+changes"])
}
