//! Wheels behind a controller, in a real process that is interrupted while they turn.

use std::io::{BufRead, BufReader, ErrorKind, Write};
use std::net::TcpListener;
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::thread;
use std::time::Duration;

use crate::plugins::examples::library;
use crate::support::{root, text};

/// A controller whose wheels turn for ever; it answers `stop` with this word. Returns its address and its orders, with
/// `heartbeat` for each heartbeat, and `silence` if none comes within twice the period.
fn controller(answer: &'static str) -> (String, Receiver<String>) {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = listener.local_addr().unwrap().to_string();
    let (told, orders) = channel();
    thread::spawn(move || {
        let mut stream = BufReader::new(listener.accept().unwrap().0);
        let mut line = String::new();
        loop {
            match stream.read_line(&mut line) {
                Ok(1..) => {}
                Err(error) if error.kind() == ErrorKind::WouldBlock => {
                    return drop(told.send("silence".to_owned()));
                }
                _ => return,
            }
            let (number, order) = line.trim().split_once(' ').unwrap();
            if number == "alive" {
                let limit = Duration::from_millis(2 * order.parse::<u64>().unwrap());
                stream.get_mut().set_read_timeout(Some(limit)).unwrap();
                let _ = told.send("heartbeat".to_owned());
                line.clear();
                continue;
            }
            if order == "stop" {
                // Its wheels take a while to come to rest.
                thread::sleep(Duration::from_millis(100));
                let _ = stream.get_mut().write_all(format!("{number} {answer}\n").as_bytes());
            }
            let _ = told.send(order.to_owned());
            line.clear();
        }
    });
    (address, orders)
}

/// Runs the example until the wheels turn.
fn driving(address: &str, orders: &Receiver<String>) -> Child {
    let child = Command::new(env!("CARGO_BIN_EXE_saoms"))
        .current_dir(root())
        .args(["run", "plugins/wheels/fleet.composite", "--set", &format!("address={address}"), "--for", "60s"])
        .args(["--plugin", library("saoms_wheels").to_str().unwrap()])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    wait_for(orders, "move 1 0");
    child
}

/// Waits for an order, or what else the controller reports, a minute at most.
fn wait_for(orders: &Receiver<String>, expected: &str) {
    while orders.recv_timeout(Duration::from_secs(60)).unwrap() != expected {}
}

fn send(child: &Child, signal: libc::c_int) {
    // SAFETY: `kill` takes no pointers; the process is our own child, not yet waited for.
    assert_eq!(unsafe { libc::kill(i32::try_from(child.id()).unwrap(), signal) }, 0);
}

/// Runs the example, and interrupts it when the wheels turn. Returns the orders after the first, the exit code and
/// what was written.
fn interrupted(answer: &'static str) -> (Vec<String>, Option<i32>, String) {
    let (address, orders) = controller(answer);
    let child = driving(&address, &orders);
    send(&child, libc::SIGINT);
    let output = child.wait_with_output().unwrap();
    let orders = orders.iter().filter(|order| order != "heartbeat").collect();
    (orders, output.status.code(), text(&output))
}

#[test]
fn an_interrupt_stops_the_wheels_before_the_program_ends() {
    let (orders, code, told) = interrupted("done");
    assert!(!orders.is_empty() && orders.iter().all(|order| order == "stop"), "{orders:?}");
    assert_eq!(code, Some(130), "{told}");
}

#[test]
fn wheels_that_do_not_confirm_the_stop_are_told_at_the_end() {
    let (orders, code, told) = interrupted("failed");
    assert!(orders.contains(&"stop".to_owned()), "{orders:?}");
    assert_eq!(code, Some(130), "{told}");
    assert!(told.contains("the wheels may still turn: the controller at `127.0.0.1:"), "{told}");
}

#[test]
fn a_controller_hears_no_heartbeat_of_a_program_that_stands_still() {
    let (address, orders) = controller("done");
    let mut child = driving(&address, &orders);
    wait_for(&orders, "heartbeat");
    send(&child, libc::SIGSTOP);
    wait_for(&orders, "silence");
    child.kill().unwrap();
    child.wait().unwrap();
}
