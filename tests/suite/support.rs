//! The command as its users start it, and the files of this repository.

use std::fs;
use std::io::{self, Read, Write};
use std::os::unix::net::UnixStream;
use std::os::unix::process::CommandExt;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::thread;
use std::time::Duration;

use serde_json::Value;

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

/// Time within which a program answers that starts.
pub(crate) const PATIENCE: Duration = Duration::from_secs(30);

/// Sends a request to a program over its socket, whose answer the stream has.
pub(crate) fn send(socket: &Path, method: &str, path: &str, body: &str) -> io::Result<UnixStream> {
    let mut stream = UnixStream::connect(socket)?;
    let length = body.len();
    let head = format!("{method} {path} HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\nContent-Length: {length}");
    stream.write_all(format!("{head}\r\n\r\n{body}").as_bytes())?;
    Ok(stream)
}

/// Sends a request to a program over its socket; gives the body of the answer, if one came as a whole.
pub(crate) fn ask(socket: &Path, method: &str, path: &str, body: &str) -> io::Result<Value> {
    let mut stream = send(socket, method, path, body)?;
    stream.set_read_timeout(Some(PATIENCE))?;
    let mut answer = String::new();
    stream.read_to_string(&mut answer)?;
    let (head, body) = answer.split_once("\r\n\r\n").ok_or(io::ErrorKind::UnexpectedEof)?;
    if !head.starts_with("HTTP/1.1 200") {
        return Err(io::Error::other(answer));
    }
    Ok(serde_json::from_str(body)?)
}

/// Sets what a process does on a hangup. Who starts the tests may ignore hangups, as `nohup` does, and processes
/// inherit that.
pub(crate) fn on_hangup(run: &mut Command, action: libc::sighandler_t) {
    // SAFETY: the call between fork and exec is one that signal handlers may make.
    unsafe {
        run.pre_exec(move || {
            libc::signal(libc::SIGHUP, action);
            Ok(())
        });
    }
}

/// Runs `saoms` in the folder of the repository.
pub(crate) fn saoms(arguments: &[&str]) -> Output {
    saoms_in(root(), arguments)
}

/// Runs `saoms` in a folder.
pub(crate) fn saoms_in(folder: &Path, arguments: &[&str]) -> Output {
    let mut run = command(arguments);
    run.current_dir(folder).stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    output_of(run.spawn().unwrap())
}

/// Longest time that a test waits for a command to end by itself.
const LONGEST: Duration = Duration::from_secs(300);

/// The output of a command once it has ended. One that does not end is killed: what it told until then is in the
/// output.
pub(crate) fn output_of(child: Child) -> Output {
    let process = child.id().cast_signed();
    let (ends, ended) = channel::<()>();
    let watch = thread::spawn(move || {
        if ended.recv_timeout(LONGEST) == Err(RecvTimeoutError::Timeout) {
            // SAFETY: a system call without pointers. The process is a child that nobody has waited for to its end.
            unsafe { libc::kill(process, libc::SIGKILL) };
        }
    });
    let output = child.wait_with_output().unwrap();
    drop(ends);
    watch.join().unwrap();
    output
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
    output_of(child)
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

/// To be called where namespaces cannot be made, before a test is skipped: what is not installed can be, and is
/// required with `SAOMS_PEERS=required`; what a container forbids cannot be helped.
pub(crate) fn assert_namespace_tools_are_installed() {
    let looks = "for tool in unshare nsenter mount ip; do command -v $tool || exit 1; done";
    let are_installed = Command::new("sh").args(["-c", looks]).stdout(Stdio::null()).status().unwrap().success();
    let are_required = std::env::var("SAOMS_PEERS").as_deref() == Ok("required");
    assert!(are_installed || !are_required, "`unshare`, `nsenter`, `mount` or `ip` is not installed");
}
