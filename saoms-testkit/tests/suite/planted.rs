//! The invariants find a bug that somebody planted, within 100 seeds, and nothing where there is none.

use std::time::Duration;

use saoms_testkit::Fleet;

/// The robot with the bugs, of which the tests of the command make a plugin.
#[path = "../../../tests/plugins/planted/src/lib.rs"]
mod robot;

fn fleet(components: &str) -> Fleet {
    Fleet::of_text(format!(
        r#"<composite xmlns="http://docs.oasis-open.org/ns/opencsa/sca/200912" xmlns:saoms="urn:saoms:1" name="planted"
    targetNamespace="urn:planted">{components}</composite>"#
    ))
}

/// A component of this class, with an attribute that says where it is.
fn component(name: &str, place: &str, class: &str, properties: &str) -> String {
    format!(
        r#"<component name="{name}" {place}>
    <implementation.rust class="{class}"/>
    <property name="ID">{name}</property>
    <property name="period">100ms</property>{properties}
  </component>"#
    )
}

fn robot(name: &str, place: &str, bug: &str) -> String {
    component(name, place, "test.Planted", &format!("<property name=\"bug\">{bug}</property>"))
}

fn planted(bug: &str) -> Fleet {
    fleet(&robot("Planted", "", bug))
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
        ("uncounted", 60, "4 luggage is delivered exactly once: robots said of 1 pieces that they were delivered, the"),
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
fn a_world_that_crashes_for_good_excuses_the_robots_of_its_site_alone() {
    // Each robot publishes the map of its site, as a world does.
    let stands = "6 no robot with a job stands still for ever";
    let sites = [robot("One", "saoms:site=\"North\"", "deadlock"), robot("Two", "saoms:site=\"South\"", "deadlock")];
    let found = found(&fleet(&sites.concat()).with_fault(Duration::from_secs(15), "crash Two"), 90);
    assert!(found.contains(&format!("{stands}: North: robot 99")) && !found.contains("South"), "{found}");
}

#[test]
fn a_node_without_a_world_and_a_zone_excuses_nobody_when_it_crashes_for_good() {
    let url = "<property name=\"url\">localhost:61616</property>";
    let master = component("Master", "saoms:node=\"control\"", "saoms.MasterRobot", url);
    let bug = format!("<property name=\"bug\">deadlock</property>{url}");
    let nodes = fleet(&[component("Planted", "saoms:node=\"floor\"", "test.Planted", &bug), master].concat());
    let crashed = |node: &str| found(&nodes.clone().with_fault(Duration::from_secs(15), &format!("crash @{node}")), 90);
    let stands = "6 no robot with a job stands still for ever: robot 99";
    let found = crashed("control");
    assert!(found.contains(stands), "{found}");
    assert_eq!(crashed("floor"), "", "without its map no robot moves");
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
