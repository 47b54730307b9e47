//! Why a component did something, asked of the fleet instead of its report.

use saoms_api::Time;
use saoms_core::schedule::{RunningFleet, Settings};

use super::PAIR;
use super::actors::fleet;
use crate::fleet::simulated;

#[test]
fn the_fleet_gives_the_same_answers_as_its_report() {
    let many = "Gate gate period=100 every=4\nRobot robot period=100 delay=50\nOther robot period=70 delay=30";
    let relayed = "Gate gate period=100 every=4 rename=REQUESTS/FIRST
         Relay relay period=100 delay=10
         Robot robot period=100 delay=50";
    let call = "Asker asker period=100 peer=Helper\nHelper helper";
    // With rings that hold all records, and with rings that do not.
    let mut overwritten = 0;
    for (text, journal) in [(PAIR, 65_536), (PAIR, 0), (many, 0), (relayed, 0), (call, 65_536)] {
        let settings = Settings { journal, ..simulated(60_000) };
        let running = RunningFleet::start(fleet(text), settings, Vec::new()).unwrap();
        let handle = running.handle();
        let report = running.run_to_end();
        let times = (0..120).map(|step| Some(Time::from_nanos(step * 253_000_000)));
        for component in report.components.iter().map(|one| one.name.as_str()) {
            for at in times.clone().chain([None]) {
                let told = handle.why(component, at).unwrap();
                assert_eq!(told.components[0].name, component);
                let expected = report.journal.why(component, at);
                assert_eq!(told.journal.why(component, at), expected, "{text}: {component} at {at:?}");
                let (first, of_excerpt) = (report.journal.of(component).first(), told.journal.of(component).first());
                assert_eq!(of_excerpt.map(|entry| entry.id()), first.map(|entry| entry.id()));
            }
        }
        overwritten += report.journal.overwritten;
    }
    assert!(overwritten > 1000, "{overwritten}");
}

#[test]
fn the_answer_needs_a_small_part_of_the_journal() {
    let running = RunningFleet::start(fleet(PAIR), simulated(100_000), Vec::new()).unwrap();
    let handle = running.handle();
    let report = running.run_to_end();
    let told = handle.why("Robot", None).unwrap();
    assert!(report.journal.entries().len() > 1000);
    assert!(told.journal.entries().len() < 20, "{}", super::records(&told.journal));
    assert_eq!(told.time_s, report.time_s);
}

#[test]
fn a_component_is_found_by_its_path_or_an_ending_of_it() {
    let running = RunningFleet::start(fleet(PAIR), simulated(400), Vec::new()).unwrap();
    let handle = running.handle();
    running.run_to_end();
    assert_eq!(handle.why("bot", None).unwrap().components[0].name, "Robot");
    let unknown = handle.why("Robbot", None).unwrap_err();
    assert_eq!(unknown, "the fleet of this run had no component `Robbot`: did you mean `Robot`?");
}
