//! Traps and a maze, in which robots have to get past each other in narrow places: no deadlock is named where they do,
//! and one is named soon where they never will.

use std::time::Duration;

use saoms_components::grid::{Block, Map};
use saoms_testkit::{Fleet, Problem, ProblemFleet, Run, Task};

use super::{corridor, seconds};
use crate::support::root;

const TRAPS: [&str; 4] = ["string", "tree", "tunnel", "corners"];

/// Corridors as wide as a robot, with dead ends and one way around.
const MAZE: &str = "
    .@.....@...
    .@.@@@.@.@.
    ...@...@.@.
    .@@@.@@@.@.
    .........@.
    .@.@@@@@.@.
    .@.@...@.@.
    .@...@.@...
    .@@@@@.@@@.
    ...........
";

/// A fleet whose robots move in each of their executions, or in each fifth one.
fn fleet(problem: &Problem, executions: u32) -> Fleet {
    let step = Duration::from_millis(100) * executions;
    Fleet::of_text(problem.composite(&ProblemFleet { step, executions, ..ProblemFleet::default() }))
}

fn trap(name: &str) -> Problem {
    Problem::read(&root().join(format!("benches/problems/traps/{name}.json"))).unwrap()
}

/// All is done, and no deadlock was named on the way.
fn assert_done(run: &Run, what: &str, tasks: usize, context: &str) {
    assert_eq!(run.sections[what]["open"], 0, "{context}: {}", run.log());
    assert_eq!(
        (run.count("deadlocks"), run.sections[what]["requested"].as_u64()),
        (0, Some(tasks as u64)),
        "{context}"
    );
}

#[test]
fn no_deadlock_is_named_while_robots_exchange_their_places_in_a_trap() {
    for name in TRAPS {
        let problem = trap(name);
        for (executions, seed) in [(1, 0), (1, 1), (5, 0), (5, 1)] {
            let run = fleet(&problem, executions).run(seed, seconds(500));
            assert_done(&run, "errands", problem.tasks.len(), &format!("{name}, {executions}, seed {seed}"));
        }
    }
}

#[test]
fn no_deadlock_is_named_while_robots_bring_luggage_through_traps_and_a_maze() {
    let traps = TRAPS.map(|name| (name, trap(name).map, 2, 10));
    let maze = ("maze", Map::read(MAZE).unwrap(), 6, 30);
    for (name, map, robots, pieces) in traps.into_iter().chain([maze]) {
        for seed in 0..6 {
            let problem = Problem::of_luggage(map.clone(), robots, pieces, seed);
            let run = fleet(&problem, if seed % 2 == 0 { 1 } else { 5 }).run(seed, seconds(2000));
            assert_done(&run, "luggage", pieces, &format!("{name}, seed {seed}"));
        }
    }
}

/// Robots that each go where the next one stands, without a free block among them.
fn ring(map: &str, robots: &[[(i32, i32); 2]]) -> Problem {
    let block = |(x, y): (i32, i32)| Block::new(x, y);
    let starts = robots.iter().map(|[start, _]| block(*start)).collect();
    let tasks = robots.iter().enumerate().map(|(robot, [_, goal])| Task::VisitBy(block(*goal), robot)).collect();
    Problem { map: Map::read(map).unwrap(), starts, tasks, revealed: None }
}

#[test]
fn a_deadlock_in_a_trap_is_named_within_50_periods() {
    let square = [[(0, 0), (1, 0)], [(1, 0), (1, 1)], [(1, 1), (0, 1)], [(0, 1), (0, 0)]];
    // Others get on meanwhile, and are not named.
    let beside = [[(3, 0), (6, 1)], [(6, 1), (3, 0)]];
    let both = [&square[..], &beside[..]].concat();
    for (map, robots) in [("..\n..", &square[..]), ("..@....\n..@....", &both[..])] {
        let problem = ring(map, robots);
        // The tasks come after the first period.
        let time = corridor::named(&fleet(&problem, 1), 30);
        assert!(time <= 0.1 + 5.0, "{map}: {time}");
        let run = fleet(&problem, 1).run(1, seconds(30));
        let named: Vec<String> =
            run.log_of("Zone").into_iter().filter(|line| line.contains("cannot get past")).collect();
        let expected = "robots 1 at (0,0), 2 at (1,0), 3 at (1,1), 4 at (0,1) are in each other's way";
        assert!(matches!(&named[..], [one] if one.contains(expected)), "{map}: {named:?}");
        let done = robots.len() - square.len();
        let finished = run.sections["errands"]["finished"].as_u64().unwrap_or_default();
        assert_eq!(finished, done as u64, "{map}: {}", run.log());
    }
}
