//! Robots that break at every moment of their work: no luggage is lost or delivered twice, and no robots collide.

use std::time::Duration;

use saoms_api::{Chance, Class, Component, Context, Failure, Properties, Publisher};
use saoms_components::environment::Environment;
use saoms_components::master::{MasterEnvironment, MasterRobot};
use saoms_components::messages::{FAULT, Fault};
use saoms_components::robot::Robot;
use saoms_components::world::World;

use crate::host::Fleet;

/// Breaks robots: each value is a time in milliseconds and a robot's number.
#[derive(Class)]
#[class(name = "test.Fate", periodic, publishes(FAULT))]
struct Fate {
    strokes: Vec<(u64, u32)>,
    faults: Publisher<Fault>,
}

#[derive(Properties)]
struct FateProperties {
    strokes: Vec<String>,
}

impl Component for Fate {
    type Properties = FateProperties;

    fn new(properties: FateProperties) -> Result<Self, Failure> {
        let strokes = properties.strokes.iter().flat_map(|stroke| stroke.split(';')).map(|stroke| {
            let (time, robot) = stroke.split_once(' ').unwrap();
            (time.parse().unwrap(), robot.parse().unwrap())
        });
        Ok(Fate { strokes: strokes.collect(), faults: Publisher::default() })
    }

    fn initialize(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.faults = context.publish(&FAULT)?;
        Ok(())
    }

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        let now = context.now().as_nanos() / 1_000_000;
        for (_, robot) in self.strokes.extract_if(.., |(time, _)| *time <= now) {
            context.send(&self.faults, Fault::breakdown(robot))?;
        }
        Ok(())
    }
}

/// A small fleet with robots that break.
struct Emergency<'a> {
    robots: u32,
    /// Robots that start asleep.
    asleep: &'a [u32],
    scenario: &'a str,
    /// Time of each breakdown in milliseconds, and number of the robot.
    strokes: Vec<(u64, u32)>,
    lateness: f64,
    move_time: u64,
    handling_time: u64,
    seed: u64,
    /// Number of periods after which a master sends robots to sleep again; 0 for no master.
    counter: u32,
    blocked: &'a str,
    discharge: &'a str,
}

/// Number of fleets with random breakdowns.
const SEEDS: u64 = 6;

const TWO: &str = "at 500ms luggage (3,1) to (3,6); at 500ms luggage (6,4) to (1,4)";

impl Default for Emergency<'_> {
    fn default() -> Self {
        Emergency {
            robots: 3,
            asleep: &[],
            scenario: TWO,
            strokes: Vec::new(),
            lateness: 0.0,
            move_time: 0,
            handling_time: 0,
            seed: 0,
            counter: 0,
            blocked: "",
            discharge: "0.5",
        }
    }
}

impl Emergency<'_> {
    fn fleet(&self) -> Fleet {
        let (zero, fast) = (Duration::ZERO, Duration::from_millis(20));
        let mut fleet = Fleet::new(self.seed, self.lateness);
        let mut chance = Chance::for_component(self.seed, "emergency");
        let millis = |time: u64| format!("{time}ms");
        let (moving, handling) = (millis(self.move_time), millis(self.handling_time));
        let times = [
            ("moveTime", &*moving),
            ("handlingTime", &*handling),
            ("width", "8"),
            ("height", "8"),
            ("blocked", self.blocked),
        ];
        let times = &times[..if self.blocked.is_empty() { 4 } else { 5 }];
        let world = fleet.add::<World>("World", fast, zero, times, &[]);
        fleet.add::<MasterEnvironment>("MasterEnvironment", fast, zero, &[], &[]);
        fleet.add::<Environment>("Environment", fast, zero, &[("scenario", self.scenario)], &[]);
        let strokes: Vec<String> = self.strokes.iter().map(|(time, robot)| format!("{time} {robot}")).collect();
        if !strokes.is_empty() {
            fleet.add::<Fate>("Fate", fast, zero, &[("strokes", &strokes.join(";"))], &[]);
        }
        if self.counter > 0 {
            let (period, counter) = (Duration::from_millis(100), self.counter.to_string());
            fleet.add::<MasterRobot>("MasterRobot", period, zero, &[("counter", &counter)], &[]);
        }
        for robot in 1..=self.robots {
            let late = self.lateness > 0.0;
            let period = Duration::from_millis(if late { chance.range(50..=150) } else { 100 });
            let delay = Duration::from_millis(if late { chance.below(100) } else { 0 });
            let id = format!("Robot{robot:03}");
            let asleep = self.asleep.contains(&robot).to_string();
            let properties = [("ID", &*id), ("asleep", &asleep), ("discharge", self.discharge)];
            fleet.add::<Robot>(&id, period, delay, &properties, &[("world", world, "hardware")]);
        }
        fleet.initialize().unwrap();
        fleet
    }

    /// Runs the fleet, and checks that every piece is delivered once.
    fn check(&self) -> Fleet {
        let fleet = self.check_settled();
        assert_eq!(fleet.count("luggage.open"), 0, "{:?}: {:#?}", self.strokes, fleet.log);
        fleet
    }

    /// Runs the fleet, and checks that every piece is delivered once or given up.
    fn check_settled(&self) -> Fleet {
        let mut fleet = self.fleet();
        let done = fleet.run(Duration::from_secs(300));
        let tail = fleet.log[fleet.log.len().saturating_sub(40)..].join("\n");
        let context = format!(
            "strokes {:?}, lateness {}, seed {}, {}: {:?}\n{tail}",
            self.strokes,
            self.lateness,
            self.seed,
            fleet.time(),
            fleet.counts
        );
        assert!(done, "not finished: {context}");
        for count in ["collisions.vertex", "collisions.swap", "stranded"] {
            assert_eq!(fleet.count(count), 0, "{count}: {context}");
        }
        let open = fleet.count("luggage.open");
        assert_eq!(fleet.count("luggage.delivered") + open, fleet.count("luggage.requested"), "{context}");
        // Reported by the master, or by the robot that carries it.
        let is_told = |line: &&String| line.contains("gives up luggage") || line.contains("any more: ");
        let given_up = fleet.log.iter().filter(is_told).count();
        assert_eq!(given_up as i64, open, "{context}");
        fleet
    }
}

