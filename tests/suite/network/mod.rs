//! Fleets in several programs: real processes over loopback, and what happens to processes and lines.

mod access;
mod borders;
mod broken;
mod brokers;
mod calls;
mod certificates;
mod errors;
mod foreign;
mod full;
mod hardware;
mod leases;
mod library;
mod lines;
mod links;
mod lost;
mod namespace;
mod nodes;
mod operators;
mod passwords;
mod peers;
mod places;
mod programs;
mod proxy;
mod python;
mod returns;
mod routers;
mod secrets;
mod sockets;
mod state;
mod tls;
mod together;
mod topics;
mod twice;
mod versions;

use std::sync::Arc;
use std::time::Duration;

use programs::{Given, Program, Programs};

/// Number of events of each sender over an outage, in tenths of seconds with a thousand each.
const MANY: &str = "100000";
/// The most memory that a program takes for them: they are kept while others cannot receive them.
const MOST_MEMORY: u64 = 500 << 20;
/// Time for which brokers and links are away, and for which programs are stopped.
const AWAY: Duration = Duration::from_secs(10);
const STOPPED: Duration = Duration::from_secs(20);

/// Two senders of numbered events in one program, at this port.
fn senders(programs: &Programs, port: u16, given: Given<'_>) -> Arc<Program> {
    let tasks = [("Sender1", "numbers.Sender", given), ("Sender2", "numbers.Sender", given)];
    programs.tasks("senders", port, &tasks)
}

/// A program with a reader of what both send, at this port.
fn reader(programs: &Programs, name: &str, port: u16, given: Given<'_>) -> Arc<Program> {
    let usual = [("senders", "2"), ("queue", "200000")];
    programs.tasks(name, port, &[(&format!("{name}-Reader"), "numbers.Reader", &[&usual, given].concat())])
}

/// Waits until a reader has received all of both senders, and for its end.
#[track_caller]
fn receives_all(programs: &Programs, reader: &Program, count: &str) {
    for sender in ["Sender1", "Sender2"] {
        programs.until(reader, &format!("has received 1 to {count} of {sender}"));
    }
    programs.ends(reader, 0);
}

/// Runs trials beside each other: what takes long in them is waiting.
fn beside_each_other(trials: &[&(dyn Fn() + Sync)]) {
    std::thread::scope(|scope| trials.iter().for_each(|trial| drop(scope.spawn(trial))));
}

/// Holds programs to the memory that they may take.
#[track_caller]
fn took_little_memory(programs: &Programs) {
    let most = programs.most_memory();
    assert!((1..MOST_MEMORY).contains(&most), "{most} bytes");
}
