//! Expectations about runs, and the messages of their failures.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::Duration;

use saoms_testkit::{Fleet, Run, expect_diagnostics};

fn hall() -> Run {
    Fleet::of_file("../composites/hall.composite").run(7, Duration::from_secs(60))
}

/// Message with which a test fails.
fn failure(test: impl FnOnce()) -> String {
    let cause = catch_unwind(AssertUnwindSafe(test)).unwrap_err();
    cause.downcast_ref::<String>().unwrap().clone()
}

#[test]
fn what_happened_is_found_by_its_words_and_in_its_order() {
    let run = hall();
    let robot = run.expect("Robot7");
    let takes = robot.to("takes luggage 1").before(Duration::from_secs(5));
    let collects = robot.to("collects luggage 1").after(&takes).because("is at (3,1)");
    let deposits = robot.to("deposits luggage 1").after(&collects).after(collects.time());
    assert!(deposits.text().contains("luggage 1") && deposits.time() > takes.time());
    let moves = robot.to("block");
    moves.again().after(&moves).before(moves.again().again());
    robot.never_to("breaks down");
    assert_eq!(robot.count("collects luggage 1"), 1);
}

#[test]
fn what_is_not_so_is_told_with_what_is() {
    let run = hall();
    let robot = run.expect("Robot7");
    let collects = robot.to("collects luggage 1");
    let takes = robot.to("takes luggage 1");
    let told = failure(|| _ = run.expect("Robot8"));
    assert!(told.starts_with("the run has no component `Robot8`; it has World, "), "{told}");
    let told = failure(|| drop(robot.to("sings")));
    assert!(told.starts_with("Robot7 did not do `sings`; it did\n  0.") && told.contains("more"), "{told}");
    let told = failure(|| drop(collects.clone().before(&takes)));
    assert!(told.contains("collects luggage 1") && told.contains(" is not before `Robot7 takes luggage 1 "), "{told}");
    let told = failure(|| drop(takes.clone().after(Duration::from_secs(50))));
    assert!(told.ends_with(" is not after 50.000 s"), "{told}");
    let told = failure(|| robot.never_to("takes luggage"));
    assert!(told.starts_with("Robot7 did `takes luggage`: "), "{told}");
    let told = failure(|| drop(collects.clone().because("the moon is full")));
    assert!(told.contains("does not follow from `the moon is full`, but from\n  "), "{told}");
    let told = failure(|| drop(collects.again()));
    assert!(told.starts_with("Robot7 did not do `collects luggage 1` again after "), "{told}");
}

#[test]
fn an_expanded_fleet_is_held_to_a_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("hall.composite");
    let fleet = Fleet::of_file("../composites/hall.composite");
    let told = failure(|| fleet.expect_expanded(&path));
    assert!(told.contains("hall.composite` says:\n+ <composite ") && told.contains("UPDATE_EXPECT=1"), "{told}");
    let (_, text) = told.split_once("says:\n").unwrap();
    let lines: String = text.lines().filter_map(|line| Some(line.strip_prefix("+ ")?.to_owned() + "\n")).collect();
    std::fs::write(&path, lines).unwrap();
    fleet.expect_expanded(&path);
}

#[test]
fn folders_without_composites_are_no_success() {
    let folder = tempfile::tempdir().unwrap();
    assert!(failure(|| expect_diagnostics(folder.path())).starts_with("there are no files `*.composite` in"));
}
