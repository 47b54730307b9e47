//! A state folder on a disk that becomes full: no new work is accepted, and what was accepted ends and stays durable.

use std::fs::{self, File};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use super::memory::{pieces, wait_for_pieces};
use super::state::crossing;
use crate::support::{PATIENCE, PROGRAM, Program, ask, assert_namespace_tools_are_installed, empty_folder};

/// Size of the disk: the log and one in its place need 8 MiB at first.
const SIZE: &str = "24m";
/// Pieces that are accepted before the disk is full.
const FIRST: u64 = 30;

/// A disk that only processes in its namespaces see. It is gone with this.
struct Disk {
    holder: Program,
    folder: PathBuf,
}

impl Disk {
    /// `None` where the machine allows no such thing.
    fn mount(folder: &Path) -> Option<Disk> {
        fs::create_dir_all(folder.join("disk")).unwrap();
        let script = format!("mount -t tmpfs -o size={SIZE} none disk && touch disk/mounted && exec sleep 1000");
        let mut unshare = Command::new("unshare");
        unshare.args(["--user", "--map-root-user", "--mount", "sh", "-c", &script]);
        let holder = unshare.current_dir(folder).stdout(Stdio::null()).stderr(Stdio::null()).spawn().ok()?;
        let mut disk = Disk { holder: Program(holder), folder: folder.to_owned() };
        while !disk.path("mounted").exists() {
            if disk.holder.0.try_wait().unwrap().is_some() {
                return None;
            }
            sleep(Duration::from_millis(5));
        }
        Some(disk)
    }

    /// A file on it, as processes outside see that.
    fn path(&self, file: &str) -> PathBuf {
        let root = format!("/proc/{}/root{}", self.holder.0.id(), self.folder.display());
        Path::new(&root).join("disk").join(file)
    }

    /// Takes all space that is left.
    fn fill(&self) {
        let mut file = File::create(self.path("filler")).unwrap();
        for block in [vec![0; 1 << 20], vec![0; 4096], vec![0; 1]] {
            while file.write(&block).is_ok_and(|written| written == block.len()) {}
        }
    }

    fn start(&self) -> Program {
        let _ = fs::remove_file(self.folder.join("socket"));
        let mut enter = Command::new("nsenter");
        enter.args(["--user", "--mount", "--preserve-credentials", "--target", &self.holder.0.id().to_string()]);
        enter.args(["sh", "-c", "cd \"$0\" && exec \"$@\""]).arg(&self.folder).arg(PROGRAM);
        enter.args(["run", "f.composite", "--state", "disk/state", "--stay", "--control", "socket"]);
        Program(enter.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap())
    }
}

/// Asks until the answer is what is wanted.
fn until(what: &str, mut is_so: impl FnMut() -> bool) {
    let end = Instant::now() + PATIENCE;
    while !is_so() {
        assert!(Instant::now() < end, "{what}");
        sleep(Duration::from_millis(50));
    }
}

#[test]
fn a_full_disk_keeps_what_was_accepted_and_refuses_more() {
    let folder = empty_folder("memory-full");
    let fleet = crossing().replace("at 0.1s 80 times luggage random to random", "at 0.1s luggage (1,1) to (2,2)");
    fs::write(folder.join("f.composite"), fleet).unwrap();
    let Some(disk) = Disk::mount(&folder) else {
        assert_namespace_tools_are_installed();
        println!("skipped: this machine lets nobody mount a disk in namespaces of his own");
        return;
    };
    let socket = folder.join("socket");
    let send = |line: &str| ask(&socket, "POST", "/v1/events", line);
    let mut program = disk.start();
    let (mut accepted, _) = wait_for_pieces(&mut program, &socket, 1);
    for number in 0..FIRST {
        send(&format!("luggage ({},{}) to (5,4)", number % 5, number % 4)).unwrap();
        accepted += 1;
    }
    disk.fill();
    let mut refusal = String::new();
    until("no new work is accepted", || match send("luggage (0,1) to (5,4)") {
        Ok(_) => {
            accepted += 1;
            false
        }
        Err(error) => {
            refusal = error.to_string();
            true
        }
    });
    assert!(refusal.contains("the disk of the state folder is full, so that no new work is accepted"), "{refusal}");
    let alerts = ask(&socket, "GET", "/v1/alerts", "").unwrap().to_string();
    assert!(alerts.contains("the disk of the state folder is almost full"), "{alerts}");
    // What was accepted ends, in the space that was reserved, and a crash changes nothing about that.
    until("all is delivered", || pieces(&socket).is_ok_and(|(_, open)| open == 0));
    for _ in 0..3 {
        drop(program);
        program = disk.start();
        assert_eq!(wait_for_pieces(&mut program, &socket, accepted), (accepted, 0));
        disk.fill();
        until("it is known that the disk is full", || {
            send("luggage (0,1) to (5,4)").is_err() || {
                accepted += 1;
                false
            }
        });
        until("all is delivered", || pieces(&socket).is_ok_and(|(_, open)| open == 0));
    }
    // Somebody makes space.
    fs::remove_file(disk.path("filler")).unwrap();
    until("new work is accepted again", || send("luggage (0,1) to (5,4)").is_ok());
    accepted += 1;
    until("it is delivered", || pieces(&socket).is_ok_and(|now| now == (accepted, 0)));
    until("the alert is over", || {
        let alerts = ask(&socket, "GET", "/v1/alerts", "").unwrap();
        let all = alerts.as_array().or(alerts["alerts"].as_array()).unwrap();
        all.iter().filter(|alert| alert["kind"] == "file").all(|alert| !alert["over_s"].is_null())
    });
}
