//! Whatever a file holds, no command takes more than 16 MB and 20 times its size for it.
//!
//! Measured is the memory of the whole process at its peak, beyond that of the same command with a small file of the
//! same kind: what the program itself takes differs from build to build, by the pages of its code that the system maps.

#![cfg(target_os = "linux")]
#![expect(clippy::unwrap_used, reason = "helpers of tests, outside test functions")]

use std::fs;
use std::process::{Command, Stdio};

/// The part of the 16 MB beside the program itself.
const ROOM: usize = 4_500_000;

/// The memory of a command at its peak, in bytes.
#[expect(clippy::zombie_processes, reason = "it is waited for in the way that says what it took")]
fn peak(arguments: &[&str], text: &str) -> usize {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.composite");
    fs::write(&path, text).unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_saoms"));
    command.args(arguments).arg(&path).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    let child = command.spawn().unwrap();
    let pid = libc::pid_t::try_from(child.id()).unwrap();
    let mut status = 0;
    // SAFETY: both pointers are to memory of their types, and no other thread waits for this child.
    let usage = unsafe {
        let mut usage: libc::rusage = std::mem::zeroed();
        assert_eq!(libc::wait4(pid, &raw mut status, 0, &raw mut usage), pid);
        usage
    };
    assert!(libc::WIFEXITED(status), "{arguments:?} crashed");
    assert!([0, 1, 2].contains(&libc::WEXITSTATUS(status)), "{arguments:?}");
    usize::try_from(usage.ru_maxrss).unwrap() * 1024
}

const HEAD: &str = "<composite xmlns='http://docs.oasis-open.org/ns/opencsa/sca/200912' name='c' targetNamespace='u'>";

fn composite(parts: impl Iterator<Item = String>) -> String {
    format!("{HEAD}{}</composite>", parts.collect::<String>())
}

fn component(name: &str, class: &str, properties: &[(&str, &str)], more: &str) -> String {
    let properties: String = [("ID", name), ("period", "9")]
        .iter()
        .chain(properties)
        .map(|(name, value)| format!("<property name='{name}'>{value}</property>"))
        .collect();
    format!("<component name='{name}'><implementation.java class='{class}'/>{properties}{more}</component>")
}

/// Robots each of which has topics of its own.
fn apart(count: usize) -> String {
    composite((1..=count).map(|number| {
        let topics = ["RLMSTOPIC", "ELMSTOPIC", "RMSTOPIC", "POSTOPIC", "CSMSTOPIC"];
        let renamed = topics.map(|topic| format!("{topic},{topic}{number}")).join("::");
        component(&format!("R{number}"), "saoms.Robot", &[("topicRename", &renamed)], "")
    }))
}

/// Large worlds, with a robot in each.
fn worlds(count: usize) -> String {
    composite((1..=count).map(|number| {
        let side = [("width", "2000"), ("height", "2000"), ("blocked", "(1900,1900)")];
        let world = format!("<reference name='world' target='W{number}'/>");
        component(&format!("W{number}"), "saoms.World", &side, "")
            + &component(&format!("R{number}"), "saoms.Robot", &[], &world)
    }))
}

/// Luggage that goes around a wall.
fn walled(side: &str, wall: usize) -> String {
    let wall: String = (0..wall).map(|x| format!("<value>({x},30)</value>")).collect();
    let blocked = format!("<property name='blocked' many='true'>{wall}</property>");
    let side = [("width", side), ("height", side)];
    composite(
        [
            component("World", "saoms.World", &side, &blocked),
            component("M", "saoms.MasterEnvironment", &[], ""),
            component("E", "saoms.Environment", &[("scenario", "at 1s luggage (3,4) to (7,50)")], ""),
            component("R1", "saoms.Robot", &[], "<reference name='world' target='World'/>"),
        ]
        .into_iter(),
    )
}

/// Bytes that a command may take: 20 times the file and 4 kB a component, beside its own room.
fn limit(text: &str) -> usize {
    ROOM + 20 * text.len() + 4_000 * text.matches("<component").count()
}

#[test]
fn commands_by_the_size_of_their_file() {
    let deep = |count: usize| "<a>".repeat(count) + &"</a>".repeat(count);
    let many = |count: usize, part: &str| composite((0..count).map(|_| part.to_owned()));
    let formats: &[&[&str]] = &[&["check"], &["check", "--format=json"], &["check", "--format=sarif"]];
    let cases: [(&str, &[&[&str]], String, String); 5] = [
        (
            "topics",
            &[
                &["check", "--wiring"],
                &["check", "--wiring", "--format=json"],
                &["check", "--wiring", "--format=sarif"],
            ],
            apart(1000),
            apart(2),
        ),
        ("worlds", &[&["check"]], worlds(60), walled("60", 2)),
        ("components of one name", formats, many(20_000, "<component name='x'/>"), many(2, "<component name='x'/>")),
        ("a wall", &[&["check"]], walled("1100", 60), walled("60", 2)),
        ("deep elements", &[&["fmt"], &["fmt", "--check"]], deep(60_000), deep(2)),
    ];
    for (what, commands, text, small) in cases {
        for arguments in commands {
            let limit = limit(&text);
            // Pages of the program itself that the system maps ahead of their use differ from run to run by half a
            // megabyte.
            let measured = (0..5).map(|_| {
                let own = peak(arguments, &small);
                peak(arguments, &text).saturating_sub(own)
            });
            let mut least = usize::MAX;
            let within = measured.inspect(|taken| least = least.min(*taken)).find(|taken| *taken <= limit);
            let taken = within.unwrap_or(least);
            let size = text.len();
            println!("{what}: {arguments:?} takes {taken} bytes for {size} of the file, {limit} at most");
            assert!(
                taken <= limit,
                "{what}: {arguments:?} takes {taken} bytes for {size} of the file, {limit} at most"
            );
        }
    }
}
