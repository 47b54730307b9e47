//! Robots that fail for good while those that are to hear of it are out.

use std::time::Duration;

use super::apart::{component, delivered, robot, site, zones};

const LIMIT: Duration = Duration::from_secs(150);

/// A robot fails on its way along the upper row, where blocks before it are granted. Another one brings luggage to each
/// block of that row then; only where the failed robot stands it cannot.
#[test]
fn the_blocks_that_were_granted_to_a_robot_are_free_whoever_is_out_when_it_fails() {
    let map = ["............"; 3].join("\n");
    let given = [("moveTime", "500ms"), ("restart", "onFailure")].map(|(name, value)| (name, value.to_owned()));
    let world: Vec<(&str, String)> = [("map", map)].into_iter().chain(given).collect();
    let robots = robot(1, 0, 0) + &robot(2, 11, 2) + &component("MasterRobot", "MasterRobot", &[]);
    let later: String = (2..=9).map(|x| format!("at 15s luggage (11,1) to ({x},0)\n")).collect();
    for out in [
        "crash Master restart 2s",
        "crash Zone1 restart 2s",
        "crash Zone* restart 2s",
        "crash World restart 2s",
        "crash Master, Zone* restart 2s",
        "crash Master, Zone*, World restart 2s",
    ] {
        for tenths in [33, 37, 42, 48] {
            let (second, tenth) = (tenths / 10, tenths % 10);
            let scenario = format!(
                "at 0.5s luggage (1,0) to (10,0)
                at 3.1s {out}
                at {second}.{tenth}s crash Robot1
                {later}"
            );
            let fleet = site(&world, &zones(2, 6), &robots, &scenario);
            let run = fleet.run(1, LIMIT);
            let context = format!("{out}, fails at {second}.{tenth} s: {}", run.log());
            assert!(delivered(&run) >= 8, "{} delivered: {context}", delivered(&run));
            assert_eq!(fleet.violations(1, LIMIT), "", "{context}");
        }
    }
}
