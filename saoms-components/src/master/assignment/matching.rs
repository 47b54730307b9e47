//! Which robot brings which luggage: matchings of robots and pieces by the costs of the ways.

use std::collections::HashMap;

use super::crew::Member;
use crate::grid::Block;

/// A robot that can take a job.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Candidate {
    pub(super) robot: u32,
    pub(super) block: Block,
    /// True if it sleeps: it brings only what nobody who is awake is going to bring.
    pub(super) asleep: bool,
}

impl Candidate {
    pub(super) fn of(member: &Member) -> Candidate {
        Candidate { robot: member.robot, block: member.block, asleep: member.asleep }
    }
}

/// Luggage that waits for a robot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Task {
    pub(super) luggage: u32,
    pub(super) from: Block,
    /// Greatest distance from which a robot comes, in blocks.
    pub(super) reach: u32,
}

/// Cost of a pair that cannot be: more than all others together, and little enough for sums over all rows.
pub(super) const NEVER: i64 = 1 << 50;

/// The pairs of least total cost, of rows and columns of a table of costs: for each row its column, as far as there is
/// one that is not [`NEVER`]. This is the Hungarian method (Kuhn 1955) with potentials, in steps of rows x rows x
/// columns, where there are no fewer columns than rows.
pub(super) fn least_total(costs: &[Vec<i64>]) -> Vec<Option<usize>> {
    let (rows, columns) = (costs.len(), costs.first().map_or(0, Vec::len));
    if rows > columns {
        let turned: Vec<Vec<i64>> = (0..columns).map(|column| costs.iter().map(|row| row[column]).collect()).collect();
        let mut found = vec![None; rows];
        for (column, row) in least_total(&turned).into_iter().enumerate() {
            if let Some(row) = row {
                found[row] = Some(column);
            }
        }
        return found;
    }
    // Row and column 0 are none.
    let (mut of_row, mut of_column) = (vec![0_i64; rows + 1], vec![0_i64; columns + 1]);
    let mut row_of = vec![0_usize; columns + 1];
    for row in 1..=rows {
        let (mut column, mut before) = (0, vec![0_usize; columns + 1]);
        let (mut least, mut seen) = (vec![i64::MAX; columns + 1], vec![false; columns + 1]);
        row_of[0] = row;
        while row_of[column] != 0 {
            seen[column] = true;
            let from = row_of[column];
            let (mut step, mut next) = (i64::MAX, 0);
            for other in 1..=columns {
                if seen[other] {
                    continue;
                }
                let cost = costs[from - 1][other - 1] - of_row[from] - of_column[other];
                if cost < least[other] {
                    (least[other], before[other]) = (cost, column);
                }
                if least[other] < step {
                    (step, next) = (least[other], other);
                }
            }
            for other in 0..=columns {
                if seen[other] {
                    of_row[row_of[other]] += step;
                    of_column[other] -= step;
                } else if other > 0 {
                    least[other] -= step;
                }
            }
            column = next;
        }
        while column != 0 {
            row_of[column] = row_of[before[column]];
            column = before[column];
        }
    }
    let mut found = vec![None; rows];
    for column in 1..=columns {
        let row = row_of[column];
        if row > 0 && costs[row - 1][column - 1] < NEVER {
            found[row - 1] = Some(column - 1);
        }
    }
    found
}

/// Number of blocks along a side of a cell of a [`Near`], as a power of two.
const CELL: u32 = 4;

/// Blocks by their cells, so that the closest one is found without a look at all.
#[derive(Debug, Default)]
pub(super) struct Near {
    cells: HashMap<(i32, i32), Vec<usize>>,
    blocks: Vec<Block>,
    /// The cells in use are within these.
    least: (i32, i32),
    most: (i32, i32),
}

impl Near {
    pub(super) fn of(blocks: impl Iterator<Item = Block>) -> Near {
        let mut near = Near { least: (i32::MAX, i32::MAX), most: (i32::MIN, i32::MIN), ..Near::default() };
        for (place, block) in blocks.enumerate() {
            let cell = cell(block);
            near.cells.entry(cell).or_default().push(place);
            near.blocks.push(block);
            near.least = (near.least.0.min(cell.0), near.least.1.min(cell.1));
            near.most = (near.most.0.max(cell.0), near.most.1.max(cell.1));
        }
        near
    }

    /// Takes out a block.
    pub(super) fn remove(&mut self, place: usize) {
        if let Some(places) = self.cells.get_mut(&cell(self.blocks[place])) {
            places.retain(|other| *other != place);
        }
    }

    /// The closest block, at most `reach` away, for which the condition holds; of equally close ones the first.
    pub(super) fn closest(&self, to: Block, reach: u32, is_right: impl Fn(usize) -> bool) -> Option<usize> {
        let middle = cell(to);
        let farthest = [self.least, self.most].map(|(x, y)| middle.0.abs_diff(x).max(middle.1.abs_diff(y)));
        let mut best: Option<(u32, usize)> = None;
        for ring in 0..=farthest.into_iter().max().unwrap_or(0) {
            // No block of this ring is closer.
            let least = (ring.saturating_sub(1)) << CELL;
            if self.blocks.is_empty() || least > reach || best.is_some_and(|(distance, _)| distance < least) {
                break;
            }
            for place in ring_of(middle, ring).filter_map(|cell| self.cells.get(&cell)).flatten() {
                let distance = self.blocks[*place].distance(to);
                let is_better = best.is_none_or(|best| (distance, *place) < best);
                if distance <= reach && is_better && is_right(*place) {
                    best = Some((distance, *place));
                }
            }
        }
        best.map(|(_, place)| place)
    }
}

