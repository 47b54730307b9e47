//! The master of the robots: who is woken for a landing or a take-off, and who is sent to charge again.

use super::fleet::fleet;
use super::run::Run;

/// The acts of the master of these classic robots in a minute, with times.
fn master(properties: &str, scenario: &str, robots: &[&str]) -> String {
    run(properties, scenario, robots).log("MRMS").join("\n")
}

fn run(properties: &str, scenario: &str, robots: &[&str]) -> Run {
    // The last event keeps the run going.
    Run::with(&fleet("classic", properties, &format!("{scenario}; at 90s end"), robots), 60)
}

#[test]
fn one_robot_for_two_pieces_is_woken_by_battery_and_number() {
    let robots = ["1", "2 asleep=true battery=40", "3 asleep=true", "4 asleep=true battery=2", "5 asleep=true"];
    let run = run("", "at 2s landing 3", &robots);
    // The second and the fourth are still charging.
    assert_eq!(run.log("MRMS"), ["2.500 s wakes robots 3 and 5", "27.500 s sends robots 5 and 3 to charge"]);
    assert_eq!(
        run.story("Robot003"),
        "0: is charged, 100.0\n28: goes under charge, is in charge, 100.0\n29: is charged, 100.0\n"
    );
}

#[test]
fn a_takeoff_counts_as_a_landing_does() {
    let robots = ["1 asleep=true", "2 asleep=true"];
    let happens = "3.500 s wakes robot 1\n28.500 s sends robot 1 to charge";
    assert_eq!(master("", "at 3s takeoff 2", &robots), happens);
    assert_eq!(master("", "at 3s landing 2", &robots), happens);
}

#[test]
fn pieces_and_periods_can_be_set() {
    let robots = ["1 asleep=true", "2 asleep=true", "3 asleep=true"];
    assert_eq!(
        master("piecesPerRobot=3 counter=10", "at 3s landing 5", &robots),
        "3.500 s wakes robots 1 and 2\n8.500 s sends robots 2 and 1 to charge"
    );
}

#[test]
fn robots_stay_where_one_shift_follows_another() {
    let robots = ["1 asleep=true", "2 asleep=true", "3 asleep=true"];
    assert_eq!(
        master("counter=20", "at 3s landing 4; at 13s landing 2", &robots),
        "3.500 s wakes robots 1 and 2\n13.500 s sends robot 2 to charge\n23.500 s sends robot 1 to charge"
    );
}

#[test]
fn only_as_many_are_sent_away_as_were_woken() {
    assert_eq!(
        master("", "at 3s landing 6", &["1", "2", "3 asleep=true"]),
        "3.500 s wakes robot 3\n3.500 s needs 2 more robots, but none is asleep\n28.500 s sends robot 3 to charge"
    );
    // Where no robot sleeps, none is called, least of all a robot 0.
    let run = run("", "at 3s landing 4", &["1", "2"]);
    assert_eq!(run.log("MRMS"), ["3.500 s needs 2 more robots, but none is asleep"]);
}

#[test]
fn who_is_sent_away_ends_its_job_charges_and_sleeps() {
    let luggage = "at 3s landing 2; at 12s luggage (3,1) to (3,10)";
    let run = run("counter=20", luggage, &["1 asleep=true", "2 asleep=true"]);
    assert_eq!(run.log("MRMS"), ["3.500 s wakes robot 1", "13.500 s sends robot 1 to charge"]);
    assert_eq!(run.count("luggage", "delivered"), 1);
    // Nobody stands in for it: the other robot sleeps on.
    assert_eq!(
        run.story("Robot001"),
        "\
0: is charged, 100.0
13: claims (3,1) to (3,10), 100.0
17: arrives, 96.0
18: collects, 94.0
28: arrives, 74.0
29: deposits, 72.0
30: goes under charge, 70.0
42: is in charge, 46.0
48: is charged, 100.0
"
    );
    assert_eq!(run.story("Robot002"), "0: is charged, 100.0\n");
}
