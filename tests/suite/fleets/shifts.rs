//! A component that schedules others: the shipped example of shifts.

use std::time::Duration;

use saoms_testkit::Fleet;

#[test]
fn the_robot_of_shifts_runs_in_its_shifts_alone_and_no_luggage_is_lost() {
    let run = Fleet::of_file("composites/shift.composite").run(0, Duration::from_mins(10));
    assert_eq!((run.count("luggage.delivered"), run.count("luggage.open")), (12, 0));
    assert_eq!((run.count("collisions.vertex"), run.count("stranded")), (0, 0));
    // Three shifts of 15 s, with a period of 100 ms.
    let robot = run.components.iter().find(|component| component.name == "Robot2").unwrap();
    assert_eq!(robot.executions, 450);
    let shifts: Vec<String> = run.log_of("Shift").into_iter().map(|line| line.to_string()).collect();
    assert_eq!(shifts.len(), 6, "{shifts:?}");
    assert_eq!(shifts[..2], ["starts shift 1 of 15 s for 1 component", "shift 1 is over for 1 component"]);
}

/// With these seeds a shift ends while luggage of the shift before still waits for help.
#[test]
fn luggage_of_two_shifts_waits_for_help_at_once() {
    for seed in [3, 9, 10, 11, 12, 13, 16] {
        let run = Fleet::of_file("composites/shift.composite").run(seed, Duration::from_mins(10));
        assert_eq!((run.count("luggage.delivered"), run.count("luggage.open")), (12, 0), "seed {seed}");
    }
}

/// A `delay` puts off the first shift and those that follow it; otherwise, shifts in the past would be cut short.
#[test]
fn a_delay_puts_off_the_first_shift() {
    let text = shifts(
        "at 1s luggage (3,1) to (5,5)\nat 90s luggage (2,2) to (2,6)",
        "<property name=\"delay\" value=\"20s\"/>",
    );
    let run = Fleet::of_text(text).run(0, Duration::from_mins(10));
    let robot = run.components.iter().find(|component| component.name == "Robot2").unwrap();
    assert_eq!(robot.executions, 450, "{:?}", run.log_of("Shift"));
}

/// The shipped fleet of shifts with other work and another first shift.
fn shifts(work: &str, first: &str) -> String {
    let text = std::fs::read_to_string(crate::support::root().join("composites/shift.composite")).unwrap();
    let text = text.replace("from 1s every 6s 12 times luggage (1,1)..(9,9) to (1,1)..(9,9)", work);
    text.replace("<property name=\"start\" value=\"5s\"/>", first)
}

#[test]
fn a_robot_that_starts_later_brings_what_waits() {
    let text =
        shifts("at 1s luggage (3,1) to (5,5)\nat 2s luggage (2,2) to (2,6)", "<property name=\"start\" value=\"4s\"/>");
    let robot = text.find("  <component name=\"Robot1\">").unwrap();
    let next = text.find("  <component name=\"Robot2\">").unwrap();
    let run = Fleet::of_text(format!("{}{}", &text[..robot], &text[next..])).run(0, Duration::from_mins(10));
    assert_eq!((run.count("luggage.delivered"), run.count("luggage.given_up")), (2, 0), "{:?}", run.log_of("Master"));
}

#[test]
fn a_robot_goes_on_with_the_job_of_its_last_shift_if_the_others_are_busy() {
    let work = "at 1s luggage (9,9) to (1,9)\nat 6s luggage (3,3) to (9,3)";
    let first = "<property name=\"start\" value=\"5s\"/>";
    let text = shifts(work, first).replace("value=\"15s\"", "value=\"6s\"").replace("value=\"10s\"", "value=\"1s\"");
    let run = Fleet::of_text(text).run(0, Duration::from_mins(10));
    let log: Vec<String> = run.log_of("Robot2").into_iter().map(|line| line.to_string()).collect();
    assert!(log.iter().any(|line| line.starts_with("takes luggage 2 again, which it left at (")), "{log:?}");
    assert_eq!((run.count("luggage.delivered"), run.count("luggage.given_up")), (2, 0));
}

/// A robot reaches the block of a robot that is out of service from the block beside. Such a robot can start again
/// before the luggage is deposited, at any moment of it.
#[test]
fn luggage_is_deposited_where_a_robot_starts_again_meanwhile() {
    for pause in (50..70).map(|tenths| format!("value=\"{tenths}00ms\"")) {
        // The robot is at its charge block in its first shift, and out of service after that.
        let work = "at 9s luggage (3,2) to (0,2)";
        let text = shifts(work, "<property name=\"start\" value=\"5s\"/>");
        let text = text.replace("value=\"15s\"", "value=\"3s\"").replace("value=\"10s\"", &pause);
        let run = Fleet::of_text(text).run(0, Duration::from_mins(10));
        assert_eq!(
            (run.count("luggage.delivered"), run.count("luggage.open")),
            (1, 0),
            "{pause}: {:?}",
            run.log_of("Robot1")
        );
    }
}

#[test]
fn shifts_without_an_end_and_without_a_pause_follow_each_other() {
    let text = std::fs::read_to_string(crate::support::root().join("composites/shift.composite")).unwrap();
    let text = text.replace("    <property name=\"shifts\" value=\"3\"/>\n", "");
    let text = text.replace("    <property name=\"pause\" value=\"10s\"/>\n", "");
    let run = Fleet::of_text(text).run(0, Duration::from_secs(65));
    // From 5 s to 65 s, with a new instance every 15 s.
    let robot = run.components.iter().find(|component| component.name == "Robot2").unwrap();
    assert!((590..=600).contains(&robot.executions), "{}", robot.executions);
    assert_eq!(run.log_of("Shift").len(), 4);
}

#[test]
fn shifts_have_a_length_and_a_component() {
    let shift = |inside: &str| {
        let text = format!(
            "<composite xmlns=\"http://docs.oasis-open.org/ns/opencsa/sca/200912\" targetNamespace=\"urn:t\" name=\"t\">\
             <component name=\"Shift\"><implementation.rust class=\"saoms.Shift\"/><property name=\"ID\" value=\"S\"/>\
             <property name=\"period\" value=\"1s\"/>{inside}</component></composite>"
        );
        Fleet::of_text(text).diagnostics()
    };
    assert!(shift("<reference name=\"tasks\" target=\"Shift\"/>").contains("`work`"));
    assert!(shift("<property name=\"work\" value=\"1s\"/>").contains("tasks"));
}