/// Fleets with messages that arrive at once or late, and with hardware that takes no time or some.
fn variants() -> impl Iterator<Item = Emergency<'static>> {
    [(0.0, 0, 0), (0.99, 0, 0), (0.9, 170, 230)].into_iter().zip(0..).map(
        |((lateness, move_time, handling_time), seed)| Emergency {
            lateness,
            move_time,
            handling_time,
            seed,
            ..Emergency::default()
        },
    )
}

#[test]
fn a_robot_breaks_at_any_moment_and_another_one_takes_over() {
    for variant in variants() {
        let slow = 1 + variant.move_time / 60;
        for (moment, robot) in (0..60).flat_map(|moment| [(moment, 1 + moment as u32 % 3)]) {
            let strokes = vec![(moment * 50 * slow, robot)];
            let fleet = Emergency { strokes, ..variant }.check();
            assert!(fleet.count("assistance") <= 1);
        }
    }
}

#[test]
fn the_healer_breaks_as_well() {
    for variant in variants() {
        let slow = 1 + variant.move_time / 60;
        for (moment, later) in
            (10..30).step_by(3).flat_map(|moment| (0..9).map(move |later| (moment, later * 5 + moment % 5)))
        {
            let moment = moment * 100 * slow;
            let strokes = vec![(moment, 1), (moment + later * 50 * slow, 2)];
            Emergency { strokes, ..variant }.check();
        }
    }
}

#[test]
fn two_robots_break_at_once() {
    for variant in variants() {
        let slow = 1 + variant.move_time / 60;
        for moment in (6..50).step_by(2) {
            let time = moment * 50 * slow;
            let strokes = vec![(time, 1), (time, 3)];
            let fleet = Emergency { robots: 4, strokes, ..variant }.check();
            assert!(fleet.count("assistance") <= 2);
        }
    }
}

#[test]
fn who_sleeps_is_woken_when_all_others_break() {
    for variant in variants() {
        let slow = 1 + variant.move_time / 60;
        for moment in (6..60).step_by(3) {
            let time = moment * 50 * slow;
            let strokes = vec![(time, 1), (time + moment % 5 * 60, 3)];
            let fleet = Emergency { robots: 4, asleep: &[2, 4], strokes, ..variant }.check();
            let woken = fleet.log.iter().filter(|line| line.contains("Info: wakes up")).count();
            assert!(woken <= 4 && (woken > 0 || fleet.count("assistance") < 2), "{:#?}", fleet.log);
        }
    }
}

#[test]
fn what_nobody_is_left_for_is_given_up() {
    for variant in variants() {
        let slow = 1 + variant.move_time / 60;
        for moment in (6..50).step_by(2) {
            let time = |robot: u64| (moment + robot * (moment % 4)) * 50 * slow;
            let strokes = (1..=3).map(|robot| (time(robot.into()), robot)).collect();
            let mut fleet = Emergency { strokes, ..variant }.fleet();
            assert!(fleet.run(Duration::from_secs(60)), "not finished: {:#?}", fleet.log);
            let (delivered, open) = (fleet.count("luggage.delivered"), fleet.count("luggage.open"));
            assert_eq!(delivered + open, 2, "{:#?} {:?}", fleet.log, fleet.counts);
            // Reported by the master, or by the robot that carries it.
            let is_told = |line: &&String| line.contains("gives up luggage") || line.contains("any more: ");
            let given_up = fleet.log.iter().filter(is_told).count();
            assert_eq!(given_up as i64, open, "{:#?}", fleet.log);
            assert_eq!((fleet.count("collisions.vertex"), fleet.count("collisions.swap")), (0, 0));
        }
    }
}

#[test]
fn a_broken_robot_is_in_nobodys_way() {
    // Robots 1 and 2 break at the luggage and at its destination.
    let scenario = "at 100ms luggage (0,1) to (5,5); at 100ms luggage (6,6) to (0,2); at 100ms luggage (0,1) to (0,2)";
    let strokes = vec![(50, 1), (50, 2)];
    Emergency { scenario, strokes, ..Emergency::default() }.check();
}

