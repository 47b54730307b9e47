//! The driver with controllers that are honest, slow, lying, and gone. Each is a thread with a socket of its own.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking, and so do its helpers")]

use std::io::{BufRead, BufReader, Write};
use std::net::{TcpListener, TcpStream};
use std::sync::mpsc::{Receiver, channel};
use std::thread;
use std::time::Duration;

use saoms_components::grid::Block;
use saoms_components::messages::{EVENT_LUGGAGE, EventLuggage};
use saoms_components::robot::Robot;
use saoms_testkit::Bench;
use saoms_wheels::Wheels;

/// A controller that answers each order as `answer` says: the order's number, its text, and how many came before.
/// Returns its address and the orders that it gets.
fn controller(answer: impl Fn(u64, &str, usize) -> String + Send + 'static) -> (String, Receiver<String>) {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = listener.local_addr().unwrap().to_string();
    let (told, orders) = channel();
    thread::spawn(move || {
        let mut count = 0;
        // One connection after the other, until nobody wants to know of orders any more.
        while let Ok((stream, _)) = listener.accept() {
            let mut stream = BufReader::new(stream);
            let mut line = String::new();
            while stream.read_line(&mut line).is_ok_and(|bytes| bytes > 0) {
                if line.starts_with("alive ") {
                    line.clear();
                    continue;
                }
                let (number, order) = line.trim().split_once(' ').unwrap();
                let reply = answer(number.parse().unwrap(), order, count);
                if told.send(order.to_owned()).is_err() {
                    return;
                }
                count += 1;
                if reply == "hangs up" {
                    break;
                }
                if write(stream.get_mut(), &reply).is_err() {
                    break;
                }
                line.clear();
            }
        }
    });
    (address, orders)
}

fn write(stream: &mut TcpStream, reply: &str) -> std::io::Result<()> {
    stream.write_all(reply.as_bytes())
}

fn honest(number: u64, _: &str, _: usize) -> String {
    format!("{number} done\n")
}

/// A robot on wheels with this controller, which is to carry luggage from (1,1) to (2,1).
fn robot(address: &str, patience: &str) -> Bench {
    let mut wheels = Bench::of::<Wheels>(&[("address", address), ("patience", patience)]).unwrap();
    wheels.start().unwrap();
    let robot = Bench::of::<Robot>(&[("ID", "Robot1"), ("discharge", "0")]).unwrap();
    let mut robot = robot.period(Duration::from_millis(2)).wire("world", wheels, "hardware");
    robot.start().unwrap();
    robot.deliver(&EVENT_LUGGAGE, EventLuggage::request(1, Block::new(1, 1), Block::new(2, 1)));
    robot
}

/// Executes the robot until it has written a line with these words, in at most about a minute.
fn execute_until(robot: &mut Bench, words: &str) {
    for _ in 0..30_000 {
        robot.execute().unwrap();
        if robot.log().iter().any(|line| line.contains(words)) {
            return;
        }
        thread::sleep(Duration::from_millis(2));
    }
    panic!("no `{words}` in {}", robot.transcript());
}

fn deposits(address: &str, patience: &str) -> String {
    let mut robot = robot(address, patience);
    execute_until(&mut robot, "deposited luggage 1 at (2,1)");
    robot.transcript()
}

#[test]
fn an_honest_controller_brings_the_luggage_home() {
    let (address, orders) = controller(honest);
    deposits(&address, "30s");
    assert_eq!(orders.try_iter().collect::<Vec<_>>(), ["move 1 0", "collect", "move 1 0", "deposit"]);
}

#[test]
fn answers_to_other_orders_and_noise_count_for_nothing() {
    let (address, _orders) = controller(|number, order, count| {
        let noise = "x".repeat(5000);
        match order {
            // Answers to orders that are over, that never came, twice, and lines that are no answers.
            _ if count % 2 == 0 => {
                let (before, after) = (number.wrapping_sub(1), number + 100);
                format!(
                    "{before} failed\n{after} done\n{noise}\n{number} maybe\n\u{fffd}\n{number} done\n{number} failed\n"
                )
            }
            _ => honest(number, order, count),
        }
    });
    assert!(!deposits(&address, "30s").contains("failed"), "no failure that was not one");
}

#[test]
fn an_order_that_failed_is_given_again() {
    let (address, orders) =
        controller(|number, _, count| format!("{number} {}\n", if count == 0 { "failed" } else { "done" }));
    deposits(&address, "30s");
    let orders: Vec<_> = orders.try_iter().collect();
    assert_eq!(orders[..3], ["move 1 0", "stop", "move 1 0"], "what failed is stopped, then tried again");
}

#[test]
fn a_controller_that_hangs_up_is_called_again() {
    let (address, orders) =
        controller(|number, _, count| if count == 1 { "hangs up".to_owned() } else { format!("{number} done\n") });
    deposits(&address, "30s");
    assert_eq!(orders.try_iter().filter(|order| order == "collect").count(), 2);
}

