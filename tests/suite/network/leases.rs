//! Programs with robots that stop for longer than a lease, and go on.

use std::thread::sleep;
use std::time::{Duration, Instant};

use super::nodes::{start, write_fleet};
use super::programs::{Program, Programs};

/// Time for which programs stop here: longer than a lease, and than that of all messages on their way.
const LONG: Duration = Duration::from_secs(14);

/// Each piece is brought once, by whichever program, and nobody enters what was granted to another one.
#[track_caller]
fn each_is_delivered_once(programs: &Programs, floors: [&Program; 2], pieces: u32) {
    let printed = floors.map(Program::printed).concat();
    for piece in 1..=pieces {
        for what in ["collected", "deposited"] {
            let found = printed.matches(&format!("{what} luggage {piece} at")).count();
            assert_eq!(found, 1, "luggage {piece} is {what} {found} times\n{}", programs.printed());
        }
    }
    for sign in ["which was granted to", "could not collect", "gives up luggage", "panicked"] {
        assert!(!programs.printed().contains(sign), "{sign}\n{}", programs.printed());
    }
}

/// Waits until one of two programs says this. Gives that one, and the other one.
fn who_says<'p>(floors: [&'p Program; 2], text: &str) -> (&'p Program, &'p Program) {
    let begin = Instant::now();
    while begin.elapsed() < Duration::from_secs(180) {
        for (one, other) in [(floors[0], floors[1]), (floors[1], floors[0])] {
            if one.printed().contains(text) {
                return (one, other);
            }
        }
        sleep(Duration::from_millis(10));
    }
    panic!("nobody says `{text}`\n{}", floors.map(Program::printed).concat());
}

#[test]
fn luggage_of_a_program_that_stops_passes_on_unless_it_is_on_board() {
    let programs = Programs::new();
    write_fleet(
        &programs,
        "at 2s luggage (9,1) to (9,10)\nthen 45s luggage (2,1) to (9,1)",
        &[("gate-a", "500"), ("gate-b", "500")],
    );
    let others = ["control", "traffic"].map(|node| start(&programs, "fleet.composite", node, &[]));
    let floors = ["gate-a", "gate-b"].map(|node| start(&programs, "fleet.composite", node, &[]));
    let floors = [&*floors[0], &*floors[1]];
    let (stopped, goes_on) = who_says(floors, "takes luggage 1 from");
    stopped.signal(libc::SIGSTOP);
    // The master may not have heard that it took it: then it is its interest that does not count any more.
    programs.until(goes_on, "collected luggage 1 at");
    stopped.signal(libc::SIGCONT);
    let (stopped, goes_on) = who_says(floors, "collected luggage 2 at");
    stopped.signal(libc::SIGSTOP);
    sleep(LONG);
    assert!(!others[0].printed().contains("luggage 2 waits again"), "{}", programs.printed());
    stopped.signal(libc::SIGCONT);
    for program in [&*others[0], &*others[1], stopped, goes_on] {
        programs.ends(program, 0);
    }
    each_is_delivered_once(&programs, floors, 2);
}

#[test]
fn programs_of_robots_that_stop_in_turn_deliver_each_piece_once() {
    let programs = Programs::new();
    let scenario = "from 1s every 700ms 24 times luggage (4,0)..(10,10) to (1,0)..(4,10)";
    write_fleet(&programs, scenario, &[("gate-a", "100"), ("gate-b", "150")].repeat(2));
    let others = ["control", "traffic"].map(|node| start(&programs, "fleet.composite", node, &[]));
    let floors = ["gate-a", "gate-b"].map(|node| start(&programs, "fleet.composite", node, &[]));
    for floor in &floors {
        programs.until(floor, "takes luggage");
        floor.signal(libc::SIGSTOP);
        sleep(LONG);
        floor.signal(libc::SIGCONT);
    }
    for program in others.iter().chain(&floors) {
        programs.ends(program, 0);
    }
    each_is_delivered_once(&programs, [&floors[0], &floors[1]], 24);
}
