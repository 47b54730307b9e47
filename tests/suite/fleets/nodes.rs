//! Faults of nodes, in one program with virtual time: what the network between them does, and programs that hang or
//! die.

use std::fs;
use std::time::Duration;

use saoms_core::report::RunStatus;
use saoms_testkit::{Fleet, Run};

use crate::support::root;

/// The airport in three nodes, with these faults.
fn airport(faults: &str) -> Fleet {
    let text = fs::read_to_string(root().join("composites/airport-nodes.composite")).unwrap();
    let scenario = "<property name=\"scenario\">";
    assert!(text.contains(scenario));
    Fleet::of_text(text.replacen(scenario, &format!("{scenario}\n{faults}\n"), 1))
}

/// Runs it: all luggage is delivered, and no robots meet.
fn delivers(faults: &str) -> Run {
    let fleet = airport(faults);
    assert_eq!(fleet.violations(1, Duration::from_secs(600)), "", "{faults}");
    let run = fleet.run(1, Duration::from_secs(600));
    assert_eq!(run.outcome.status, RunStatus::Done, "{faults}: {:?}\n{}", run.outcome, run.log());
    assert_eq!((run.count("luggage.delivered"), run.count("collisions.vertex")), (9, 0), "{faults}: {}", run.log());
    run
}

#[test]
fn nodes_that_are_cut_off_hang_or_die_go_on_when_they_are_back() {
    let usual = delivers("").time_s;
    // Who is in one node still hears each other: requests reach nobody, and what is asked for is brought later.
    let cut = delivers("at 100ms for 9s part @floor from @traffic, @control").time_s;
    assert!(cut > usual.max(9.0) + 1.0, "{cut} s, and {usual} s without a fault");
    let slow = delivers("at 0s delay 300ms from @*").time_s;
    assert!(slow > usual + 0.5, "{slow} s, and {usual} s without a fault");
    delivers("at 0s lose 30 % from @* to @*");
    let hung = delivers("at 1s for 6s stall @traffic").time_s;
    assert!(hung > usual.max(7.0), "{hung} s, and {usual} s without a fault");
    delivers("at 2s crash @traffic restart 3s");
    // Nothing goes over a network to its own node.
    let own = airport("at 0s lose 50 % from @floor to @floor").diagnostics();
    assert!(own.contains("no message takes this way"), "{own}");
    let unknown = airport("at 0s crash @flor").diagnostics();
    assert!(unknown.contains("the fleet has no node `flor`"), "{unknown}");
}
