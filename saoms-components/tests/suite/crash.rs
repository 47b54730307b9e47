//! A program that ends while the code of a robot runs goes on without that execution, of which the world knows: no
//! collision, and every piece delivered once.

use std::time::Duration;

use saoms_components::environment::Environment;
use saoms_components::master::MasterEnvironment;
use saoms_components::robot::Robot;
use saoms_components::world::World;
use saoms_components::zone::Zone;

use crate::host::Fleet;

const PIECES: i64 = 6;

/// A small fleet with a zone, and the places of its robots.
fn fleet(time: &str) -> (Fleet, Vec<usize>) {
    let mut fleet = Fleet::new(1, 0.0);
    let (zero, period) = (Duration::ZERO, Duration::from_millis(100));
    let map = [("width", "3"), ("height", "3"), ("moveTime", time), ("handlingTime", time)];
    let world = fleet.add::<World>("World", period, zero, &map, &[]);
    fleet.add::<Zone>("Zone", period, period / 2, &[], &[("world", world, "hardware")]);
    fleet.add::<MasterEnvironment>("MasterEnvironment", period, zero, &[], &[]);
    let lines =
        ["(0,0) to (2,2)", "(2,0) to (0,2)", "(2,2) to (0,0)", "(0,2) to (2,0)", "(1,0) to (1,2)", "(1,2) to (1,0)"];
    let scenario: String = lines.iter().map(|line| format!("at 0.2s luggage {line}\n")).collect();
    fleet.add::<Environment>("Environment", period, zero, &[("scenario", &scenario)], &[]);
    let robots = [("Robot1", "0", "1"), ("Robot2", "2", "1"), ("Robot3", "1", "0")].map(|(id, x, y)| {
        let properties = [("ID", id), ("chargeX", x), ("chargeY", y), ("discharge", "0.1")];
        fleet.add::<Robot>(id, period, zero, &properties, &[("world", world, "hardware")])
    });
    fleet.initialize().unwrap();
    (fleet, robots.to_vec())
}

/// Runs until all is delivered; the time of that.
fn check(mut fleet: Fleet, context: &str) -> Duration {
    let is_done = fleet.run(Duration::from_secs(200));
    let tail = fleet.log[fleet.log.len().saturating_sub(30)..].join("\n");
    let collisions = fleet.count("collisions.vertex") + fleet.count("collisions.swap");
    assert_eq!((collisions, fleet.count("stranded")), (0, 0), "{context}: {tail}");
    assert!(is_done && fleet.count("luggage.delivered") == PIECES, "{context}: {:?} {tail}", fleet.counts);
    Duration::from_nanos(fleet.time().as_nanos())
}

#[test]
fn an_execution_that_is_lost_moves_no_robot_into_another() {
    for time in ["0ms", "150ms", "320ms"] {
        let (calm, robots) = fleet(time);
        let took = check(calm, time);
        let executions = (took.as_millis() / 100) as u64;
        for robot in robots {
            for execution in 0..executions {
                let (mut fleet, _) = fleet(time);
                fleet.crash = Some((robot, execution));
                check(fleet, &format!("{time}, component {robot}, execution {execution} of {executions}"));
            }
        }
    }
}
