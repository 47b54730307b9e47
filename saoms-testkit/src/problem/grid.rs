//! Problems with luggage at random places of a map.

use saoms_api::Chance;
use saoms_components::grid::{Block, Map};

use super::{Problem, Task};

impl Problem {
    /// Robots at different random blocks, and pieces of luggage from and to random blocks, all of them at the start.
    /// All blocks are drawn from the largest connected part of the map, by the seed alone.
    ///
    /// There are at most as many robots as blocks, and no luggage on a map with one block.
    pub fn of_luggage(map: Map, robots: usize, pieces: usize, seed: u64) -> Problem {
        let mut free = largest_part(&map);
        let mut chance = Chance::new(seed);
        let mut starts = Vec::with_capacity(robots);
        for at in 0..robots.min(free.len()) {
            let other = chance.range(at..=free.len() - 1);
            free.swap(at, other);
            starts.push(free[at]);
        }
        let mut draw = |not: Option<Block>| loop {
            let block = free[chance.range(0..=free.len() - 1)];
            if Some(block) != not {
                break block;
            }
        };
        let pieces = if free.len() > 1 { pieces } else { 0 };
        let tasks = (0..pieces).map(|_| {
            let from = draw(None);
            Task::Luggage(from, draw(Some(from)))
        });
        Problem { tasks: tasks.collect(), map, starts, revealed: None }
    }
}

/// The free blocks of the largest connected part of a map, row by row.
fn largest_part(map: &Map) -> Vec<Block> {
    let mut part = vec![0_usize; map.size()];
    let mut sizes = vec![0_usize];
    for place in 0..map.size() {
        if part[place] > 0 || !map.is_free(map.block(place)) {
            continue;
        }
        let number = sizes.len();
        sizes.push(0);
        part[place] = number;
        let mut open = vec![map.block(place)];
        while let Some(block) = open.pop() {
            sizes[number] += 1;
            for (x, y) in [(1, 0), (-1, 0), (0, 1), (0, -1)] {
                let next = Block::new(block.x + x, block.y + y);
                if let Some(place) = map.place(next).filter(|place| map.is_free(next) && part[*place] == 0) {
                    part[place] = number;
                    open.push(next);
                }
            }
        }
    }
    let largest = (1..sizes.len()).max_by_key(|number| sizes[*number]).unwrap_or(0);
    (0..map.size()).filter(|place| largest > 0 && part[*place] == largest).map(|place| map.block(place)).collect()
}
