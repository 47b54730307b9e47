//! Critical situations by the manual's rules: who heals whom, and how.

use super::fleet::fleet;
use super::run::Run;

fn run(scenario: &str, robots: &[&str]) -> Run {
    Run::with(&fleet("classic", "", &format!("{scenario}; at 60s end"), robots), 100)
}

#[test]
fn a_robot_with_luggage_gets_a_healer_that_collects_it_there() {
    let run = run("at 1s luggage (3,1) to (9,5); at 14s breakdown 1", &["1", "3", "5", "7 asleep=true"]);
    assert_eq!(
        run.story("Robot001"),
        "\
2: claims (3,1) to (9,5), 100.0
6: arrives, 96.0
7: collects, 94.0
"
    );
    assert_eq!(
        run.story("Robot003"),
        "\
15: would heal 1, 100.0
16: heals and awakes another, 100.0
27: arrives, 80.0
28: collects, 78.0
33: arrives, 68.0
34: deposits, 66.0
50: goes under charge, 34.0
"
    );
    assert_eq!(run.story("Robot007"), "0: is charged, 100.0\n");
    assert_eq!(run.count("luggage", "delivered"), 1);
}

#[test]
fn a_robot_on_its_way_gets_a_healer_that_takes_its_whole_job() {
    let run = run("at 1s luggage (3,1) to (9,5); at 5s breakdown 1", &["1", "3", "5"]);
    assert_eq!(
        run.story("Robot003"),
        "\
6: would heal 1, 100.0
7: heals and awakes another, 100.0
12: arrives, 92.0
13: collects, 90.0
24: arrives, 68.0
25: deposits, 66.0
41: goes under charge, 34.0
52: is in charge, 12.0
"
    );
    assert_eq!(run.count("luggage", "delivered"), 1);
}

#[test]
fn for_a_robot_without_a_job_the_best_charged_one_is_woken() {
    let run = run(
        "at 3s breakdown 1",
        &["1", "3", "5 asleep=true battery=60 discharge=0.2", "6 asleep=true", "7 asleep=true"],
    );
    assert_eq!(
        run.story("Robot003"),
        "\
4: would heal 1, 100.0
5: heals and awakes another, 100.0
"
    );
    assert_eq!(run.log("Robot005"), [""; 0]);
    assert_eq!(run.log("Robot006"), ["5.000 s wakes up (battery 100.0 %)"]);
    assert_eq!(run.log("Robot007"), [""; 0]);
}

#[test]
fn a_healer_that_breaks_before_it_heals_asks_for_the_other_one_again() {
    let run = run("at 1s luggage (3,1) to (9,5); at 14s breakdown 1; at 15s breakdown 3", &["1", "3", "5"]);
    assert_eq!(run.story("Robot003"), "15: would heal 1, 100.0\n");
    assert_eq!(
        run.story("Robot005"),
        "\
16: would heal 3, 100.0
17: heals and awakes another, 100.0
18: would heal 1, 100.0
19: heals and awakes another, 100.0
32: arrives, 76.0
33: collects, 74.0
38: arrives, 64.0
39: deposits, 62.0
53: goes under charge, 34.0
"
    );
    assert_eq!(run.count("luggage", "delivered"), 1);
}

#[test]
fn a_healer_that_breaks_on_its_way_is_healed_itself() {
    let run = run("at 1s luggage (3,1) to (9,5); at 14s breakdown 1; at 20s breakdown 3", &["1", "3", "5"]);
    assert_eq!(
        run.story("Robot005"),
        "\
21: would heal 3, 100.0
22: heals and awakes another, 100.0
35: arrives, 76.0
36: collects, 74.0
41: arrives, 64.0
42: deposits, 62.0
56: goes under charge, 34.0
"
    );
    assert_eq!(run.count("luggage", "delivered"), 1);
}

#[test]
fn what_a_broken_robot_took_an_interest_in_waits_again() {
    let run = run("at 1s luggage (3,1) to (9,5); at 2s breakdown 1", &["1", "9"]);
    assert_eq!(run.story("Robot001"), "2: claims (3,1) to (9,5), 100.0\n");
    assert_eq!(
        run.story("Robot009"),
        "\
3: would heal 1, 100.0
4: heals and awakes another, claims (3,1) to (9,5), 100.0
16: arrives, 80.0
17: collects, 78.0
28: arrives, 56.0
29: deposits, 54.0
39: goes under charge, 34.0
52: is in charge, 8.0
"
    );
    assert_eq!(run.count("luggage", "delivered"), 1);
}
