//! Robots on wheels that take their time and fail, with the plugin's code linked in.

use std::time::Duration;

use saoms_drive as _;
use saoms_testkit::{Fleet, Run};

fn run(wears_out_after: u32, jams: f64, seed: u64) -> Run {
    let fleet = Fleet::of_file("fleet.composite")
        .set("wearsOutAfter", &wears_out_after.to_string())
        .set("jams", &jams.to_string());
    assert_eq!(fleet.diagnostics(), "");
    fleet.run(seed, Duration::from_secs(600))
}

fn count(run: &Run, section: &str, name: &str) -> u64 {
    run.sections[section][name].as_u64().unwrap_or_default()
}

#[test]
fn no_luggage_is_lost_whenever_the_wheels_wear_out() {
    // On the way to the luggage, at the luggage, carrying it, and just before the end.
    for wears_out_after in [0, 1, 3, 4, 6, 8, 9] {
        let run = run(wears_out_after, 0.0, 1);
        assert_eq!(count(&run, "luggage", "delivered"), 2, "after {wears_out_after}: {}", run.log());
        assert_eq!(run.sections["assistance"], 1, "after {wears_out_after}: {}", run.log());
        assert_eq!(count(&run, "collisions", "vertex"), 0, "after {wears_out_after}: {}", run.log());
        // The fifth failure in a row is a breakdown.
        assert_eq!(count(&run, "drive", "jams"), 5, "after {wears_out_after}: {}", run.log());
    }
}

#[test]
fn wheels_that_jam_now_and_then_only_take_longer() {
    let mut jams = 0;
    for seed in 1..=5 {
        let run = run(1_000_000, 0.1, seed);
        assert_eq!(count(&run, "luggage", "delivered"), 2, "seed {seed}: {}", run.log());
        jams += count(&run, "drive", "jams");
        assert_eq!(run.trace_hash, self::run(1_000_000, 0.1, seed).trace_hash, "the same seed, the same jams");
    }
    assert!(jams > 0);
}

#[test]
fn wheels_wait_at_the_edge_of_a_block_while_the_world_is_busy() {
    let fleet = |second| {
        Fleet::of_file("fleet.composite").set("jams", "0").set("wearsOutAfter", "1000000").slow(
            "World",
            Duration::from_secs(second),
            Duration::from_millis(700),
        )
    };
    for second in 1..=5 {
        let run = fleet(second).run(1, Duration::from_secs(600));
        assert_eq!(count(&run, "luggage", "delivered"), 2, "at {second} s: {}", run.log());
        let robots = run.sections["robots"]["by_path"].as_object().unwrap();
        assert!(robots.values().all(|robot| robot["state"] == "free"), "at {second} s: {robots:?}");
        assert!(run.into_report().components.iter().all(|one| one.failures == 0), "at {second} s");
    }
}

#[test]
fn given_moves_jam() {
    let text = std::fs::read_to_string("fleet.composite").unwrap();
    let jams = "<property name=\"jamsAt\" many=\"true\"><value>2</value><value>5</value></property>";
    let text = text.replacen("<property name=\"wearsOutAfter\" source=\"$wearsOutAfter\"/>", jams, 1);
    let run = Fleet::of_text(text).set("jams", "0").run(1, Duration::from_secs(600));
    let log = run.log_of("Wheels1");
    assert_eq!(log.iter().filter(|line| line.starts_with("jams in move")).count(), 2, "{}", run.log());
    assert!(log[0].starts_with("jams in move 2, from ") && log[1].starts_with("jams in move 5, from "), "{log:?}");
}

#[test]
fn each_robot_has_its_own_wheels() {
    let text = std::fs::read_to_string("fleet.composite").unwrap();
    let run = std::panic::catch_unwind(|| {
        Fleet::of_text(text.replace("target=\"Wheels2\"", "target=\"Wheels1\"")).run(1, Duration::from_secs(1))
    });
    let said = *run.expect_err("it does not start").downcast::<String>().unwrap();
    assert!(said.contains("these are the wheels of robot 1"), "{said}");
}
