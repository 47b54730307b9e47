//! The command as its users start it, and the files of this repository.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};

/// The folder of the repository.
pub(crate) fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The text of a file of the repository.
pub(crate) fn project(path: &str) -> String {
    fs::read_to_string(root().join(path)).unwrap()
}

/// The composites in a folder and below it.
pub(crate) fn composites(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        match path.extension() {
            _ if path.is_dir() => found.extend(composites(&path)),
            Some(extension) if extension == "composite" => found.push(path),
            _ => {}
        }
    }
    found.sort();
    found
}

/// The shipped composites that are files by themselves, and not parts of a contribution.
pub(crate) fn shipped() -> Vec<PathBuf> {
    let mut found = composites(&root().join("composites"));
    found.retain(|path| !path.parent().unwrap().join("sca-contribution.xml").exists());
    assert!(found.len() >= 4, "{found:?}");
    found
}

/// An empty folder of this name, which stays there after the test.
pub(crate) fn empty_folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    folder
}

/// The program under test.
pub(crate) const PROGRAM: &str = env!("CARGO_BIN_EXE_saoms");

/// `saoms` in the folder of the repository.
pub(crate) fn command(arguments: &[&str]) -> Command {
    let mut command = Command::new(PROGRAM);
    command.args(arguments).current_dir(root());
    command
}

/// A program that does not outlive the test.
pub(crate) struct Program(pub(crate) Child);

impl Drop for Program {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// Runs `saoms` in the folder of the repository.
pub(crate) fn saoms(arguments: &[&str]) -> Output {
    saoms_in(root(), arguments)
}

/// Runs `saoms` in a folder.
pub(crate) fn saoms_in(folder: &Path, arguments: &[&str]) -> Output {
    command(arguments).current_dir(folder).output().unwrap()
}

/// Runs `saoms` in a folder with this text on standard input.
pub(crate) fn saoms_with(folder: &Path, arguments: &[&str], input: &[u8]) -> Output {
    fed(command(arguments).current_dir(folder), input)
}

/// Runs a command with this text on standard input.
pub(crate) fn fed(command: &mut Command, input: &[u8]) -> Output {
    let pipes = command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = pipes.spawn().unwrap();
    // A command that reads no input closes it.
    let _ = child.stdin.take().unwrap().write_all(input);
    child.wait_with_output().unwrap()
}

pub(crate) fn code(output: &Output) -> i32 {
    output.status.code().unwrap()
}

pub(crate) fn stdout(output: &Output) -> String {
    String::from_utf8(output.stdout.clone()).unwrap()
}

pub(crate) fn stderr(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}

/// Standard output, then standard error.
pub(crate) fn text(output: &Output) -> String {
    stdout(output) + &stderr(output)
}

/// Exit code, standard output and standard error.
pub(crate) fn answer(output: &Output) -> (i32, String, String) {
    (code(output), stdout(output), stderr(output))
}