#[test]
fn a_landing_awakes_robots_that_sleep_again_afterwards() {
    let scenario =
        "at 1s landing 4; at 2s luggage (3,1) to (3,6); at 2s luggage (6,4) to (1,4); at 20s luggage (5,5) to (6,6)";
    let asleep = &[2, 3, 4];
    let fleet = Emergency { scenario, robots: 4, asleep, counter: 50, ..Emergency::default() }.check();
    let told = |what: &str| fleet.log.iter().filter(|line| line.ends_with(what)).count();
    assert_eq!((told("Info: wakes up"), told("Info: sleeps")), (2, 2), "{:#?}", fleet.log);
}

#[test]
fn a_robot_that_charges_awakes_a_substitute_and_sleeps() {
    let scenario = (0..12).map(|_| "at 1s luggage (5,1) to (5,6);").collect::<String>();
    let emergency = Emergency { scenario: &scenario, asleep: &[2], robots: 2, ..Emergency::default() };
    let fleet = emergency.check();
    let found = |what: &str| fleet.log.iter().any(|line| line.ends_with(what));
    assert!(found("Robot001: Info: wakes robot 2 to stand in for robot 1"), "{:#?}", fleet.log);
    assert!(found("Robot002: Info: wakes up") && found("Robot001: Info: sleeps"), "{:#?}", fleet.log);
    assert_eq!(fleet.count("assistance"), 0);
}

#[test]
fn a_robot_whose_charger_is_cut_off_uses_that_of_another_one() {
    // Only the blocks of the robots beside it lead to the charger of robot 2, and these robots break while it is away.
    let scenario = "at 500ms luggage (2,2) to (6,6); then 5s luggage (7,7) to (6,0); then 5s luggage (7,2) to (1,7);\
        then 5s luggage (7,7) to (6,0); then 5s luggage (7,2) to (1,7)";
    let strokes = vec![(3000, 1), (3000, 3)];
    let emergency =
        Emergency { scenario, strokes, robots: 4, blocked: "(1,2)", discharge: "2", ..Emergency::default() };
    let fleet = emergency.check();
    let found = |what: &str| fleet.log.iter().any(|line| line.ends_with(what));
    assert!(found("Robot002: Info: charges at (0,4) from now on"), "{:#?}", fleet.log);
}

#[test]
fn luggage_that_is_cut_off_is_given_up() {
    // The way to the corner leads past (7,6) and (6,7), where the robots that collect there break.
    let scenario = "at 500ms luggage (7,6) to (6,0); at 500ms luggage (6,7) to (6,0); at 9s luggage (7,7) to (0,0);\
        at 9s luggage (4,4) to (7,7); at 9s luggage (4,4) to (5,5)";
    for asleep in [&[][..], &[4]] {
        let mut fleet = Emergency { scenario, robots: 4, asleep, ..Emergency::default() };
        let collected = |fleet: &Fleet, block: &str| {
            let line = fleet.log.iter().find(|line| line.contains("collected") && line.ends_with(block))?;
            let (time, rest) = line.split_once(" s Robot")?;
            Some(((time.parse::<f64>().ok()? * 1000.0) as u64, rest[..3].parse().ok()?))
        };
        let before = fleet.check();
        fleet.strokes = ["(7,6)", "(6,7)"].iter().filter_map(|block| collected(&before, block)).collect();
        let mut fleet = fleet.fleet();
        assert!(fleet.run(Duration::from_secs(100)), "not finished: {:#?}", fleet.log);
        assert_eq!(fleet.count("luggage.delivered") + fleet.count("luggage.open"), 5, "{:#?}", fleet.log);
        assert!(fleet.count("luggage.open") > 0, "{:#?}", fleet.log);
    }
}

#[test]
fn fleets_lose_robots_and_deliver_what_they_can_reach() {
    let mut open = 0;
    for seed in 0..SEEDS {
        let mut chance = Chance::for_component(seed, "losses");
        let scenario: String = (0..30)
            .map(|_| {
                let [x, y, to_x, to_y] = [0; 4].map(|_| chance.below(8));
                let to_x = if (x, y) == (to_x, to_y) { (to_x + 1) % 8 } else { to_x };
                format!("at {}ms luggage ({x},{y}) to ({to_x},{to_y});", 500 + chance.below(10_000))
            })
            .collect();
        let strokes = (0..4).map(|_| (chance.below(20_000), chance.range(1..=7) as u32)).collect();
        let asleep: &[u32] = if seed % 2 == 0 { &[] } else { &[5, 6, 7] };
        let lateness = [0.0, 0.9, 0.99][seed as usize % 3];
        let emergency = Emergency {
            robots: 7,
            asleep,
            scenario: &scenario,
            strokes,
            lateness,
            discharge: "1.5",
            seed,
            ..Emergency::default()
        };
        open += emergency.check_settled().count("luggage.open");
    }
    // A broken robot or two may enclose a corner.
    assert!(open * 40 < 30 * SEEDS as i64, "{open} pieces given up");
}
