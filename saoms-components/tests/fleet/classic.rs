//! The manual's scenarios 1 and 2 by its own rules: the facts of its transcripts.

use std::time::Duration;

use saoms_components::environment::Environment;
use saoms_components::master::{MasterEnvironment, MasterRobot};
use saoms_components::robot::Robot;
use saoms_components::world::World;

use crate::host::Fleet;

const SECOND: Duration = Duration::from_secs(1);
const HALF: Duration = Duration::from_millis(500);

const THREE: &str = "at 6s luggage (3,1) to (3,10)
    then 1s luggage (1,5) to (10,5)
    then 0.5s luggage (10,8) to (1,8)";

fn scenario(events: &str, robots: usize, world: bool) -> Fleet {
    let mut fleet = Fleet::new(1, 0.0);
    let zero = Duration::ZERO;
    fleet.add::<MasterEnvironment>("MasterEnvironment", HALF, zero, &[], &[]);
    fleet.add::<MasterRobot>("MasterRobot", HALF, zero, &[], &[]);
    fleet.add::<Environment>("Environment", HALF, zero, &[("scenario", events)], &[]);
    let place = world.then(|| fleet.add::<World>("World", HALF, zero, &[], &[]));
    let wires: Vec<_> = place.into_iter().map(|place| ("world", place, "hardware")).collect();
    for robot in 1..=robots {
        let (id, delay) = (format!("Robot{robot:03}"), HALF * (robot as u32 - 1));
        fleet.add::<Robot>(&id, SECOND, delay, &[("ID", &id), ("policy", "classic")], &wires);
    }
    fleet.initialize().unwrap();
    assert!(fleet.run(Duration::from_secs(200)), "not finished: {:#?}", fleet.log);
    fleet
}

impl Fleet {
    /// In which executions of a robot a line that starts like this was shown.
    fn executions(&self, robot: &str, line: &str) -> Vec<u32> {
        let start = format!("{robot} {line}");
        let mut execution = 0;
        let mut found = Vec::new();
        for shown in &self.console {
            if let Some(rest) = shown.strip_prefix("Execution ")
                && rest.contains(robot)
            {
                execution = rest.split(' ').next().and_then(|number| number.parse().ok()).unwrap();
            }
            if shown.starts_with(&start) {
                found.push(execution);
            }
        }
        found
    }

    /// The lines of one execution of a robot.
    fn lines(&self, robot: &str, execution: u32) -> Vec<&str> {
        let start = format!("Execution {execution} of {robot} ");
        let lines =
            self.console.iter().map(String::as_str).skip_while(|line| !line.starts_with(&start)).skip(1);
        lines.take_while(|line| line.starts_with(robot)).collect()
    }
}

#[test]
fn scenario_1_happens_as_in_the_transcript() {
    for world in [true, false] {
        let fleet = scenario(THREE, 1, world);
        assert_eq!(fleet.executions("Robot001", "is bringing luggage"), [7, 24, 70]);
        assert_eq!(fleet.executions("Robot001", "says: Luggage collected."), [12, 33, 89]);
        assert_eq!(fleet.executions("Robot001", "says: Luggage deposited."), [23, 44, 100]);
        assert_eq!(fleet.executions("Robot001", "says: I've arrived to charge position."), [59]);
        assert_eq!(fleet.executions("Robot001", "is now fully charged"), [69, 70]);
        assert_eq!(fleet.count("luggage.delivered"), 3);
        assert_eq!(fleet.count("luggage.requested"), 3);
    }
}

