//! Which fleet is meant, and where its socket is.

use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::os::unix::net::UnixListener;

use super::{Running, fleet};
use crate::support::{command, text};

#[test]
fn without_a_fleet_or_with_several_the_error_says_what_there_is() {
    let folder = tempfile::tempdir().unwrap();
    let nobody = command(&["status"]).env("XDG_RUNTIME_DIR", folder.path()).output().unwrap();
    assert_eq!(nobody.status.code(), Some(2));
    assert!(text(&nobody).contains("no fleet runs on this machine"), "{}", text(&nobody));

    let running = Running::start(&fleet(), &[]);
    // A second one beside it.
    let mut other = command(&["run", "fleet.composite"]);
    other.current_dir(running.folder()).env("XDG_RUNTIME_DIR", running.folder());
    let mut other = other.stdout(std::process::Stdio::null()).spawn().unwrap();
    let other_pid = other.id().to_string();
    while !running.told(&["ps"]).contains(&other_pid) {
        std::thread::sleep(std::time::Duration::from_millis(10));
    }
    let several = running.refused(&["down"]);
    assert!(several.contains("several fleets run on this machine: `fleet-"), "{several}");
    let several = running.refused(&["down", "--fleet", "fleet"]);
    assert!(several.contains("several fleets have the name `fleet`"), "{several}");
    let unknown = running.refused(&["down", "--fleet", "flet"]);
    assert!(unknown.contains("no fleet `flet`; did you mean `fleet`?"), "{unknown}");
    running.told(&["down", "--fleet", &other_pid]);
    assert_eq!(other.wait().unwrap().code(), Some(0));
    running.told(&["down"]);
    assert_eq!(running.end().0, Some(0));
}

#[test]
fn the_socket_is_the_users_alone_and_replaces_no_file() {
    let running = Running::start(&fleet(), &[]);
    let folder = running.folder().join("saoms");
    assert_eq!(fs::metadata(&folder).unwrap().permissions().mode() & 0o777, 0o700);
    let socket = fs::read_dir(&folder).unwrap().next().unwrap().unwrap().path();
    assert_eq!(fs::metadata(&socket).unwrap().permissions().mode() & 0o777, 0o600);
    // The socket of a program that was killed is cleared away.
    drop(UnixListener::bind(folder.join("dead-1.sock")).unwrap());
    assert_eq!(running.told(&["ps"]).lines().count(), 2);
    assert!(!folder.join("dead-1.sock").exists());
    let refused = running.refused(&["run", "fleet.composite", "--control", "fleet.composite"]);
    assert!(refused.contains("a file that is not a socket is there"), "{refused}");
    assert_eq!(fs::read_to_string(running.folder().join("fleet.composite")).unwrap(), fleet());
    let refused = running.refused(&["run", "fleet.composite", "--control", socket.to_str().unwrap()]);
    assert!(refused.contains("another program listens there"), "{refused}");
    running.told(&["down", "--fleet", socket.to_str().unwrap()]);
    assert_eq!(running.end().0, Some(0));
}

#[test]
fn a_fleet_that_nobody_is_to_reach_has_no_socket() {
    for arguments in [&["--control", "none"][..], &["--virtual"]] {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("fleet.composite"), fleet()).unwrap();
        let mut run = command(&[&["run", "fleet.composite", "--for", "100ms"], arguments].concat());
        let output = run.current_dir(folder.path()).env("XDG_RUNTIME_DIR", folder.path()).output().unwrap();
        assert_eq!(output.status.code(), Some(0), "{}", text(&output));
        assert!(!folder.path().join("saoms").exists());
    }
}