fn cell(block: Block) -> (i32, i32) {
    (block.x >> CELL, block.y >> CELL)
}

/// The cells at this distance from a cell, of which the greater of rows and columns counts.
fn ring_of((x, y): (i32, i32), ring: u32) -> impl Iterator<Item = (i32, i32)> {
    let ring = i32::try_from(ring).unwrap_or(i32::MAX >> 1);
    let (left, right, top, bottom) = (x - ring, x + ring, y - ring, y + ring);
    let rows = (left..=right).flat_map(move |x| [(x, top), (x, bottom)]);
    let columns = (top + 1..bottom).flat_map(move |y| [(left, y), (right, y)]);
    rows.chain(columns).take(if ring == 0 { 1 } else { usize::MAX })
}

/// Each piece in its order to the closest robot that is still free.
pub(super) fn each_to_closest(
    tasks: &[Task],
    robots: &[Candidate],
    may: impl Fn(&Candidate, &Task) -> bool,
) -> Vec<(usize, usize)> {
    let mut near = Near::of(robots.iter().map(|robot| robot.block));
    let mut pairs = Vec::new();
    for (place, task) in tasks.iter().enumerate() {
        if pairs.len() == robots.len() {
            break;
        }
        if let Some(robot) = near.closest(task.from, task.reach, |robot| may(&robots[robot], task)) {
            near.remove(robot);
            pairs.push((robot, place));
        }
    }
    pairs
}

/// Each robot in its order takes the closest piece that is still there.
pub(super) fn each_takes_closest(
    tasks: &[Task],
    robots: &[Candidate],
    may: impl Fn(&Candidate, &Task) -> bool,
) -> Vec<(usize, usize)> {
    let mut near = Near::of(tasks.iter().map(|task| task.from));
    let mut pairs = Vec::new();
    for (place, robot) in robots.iter().enumerate() {
        let is_right = |task: usize| {
            let task = &tasks[task];
            task.from.distance(robot.block) <= task.reach && may(robot, task)
        };
        if let Some(task) = near.closest(robot.block, u32::MAX, is_right) {
            near.remove(task);
            pairs.push((place, task));
        }
    }
    pairs
}

#[cfg(test)]
mod tests {
    use saoms_api::Chance;

    use super::*;

    /// The least total by trying all.
    fn least(costs: &[Vec<i64>], row: usize, used: &mut Vec<bool>) -> i64 {
        let Some(of_row) = costs.get(row) else { return 0 };
        let mut best = NEVER;
        for column in 0..used.len() {
            if !std::mem::replace(&mut used[column], true) {
                best = best.min(of_row[column] + least(costs, row + 1, used));
                used[column] = false;
            }
        }
        best
    }

    #[test]
    fn no_other_pairs_cost_less() {
        let mut chance = Chance::new(1);
        for round in 0..300 {
            let (rows, columns) = (1 + round % 4, 1 + round % 5);
            let costs: Vec<Vec<i64>> =
                (0..rows).map(|_| (0..columns).map(|_| chance.below(20) as i64 - 5).collect()).collect();
            let found = least_total(&costs);
            let total: i64 =
                found.iter().zip(&costs).filter_map(|(column, row)| column.map(|column| row[column])).sum();
            assert_eq!(found.iter().flatten().count(), rows.min(columns));
            let all = if rows <= columns {
                costs.clone()
            } else {
                (0..columns).map(|column| costs.iter().map(|row| row[column]).collect()).collect()
            };
            assert_eq!(total, least(&all, 0, &mut vec![false; rows.max(columns)]), "{costs:?}");
        }
    }

    #[test]
    fn many_pairs_that_cannot_be_are_none() {
        for rows in [6, 60] {
            let mut costs = vec![vec![NEVER; rows + 4]; rows];
            costs[rows / 2][1] = 3;
            let found = least_total(&costs);
            assert_eq!(found.iter().flatten().collect::<Vec<_>>(), [&1]);
        }
    }

    #[test]
    fn a_pair_that_cannot_be_is_none() {
        assert_eq!(least_total(&[vec![NEVER, NEVER], vec![3, NEVER]]), [None, Some(0)]);
        assert_eq!(least_total(&[]), []);
    }

    #[test]
    fn the_closest_block_is_found_in_any_cell() {
        let mut chance = Chance::new(2);
        for _ in 0..200 {
            let mut block = || Block::new(chance.below(200) as i32, chance.below(200) as i32);
            let blocks: Vec<Block> = (0..12).map(|_| block()).collect();
            let to = block();
            let near = Near::of(blocks.iter().copied());
            for reach in [0, 10, 50, u32::MAX] {
                let expected = (0..blocks.len())
                    .filter(|place| place % 3 != 0 && blocks[*place].distance(to) <= reach)
                    .min_by_key(|place| (blocks[*place].distance(to), *place));
                assert_eq!(near.closest(to, reach, |place| place % 3 != 0), expected);
            }
        }
    }
}
