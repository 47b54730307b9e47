//! Robots that somebody takes off the floor, where their words reach the zones late.

use std::time::Duration;

use super::apart::{delivered, robot, site, zones};

/// Two robots of a corridor, in which none gets past the other one; the first one is gone at some time.
#[test]
fn blocks_of_a_robot_that_is_gone_are_free_however_late_its_words_are() {
    let map = "
        @..@@@@@@@
        ..........
    ";
    let world = [("map", map.to_owned()), ("moveTime", "300ms".to_owned())];
    let robots = robot(1, 2, 0) + &robot(2, 1, 0);
    let faults = [
        "",
        "at 1s for 30s delay 2s from Robot1",
        "at 1s for 30s delay 2s on GRANTREQUESTTOPIC",
        "at 1s for 30s delay 2s on PRESENCETOPIC",
        "at 1s for 30s delay 2s to Robot1",
        "at 1s for 30s delay 2s on GRANTTOPIC",
        "at 1s for 30s delay 100ms to 3s from Robot1",
        "at 1s for 30s reorder 50 % by 1s from Robot1",
        "at 4s for 10s cut Robot1 from *",
        "at 4s for 10s part Robot1 from *",
        "at 4s for 10s part Robot1 from *\nat 1s for 30s delay 2s from Robot1",
    ];
    for fault in faults {
        for tenths in [20, 32, 47, 68] {
            let scenario = format!(
                "{fault}
                at 1s luggage (4,1) to (8,1)
                at {}.{}s gone Robot1
                at 30s luggage (3,1) to (8,1)",
                tenths / 10,
                tenths % 10
            );
            let run = site(&world, &zones(2, 5), &robots, &scenario).run(1, Duration::from_secs(80));
            assert_eq!(delivered(&run), 2, "{fault}, gone at {tenths} tenths of a second: {}", run.log());
        }
    }
}

/// It goes on for a while, and what it says then is not taken for its return: the others would keep its block at last.
#[test]
fn a_robot_that_hears_late_that_it_is_gone_is_in_nobodys_way() {
    let map = "
        @..@@@@@@@
        ..........
    ";
    let world = [("map", map.to_owned()), ("moveTime", "300ms".to_owned())];
    let robots = robot(1, 2, 0) + &robot(2, 1, 0);
    for tenths in (21..70).step_by(4) {
        let scenario = format!(
            "at 1s for 30s delay 2s to Robot1
            at 1s luggage (4,1) to (8,1)
            at {}.{}s gone Robot1
            at 30s luggage (3,1) to (2,0)",
            tenths / 10,
            tenths % 10
        );
        let fleet = site(&world, &zones(2, 5), &robots, &scenario);
        let run = fleet.run(1, Duration::from_secs(80));
        assert_eq!(delivered(&run), 2, "gone at {tenths} tenths of a second: {}", run.log());
        assert_eq!(fleet.violations(1, Duration::from_secs(80)), "", "gone at {tenths} tenths of a second");
    }
}

/// It goes on from what it had saved, and did not hear that somebody took it away meanwhile: it stays off its block,
/// which others may have entered.
#[test]
fn a_robot_that_is_gone_while_it_restarts_stays_off_the_floor() {
    let map = "
        ........
        ........
    ";
    let restarts =
        |robot: String| robot.replace("</component>", "<property name=\"restart\">onFailure</property></component>");
    let robots = restarts(robot(1, 0, 1)) + &restarts(robot(2, 0, 0));
    for fault in [
        // It restarts after it is gone, and what is said of that comes later.
        "at 1s for 9s delay 150ms\nat 2s crash Robot1 restart 3s\nat 4950ms gone Robot1",
        // The execution in which it hears that it is gone fails.
        "at 3s for 3s stall Robot1\nat 5s gone Robot1\nat 4s fail Robot1\nat 6100ms fail Robot1",
    ] {
        let scenario = format!("{fault}\nat 8s luggage (0,1) to (5,1)");
        let fleet = site(&[("map", map.to_owned())], &zones(1, 8), &robots, &scenario);
        let run = fleet.run(1, Duration::from_secs(60));
        assert_eq!(delivered(&run), 1, "{fault}: {}", run.log());
        assert_eq!(fleet.violations(1, Duration::from_secs(60)), "", "{fault}: {}", run.log());
        assert!(run.log_of("Robot1").iter().any(|line| line.starts_with("is gone from")), "{fault}: {}", run.log());
    }
}

/// What a world says of an earlier failure of a robot is not taken for its answer about a later one.
#[test]
fn robots_that_fail_again_and_again_keep_their_blocks_however_late_news_are() {
    let map = vec![".".repeat(11); 11].join("\n");
    let robots: String = (0..4).map(|robot| self::robot(robot + 1, 0, robot + 1)).collect();
    let scenario = "at 1s for 40s delay 0ms to 3s
        from 3s every 5s..9s 4 times crash Robot* restart 1s
        from 1s every 1s 40 times luggage random to random";
    let fleet = site(&[("map", map)], &zones(1, 11), &robots, scenario);
    for seed in 0..30 {
        let run = fleet.run(seed, Duration::from_secs(45));
        assert_eq!((run.count("collisions.vertex"), run.count("collisions.swap")), (0, 0), "{seed}: {}", run.log());
    }
}

/// Whoever is gone does not say so again: the event is not lost with the execution that hears it.
#[test]
fn a_zone_that_fails_as_it_hears_that_a_robot_is_gone_hears_it_again() {
    let map = "
        @..@@@@@@@
        ..........
    ";
    let world = [("map", map.to_owned()), ("moveTime", "300ms".to_owned())];
    let robots = robot(1, 2, 0) + &robot(2, 1, 0);
    for fault in ["crash Zone* restart 200ms", "crash Zone1 restart 200ms", "crash Zone2 restart 1s"] {
        for millis in (4600..4900).step_by(20) {
            let scenario = format!(
                "at 1s luggage (4,1) to (8,1)
                at {millis}ms gone Robot1
                at {millis}ms {fault}
                at 10s luggage (3,1) to (8,1)"
            );
            let run = site(&world, &zones(2, 5), &robots, &scenario).run(1, Duration::from_secs(40));
            assert_eq!(delivered(&run), 2, "{fault}, gone at {millis} ms: {}", run.log());
        }
    }
}

/// The corner is a block like all others.
#[test]
fn others_bring_luggage_past_a_robot_that_failed_in_any_block() {
    let map = [".....\n"; 4].concat();
    for zones in [String::new(), zones(1, 5)] {
        for (x, y) in [(0, 0), (0, 1), (1, 0), (4, 0)] {
            let scenario = format!(
                "at 1s luggage ({x},{y}) to (2,0)
                at 1400ms crash Robot1
                at 8s luggage (2,3) to (1,1)
                at 9s luggage (2,3) to (2,1)"
            );
            let world = [("map", map.clone()), ("moveTime", "500ms".to_owned())];
            let fleet = site(&world, &zones, &(robot(1, x, y) + &robot(2, 3, 3)), &scenario);
            let run = fleet.run(1, Duration::from_secs(100));
            assert_eq!(delivered(&run), 3, "({x},{y}): {}", run.log());
        }
    }
}