#[test]
fn an_order_without_an_answer_fails_after_the_patience_and_is_stopped() {
    let (address, orders) =
        controller(|number, _, count| if count == 0 { String::new() } else { format!("{number} done\n") });
    deposits(&address, "300ms");
    assert_eq!(orders.try_iter().take(2).collect::<Vec<_>>(), ["move 1 0", "stop"]);
}

#[test]
fn nobody_listens() {
    let free = TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().to_string();
    let mut robot = robot(&free, "30s");
    execute_until(&mut robot, "needs assistance");
}

#[test]
fn a_stop_overtakes_a_move() {
    // It answers no move, as one that is still on its way.
    let (address, orders) =
        controller(|number, order, _| if order == "stop" { format!("{number} done\n") } else { String::new() });
    let mut robot = robot(&address, "30s");
    while orders.recv_timeout(Duration::from_millis(5)).is_err() {
        robot.execute().unwrap();
    }
    robot.shutdown().unwrap();
    assert_eq!(orders.recv_timeout(Duration::from_secs(10)).as_deref(), Ok("stop"));
}

#[test]
fn a_stop_is_ordered_once_however_many_want_it() {
    let (address, orders) =
        controller(|number, order, _| if order == "stop" { format!("{number} done\n") } else { String::new() });
    let mut robot = robot(&address, "30s");
    while orders.recv_timeout(Duration::from_millis(5)).is_err() {
        robot.execute().unwrap();
    }
    // From outside, by the robot that retires, and by the end of both.
    robot.stop_hardware().unwrap();
    robot.stop_hardware().unwrap();
    robot.shutdown().unwrap();
    robot.stop_hardware().unwrap();
    assert_eq!(orders.try_iter().collect::<Vec<_>>(), ["stop"]);
}

/// A controller as it should be: it drives until it is told to stop, or has heard nothing for twice the period of the
/// last heartbeat. Returns its address and what becomes of the wheels.
fn careful_controller() -> (String, Receiver<&'static str>) {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = listener.local_addr().unwrap().to_string();
    let (told, wheels) = channel();
    thread::spawn(move || {
        let mut stream = BufReader::new(listener.accept().unwrap().0);
        let mut line = String::new();
        loop {
            line.clear();
            match stream.read_line(&mut line) {
                Ok(0) => return,
                Ok(_) => {}
                Err(_) => {
                    let _ = told.send("stop by themselves");
                    return;
                }
            }
            let happens = match line.trim().split_once(' ').unwrap() {
                ("alive", period) => {
                    let limit = Duration::from_millis(2 * period.parse::<u64>().unwrap());
                    stream.get_mut().set_read_timeout(Some(limit.max(Duration::from_millis(1)))).unwrap();
                    "hear the robot"
                }
                (number, "stop") => {
                    write(stream.get_mut(), &format!("{number} done\n")).unwrap();
                    "are stopped"
                }
                _ => "turn",
            };
            if told.send(happens).is_err() {
                return;
            }
        }
    });
    (address, wheels)
}

/// Waits until this happens to the wheels, for ten seconds at most.
fn wait_for(wheels: &Receiver<&'static str>, expected: &str) {
    while wheels.recv_timeout(Duration::from_secs(10)).unwrap() != expected {}
}

/// A robot whose wheels turn, with a period at which this process is never late for a heartbeat.
fn driving(address: &str) -> Bench {
    let mut wheels = Bench::of::<Wheels>(&[("address", address)]).unwrap();
    wheels.start().unwrap();
    let robot = Bench::of::<Robot>(&[("ID", "Robot1"), ("discharge", "0")]).unwrap();
    let mut robot = robot.period(Duration::from_secs(1)).wire("world", wheels, "hardware");
    robot.start().unwrap();
    robot.deliver(&EVENT_LUGGAGE, EventLuggage::request(1, Block::new(1, 1), Block::new(2, 1)));
    (0..10).for_each(|_| robot.execute().unwrap());
    robot
}

#[test]
fn wheels_are_stopped_from_outside_the_component() {
    let (address, wheels) = careful_controller();
    let robot = driving(&address);
    wait_for(&wheels, "turn");
    robot.stop_hardware().unwrap();
    wait_for(&wheels, "are stopped");
}

#[test]
fn wheels_whose_robot_is_silent_stop_by_themselves() {
    let (address, wheels) = careful_controller();
    let mut robot = driving(&address);
    wait_for(&wheels, "turn");
    // A heartbeat before the connection is there reaches nobody.
    robot.execute().unwrap();
    wait_for(&wheels, "hear the robot");
    wait_for(&wheels, "stop by themselves");
    drop(robot);
}
