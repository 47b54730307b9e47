//! Robots with a loop of a library that fails, or hangs, while they carry luggage.

use super::build::library;
use super::run::{Run, component, fleet, property};

/// Runs a fleet of two robots, of which the closer one has a loop that does this once it carries the luggage.
fn carries(does: &str, scenario: &str, more: &[&str]) -> Run {
    let world = r#"<reference name="world" target="World"/>"#;
    let size = property("width", "8") + &property("height", "4") + &property("moveTime", "100ms");
    let scenario = property("scenario", &format!("at 300ms luggage (1,0) to (6,0); {scenario}"));
    let acts = property("at", "carries") + &property("does", does);
    let acts = format!(r#"<saoms:loop name="Carrier" class="bad.Carrier">{acts}</saoms:loop>"#);
    let mut components = component("World", "saoms.World", &size);
    components += &component("Master", "saoms.MasterEnvironment", "");
    components += &component("Environment", "saoms.Environment", &scenario);
    for (robot, row, loops) in [("Robot1", "0", acts.as_str()), ("Robot2", "3", "")] {
        let at = property("chargeX", "0") + &property("chargeY", row) + &property("discharge", "0.1");
        components += &component(robot, "saoms.Robot", &(loops.to_owned() + &at + world));
    }
    fleet(&components, &[library("bad")], more)
}

/// Another robot brings the luggage, and the run has failed because of the first one.
fn assert_taken_over(run: &Run, why: &str) {
    assert_eq!(run.code, Some(1), "{}", run.text);
    assert!(run.reasons().contains("Robot1") && run.reasons().contains(why), "{}\n{}", run.reasons(), run.text);
    assert!(run.reasons().contains(library("bad").to_str().unwrap()), "{}", run.reasons());
    let brings = |line: &str| line.contains("Robot2 ") && line.ends_with("deposited luggage 1 at (6,0)");
    assert!(run.text.lines().any(brings), "{}", run.text);
    assert_eq!(run.report["luggage"]["delivered"], 1, "{}", run.text);
}

#[test]
fn luggage_of_a_robot_whose_library_panics_is_brought_by_another_one() {
    for more in [&["--virtual"][..], &[]] {
        assert_taken_over(&carries("panic", "", more), "no more of carries");
    }
}

/// Code that never returns is told, and holds up nobody else. Nobody but an operator knows that it will not go on.
#[test]
fn a_robot_that_hangs_is_told_and_its_luggage_is_brought_once_it_is_off_the_floor() {
    let run = carries("never", "at 8s gone Robot1", &["--for", "30s", "--grace", "200ms"]);
    let told = |line: &str| line.contains("Robot1 ") && line.contains("warning: has not returned for ");
    assert!(run.text.lines().any(told), "{}", run.text);
    assert_taken_over(&run, "did not end within 200ms");
}
