//! The invariants find a bug that somebody planted, within 100 seeds, and nothing where there is none.

use std::time::Duration;

use saoms_testkit::Fleet;

/// The robot with the bugs, of which the tests of the command make a plugin.
#[path = "../../../tests/plugins/planted/src/lib.rs"]
mod robot;

fn planted(bug: &str) -> Fleet {
    Fleet::of_text(format!(
        r#"<composite xmlns="http://docs.oasis-open.org/ns/opencsa/sca/200912" name="planted" targetNamespace="urn:planted">
  <component name="Planted">
    <implementation.rust class="test.Planted"/>
    <property name="ID">Planted</property>
    <property name="period">100ms</property>
    <property name="bug">{bug}</property>
  </component>
</composite>"#
    ))
}

/// The violations of the first of 100 seeds that has any.
fn found(fleet: &Fleet, limit: u64) -> String {
    let limit = Duration::from_secs(limit);
    let found = (0..100).map(|seed| fleet.violations(seed, limit)).find(|found| !found.is_empty());
    found.unwrap_or_default()
}

#[test]
fn robots_that_hear_of_each_other_too_late_meet_and_exchange_their_blocks() {
    // Without its zone, safety rests on messages that are faster than a period.
    let text = std::fs::read_to_string("../composites/airport.composite").unwrap();
    let (before, after) = text.split_once("<component name=\"Zone\">").unwrap();
    let fleet = Fleet::of_text([before, after.split_once("</component>").unwrap().1].concat());
    let late = fleet.with_fault(Duration::from_secs(1), "for 20s delay 50ms to 300ms");
    let found: String = (0..20).map(|seed| late.violations(seed, Duration::from_secs(60))).collect();
    assert!(found.contains("] 1 no two robots in a block: robots ") && found.contains(" collide at ("), "{found}");
    assert!(found.contains("] 2 no two robots exchange their blocks: robots "), "{found}");
}

#[test]
fn a_planted_bug_is_found_within_100_seeds() {
    for (bug, limit, expected) in [
        ("jump", 60, "3 a move is one block to a free neighbour: robot 99 was at (1,1), and is at (3,1)"),
        ("twice", 60, "4 luggage is delivered exactly once: robot 99 delivers luggage 50, which was delivered at "),
        ("battery", 60, "5 no battery is empty away from a charger: the battery of robot 99 is empty"),
        ("deadlock", 90, "6 no robot with a job stands still for ever: robot 99 has stood at (1,1) for 6"),
        ("deadlock", 900, "7 requests are finished once faults are over: luggage 50 is not delivered"),
        ("broken", 90, "8 the luggage of a broken robot is taken over: nobody takes over luggage 50 of robot 99"),
    ] {
        let found = found(&planted(bug), limit);
        assert!(found.contains(expected), "{bug}: {found}");
    }
}

#[test]
fn a_component_that_looks_at_another_clock_has_another_trace() {
    let fleet = planted("clock");
    let hash = || fleet.run(1, Duration::from_secs(10)).trace_hash.clone();
    assert_ne!(hash(), hash());
}

#[test]
fn fleets_of_the_safe_policy_keep_the_invariants() {
    Fleet::of_file("../composites/airport.composite").expect_invariants(0..3, Duration::from_secs(3600));
    Fleet::of_file("../composites/hall.composite").expect_invariants(0..3, Duration::from_secs(60));
}
