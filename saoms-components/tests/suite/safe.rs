//! The `safe` policy: no collision, no stranded robot, every piece delivered once, whatever the periods and however
//! late messages are.

use std::fmt::Write as _;
use std::ops::RangeInclusive;
use std::time::Duration;

use saoms_api::Chance;
use saoms_components::environment::Environment;
use saoms_components::master::MasterEnvironment;
use saoms_components::robot::Robot;
use saoms_components::world::World;

use crate::host::Fleet;

/// A fleet on an area, with luggage at random blocks.
struct Setting {
    side: u64,
    /// The share of blocked blocks in percent.
    blocked: u64,
    robots: u64,
    luggage: u64,
    /// Periods of the robots in milliseconds.
    periods: RangeInclusive<u64>,
    /// Maximum delay of a robot's messages, as a share of its period.
    lateness: f64,
    move_time: Duration,
    /// Discharge of the slowest robot in an execution; the others discharge at the same rate over time.
    discharge: f64,
}

impl Default for Setting {
    fn default() -> Setting {
        Setting {
            side: 11,
            blocked: 0,
            robots: 10,
            luggage: 100,
            periods: 100..=100,
            lateness: 0.0,
            move_time: Duration::ZERO,
            discharge: 2.0,
        }
    }
}

impl Setting {
    /// Runs the setting with seeds from 0 on, and checks that everything is delivered in time and nothing goes wrong.
    fn check(&self, seeds: u64) {
        for seed in 0..seeds {
            let mut fleet = self.fleet(seed);
            let done = fleet.run(Duration::from_secs(2000));
            let tail = fleet.log[fleet.log.len().saturating_sub(20)..].join("\n");
            let context = format!("seed {seed}, {}: {:?}\n{tail}", fleet.time(), fleet.counts);
            assert!(done, "not finished: {context}");
            for (count, expected) in [
                ("collisions.vertex", 0),
                ("collisions.swap", 0),
                ("stranded", 0),
                ("luggage.requested", self.luggage as i64),
                ("luggage.delivered", self.luggage as i64),
            ] {
                assert_eq!(fleet.count(count), expected, "{count}: {context}");
            }
        }
    }

    fn fleet(&self, seed: u64) -> Fleet {
        let mut chance = Chance::for_component(seed, "setting");
        let map = self.map(&mut chance);
        let free: Vec<(usize, usize)> = map
            .lines()
            .enumerate()
            .flat_map(|(y, row)| row.match_indices('.').map(move |(x, _)| (x, y)).collect::<Vec<_>>())
            .collect();
        let mut block = || {
            let (x, y) = free[chance.below(free.len() as u64) as usize];
            format!("({x},{y})")
        };
        let mut scenario = String::new();
        for _ in 0..self.luggage {
            let from = block();
            let to = std::iter::repeat_with(&mut block).find(|to| *to != from).unwrap();
            writeln!(scenario, "at 1s luggage {from} to {to}").unwrap();
        }
        let mut fleet = Fleet::new(seed, self.lateness);
        let (zero, fast) = (Duration::ZERO, Duration::from_millis(50));
        let time = format!("{}ms", self.move_time.as_millis());
        let world = fleet.add::<World>("World", fast, zero, &[("map", &map), ("moveTime", &time)], &[]);
        fleet.add::<MasterEnvironment>("MasterEnvironment", fast, zero, &[], &[]);
        fleet.add::<Environment>("Environment", fast, zero, &[("scenario", &scenario)], &[]);
        for (robot, (x, y)) in (1..=self.robots).zip(self.chargers(&free)) {
            let period = Duration::from_millis(chance.range(self.periods.clone()));
            let share = period.as_secs_f64() * 1000.0 / *self.periods.end() as f64;
            let (id, discharge) = (format!("Robot{robot:03}"), (self.discharge * share).to_string());
            let (x, y) = (x.to_string(), y.to_string());
            let properties = [("ID", &*id), ("chargeX", &x), ("chargeY", &y), ("discharge", &discharge)];
            let delay = Duration::from_millis(chance.below(500));
            fleet.add::<Robot>(&id, period, delay, &properties, &[("world", world, "hardware")]);
        }
        fleet.initialize().unwrap();
        fleet
    }

    /// Chargers along the left edge, then in further columns.
    fn chargers(&self, free: &[(usize, usize)]) -> Vec<(usize, usize)> {
        let columns = (self.side / self.robots.div_ceil(self.side)).clamp(1, 3) as usize;
        let mut chargers: Vec<_> = free.iter().copied().filter(|(x, _)| x % columns == 0).collect();
        chargers.sort_unstable();
        chargers
    }

    /// Blocked blocks that touch neither each other nor the edge, so that every block can be reached on two ways.
    fn map(&self, chance: &mut Chance) -> String {
        let side = self.side as usize;
        let mut rows = vec![vec!['.'; side]; side];
        for y in 1..side - 1 {
            for x in 1..side - 1 {
                let around = (y - 1..=y + 1).flat_map(|y| (x - 1..=x + 1).map(move |x| (x, y)));
                if around.into_iter().all(|(x, y)| rows[y][x] == '.') && chance.below(100) < self.blocked {
                    rows[y][x] = '@';
                }
            }
        }
        rows.iter().map(|row| row.iter().collect::<String>() + "\n").collect()
    }
}

/// Number of seeds: the usual number, or the value of the variable `SAOMS_SEEDS`, such as 200 in a release build.
fn seeds(usual: u64) -> u64 {
    std::env::var("SAOMS_SEEDS").ok().and_then(|seeds| seeds.parse().ok()).unwrap_or(usual)
}

#[test]
fn ten_robots_bring_a_hundred_pieces() {
    Setting::default().check(seeds(20));
}

#[test]
fn a_few_robots_have_the_area_for_themselves() {
    Setting { robots: 3, luggage: 20, ..Setting::default() }.check(seeds(10));
}

#[test]
fn periods_differ_and_messages_are_late() {
    Setting { periods: 50..=300, lateness: 0.99, ..Setting::default() }.check(seeds(10));
}

#[test]
fn moves_take_several_periods() {
    let move_time = Duration::from_millis(250);
    Setting { move_time, discharge: 0.5, lateness: 0.5, ..Setting::default() }.check(seeds(6));
}

#[test]
fn blocks_are_blocked() {
    Setting { blocked: 30, discharge: 1.0, ..Setting::default() }.check(seeds(10));
}

#[test]
fn the_area_is_crowded() {
    Setting { robots: 40, discharge: 1.0, ..Setting::default() }.check(seeds(4));
}

#[test]
fn hardly_a_block_is_free() {
    Setting { robots: 80, discharge: 0.0, luggage: 40, ..Setting::default() }.check(seeds(2));
}

#[test]
fn the_area_is_large() {
    Setting { side: 32, robots: 40, discharge: 0.7, ..Setting::default() }.check(seeds(2));
}
