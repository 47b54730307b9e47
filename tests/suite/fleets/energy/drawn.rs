//! Random sites with narrow maps and batteries that suffice on paper: no robot is stranded.

use std::time::Duration;

use saoms_api::Chance;
use saoms_components::grid::{Block, Map};
use saoms_testkit::Problem;

use super::crowded::{RobotOfSite, Site};

/// Free neighbours of a block from which on robots get past each other.
const WAYS_AROUND: f64 = 2.5;

/// A site that is drawn by its number alone.
struct Drawn {
    map: String,
    /// Mean number of free neighbours of a free block: less than 2 where there is no way around.
    neighbours: f64,
    times: (u32, u32),
    battery: (f64, f64, f64),
    has_zone: bool,
    assignment: &'static str,
    robots: Vec<RobotOfSite>,
    pieces: u32,
}

impl Drawn {
    fn of(number: u64) -> Drawn {
        let mut chance = Chance::for_component(number, "site");
        let map = narrow_map(&mut chance);
        let free: Vec<Block> = (0..map.size()).map(|place| map.block(place)).filter(|at| map.is_free(*at)).collect();
        let beside = |at: &Block| at.neighbours().into_iter().filter(|other| map.is_free(*other)).count();
        let neighbours = free.iter().map(beside).sum::<usize>() as f64 / free.len() as f64;
        let each = 5.2 + chance.unit() * 10.8;
        let robots = ((free.len() as f64 / each) as usize).max(2);
        let starts = Problem::of_luggage(map.clone(), robots, 0, number).starts;
        let robots = starts.iter().map(|at| ((at.x, at.y), (at.x, at.y), 100.0)).collect();
        let times = *chance.pick(&[(0, 0), (200, 0), (200, 500), (500, 0), (300, 300)]).unwrap();
        let seconds = f64::from(times.0.max(100)) / 1000.0;
        // A full battery lasts for so many moves without a pause.
        let moves = 42.0 + chance.unit() * 110.0;
        let by_block = *chance.pick(&[0.0, 0.5, 0.9]).unwrap();
        let of_second = 100.0 / moves * (1.0 - by_block) / seconds;
        let charge = 100.0 / moves / seconds * (4.0 + chance.unit() * 12.0);
        let round = |value: f64| (value * 1000.0).round() / 1000.0;
        Drawn {
            map: rows(&map),
            neighbours,
            times,
            battery: (round(100.0 / moves * by_block), round(of_second), round(charge)),
            has_zone: chance.chance(0.5),
            assignment: chance.pick(&["robots", "oldest", "optimal"]).unwrap(),
            robots,
            pieces: chance.range(30..=120),
        }
    }

    fn with<T>(&self, use_site: impl FnOnce(&Site<'_>) -> T) -> T {
        let Drawn { times, battery, has_zone, assignment, .. } = *self;
        let scenario = format!("from 1s every 500ms {} times luggage random to random", self.pieces);
        let (map, robots) = (self.map.as_str(), self.robots.as_slice());
        use_site(&Site { map, times, battery, has_zone, border: None, assignment, robots, scenario: &scenario })
    }
}

/// A connected map with passages of one block here and there, or everywhere.
fn narrow_map(chance: &mut Chance) -> Map {
    let (width, height) = (chance.range(6..=16_u32), chance.range(6..=16_u32));
    let part = 0.45 + 0.4 * chance.unit();
    // How often a block is opened beside two free ones: the less often, the more of the map are passages.
    let open = [0.01, 0.05, 0.2, 0.6][chance.below(4) as usize];
    let count = (f64::from(width * height) * part) as usize;
    let block = |chance: &mut Chance| {
        let x = chance.range(0..width.cast_signed());
        Block::new(x, chance.range(0..height.cast_signed()))
    };
    let mut free = vec![block(chance)];
    for _ in 0..100_000 {
        if free.len() >= count {
            break;
        }
        let next = block(chance);
        let beside = next.neighbours().into_iter().filter(|other| free.contains(other)).count();
        let opens = beside == 1 || beside > 1 && chance.chance(open);
        if !free.contains(&next) && opens {
            free.push(next);
        }
    }
    let mut map = Map::new(width, height);
    let all: Vec<Block> = (0..map.size()).map(|place| map.block(place)).collect();
    all.into_iter().filter(|at| !free.contains(at)).for_each(|at| _ = map.set_blocked(at));
    map
}

fn rows(map: &Map) -> String {
    let sign = |place: usize| if map.is_free(map.block(place)) { '.' } else { '@' };
    let width = map.width() as usize;
    let rows = (0..map.height() as usize).map(|row| (row * width..(row + 1) * width).map(sign).collect::<String>());
    rows.collect::<Vec<_>>().join("\n")
}

/// Nobody is stranded in these runs of the site.
#[track_caller]
fn expect_none_stranded(number: u64, drawn: &Drawn, seeds: std::ops::Range<u64>) {
    for seed in seeds {
        let run = drawn.with(|site| site.run_for(seed, Duration::from_secs(1200)));
        assert_eq!(run.sections["stranded"], 0, "site {number}, seed {seed}:\n{}\n{}", drawn.map, run.log());
    }
}

#[test]
fn robots_that_leave_a_block_to_one_that_comes_out_do_not_take_it_back_before() {
    // On each of these sites a robot took turns with another one before a bay until its battery was empty.
    for number in [316, 715, 937] {
        expect_none_stranded(number, &Drawn::of(number), 0..2);
    }
}

#[test]
fn random_sites_with_narrow_maps_and_ways_around_strand_nobody() {
    let sites = std::env::var("SAOMS_SEEDS").ok().and_then(|seeds| seeds.parse().ok()).unwrap_or(12);
    let drawn = (0..).map(|number| (number, Drawn::of(number))).filter(|(_, drawn)| drawn.neighbours >= WAYS_AROUND);
    let told_nothing = drawn.filter(|(_, drawn)| drawn.with(|site| site.diagnostics().is_empty()));
    told_nothing.take(sites).for_each(|(number, drawn)| expect_none_stranded(number, &drawn, 0..1));
}