#[test]
fn the_console_reads_like_figures_8_2_to_8_7() {
    let fleet = scenario(THREE, 1, true);
    let empty = ["Robot001 updated active robot list: []", "Robot001 luggage request list: []"];
    assert_eq!(fleet.lines("Robot001", 6), [empty[0], empty[1], "Robot001 battery level: 100.0"]);
    assert_eq!(
        fleet.lines("Robot001", 7),
        [
            empty[0],
            "Robot001 luggage request list: [Luggage to bring from (3,1) to (3,10)]",
            "Robot001 is bringing luggage from (3,1) to (3,10)",
            "Robot001 battery level: 100.0",
        ]
    );
    let two = "Robot001 luggage request list: [Luggage to bring from (1,5) to (10,5), Luggage to bring from (10,8) to (1,8)]";
    assert_eq!(
        fleet.lines("Robot001", 8),
        [
            empty[0],
            two,
            "Robot001 says: My position now is: (0,1) and my next position will be: (1,1)",
            "Robot001 battery level: 100.0",
        ]
    );
    let position = |execution: u32| fleet.lines("Robot001", execution)[2].to_owned();
    assert_eq!(position(9), "Robot001 says: My position now is: (1,1) and my next position will be: (2,1)");
    assert_eq!(position(10), "Robot001 says: My position now is: (2,1) and my next position will be: (3,1)");
    assert_eq!(
        fleet.lines("Robot001", 22)[2..],
        ["Robot001 says: I've arrived to destination.", "Robot001 battery level: 74.0"]
    );
    assert_eq!(
        fleet.lines("Robot001", 23)[2..],
        [
            "Robot001 says: Ready to deposit luggage in position (3,10)",
            "Robot001 says: Luggage deposited.",
            "Robot001 battery level: 72.0",
        ]
    );
    assert_eq!(fleet.lines("Robot001", 24).last(), Some(&"Robot001 battery level: 70.0"));
    assert_eq!(
        fleet.lines("Robot001", 58)[2..],
        [
            "Robot001 has low battery and is going under charge...",
            "Robot001 says: My position now is: (1,1) and my next position will be: (0,1)",
            "Robot001 needs to reach charge position as soon as possible!",
        ]
    );
    assert_eq!(
        fleet.lines("Robot001", 59)[2..],
        [
            "Robot001 has low battery and is going under charge...",
            "Robot001 says: I've arrived to charge position.",
            "Robot001 battery level: 0.0",
        ]
    );
    assert_eq!(fleet.lines("Robot001", 60).last(), Some(&"Robot001 battery level: 10.0"));
    assert_eq!(fleet.lines("Robot001", 69).last(), Some(&"Robot001 battery level: 100.0"));
}

#[test]
fn scenario_2_happens_as_in_the_transcript() {
    let fleet = scenario(&format!("{THREE}\nthen 0.5s luggage (3,1) to (3,10)"), 2, true);
    assert_eq!(fleet.executions("Robot001", "is bringing luggage"), [8, 27]);
    assert_eq!(fleet.executions("Robot001", "says: Luggage collected."), [15, 40]);
    assert_eq!(fleet.executions("Robot001", "says: Luggage deposited."), [26, 51]);
    assert_eq!(fleet.executions("Robot002", "is bringing luggage"), [6, 25]);
    assert_eq!(fleet.executions("Robot002", "says: Luggage collected."), [12, 36]);
    assert_eq!(fleet.executions("Robot002", "says: Luggage deposited."), [24, 47]);
    assert_eq!(fleet.count("luggage.delivered"), 4);
    // Figure 8.9: who sees whom first.
    assert_eq!(fleet.lines("Robot001", 0)[0], "Robot001 updated active robot list: []");
    assert_eq!(fleet.lines("Robot002", 0)[0], "Robot002 updated active robot list: [Robot1 is active]");
    assert_eq!(fleet.lines("Robot001", 1)[0], "Robot001 updated active robot list: [Robot2 is active]");
    // Figure 8.14.
    assert_eq!(
        fleet.lines("Robot002", 48)[1..],
        [
            "Robot002 updated other robot position list: [Position of Robot1 will be: (3,9)]",
            "Robot002 luggage request list: []",
            "Robot002 has low battery and is going under charge...",
            "Robot002 says: My position now is: (1,8) and my next position will be: (1,7)",
            "Robot002 battery level: 20.0",
        ]
    );
}

#[test]
fn the_risk_of_collision_of_figure_8_19_is_a_collision() {
    let fleet = scenario(&format!("{THREE}\nthen 0.5s luggage (3,1) to (3,10)"), 2, true);
    let other =
        |robot: u32| format!("updated other robot position list: [Position of Robot{robot} will be: (3,5)]");
    let list = "luggage request list: [Luggage to bring from (10,8) to (1,8), Luggage to bring from (3,1) to (3,10)]";
    let lines = |robot: &str, execution: u32| fleet.lines(robot, execution)[1..].join("\n");
    assert_eq!(
        lines("Robot002", 17).replace("Robot002 ", ""),
        format!(
            "{}\n{list}\nRobot002: RISK OF COLLISION DETECTED AND AVOIDED!\nbattery level: 82.0",
            other(1)
        )
    );
    assert_eq!(
        lines("Robot001", 18).replace("Robot001 ", ""),
        format!(
            "{}\n{list}\nRobot001: RISK OF COLLISION DETECTED AND AVOIDED!\nsays: My position now is: (3,5) and my next position will be: (4,5)\nbattery level: 84.0",
            other(2)
        )
    );
    assert!(lines("Robot002", 18).contains("My position now is: (3,5) and my next position will be: (3,6)"));
    assert_eq!((fleet.count("collisions.vertex"), fleet.count("collisions.swap")), (1, 0));
}
