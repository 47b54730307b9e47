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
