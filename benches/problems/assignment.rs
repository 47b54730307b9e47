//! Which robot does which of the visible tasks.

use clap::ValueEnum;

/// Rules of assignment.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Assignment {
    /// The oldest task goes to the closest free robot.
    OldestToClosest,
    /// Of all free robots and waiting tasks the closest pair first.
    Nearest,
    /// The least sum of distances, anew in each step until a robot has begun its task.
    Hungarian,
}

impl Assignment {
    /// For each robot the index of its task. `costs[robot][task]` are distances; tasks are the oldest first.
    pub(crate) fn assign(self, costs: &[Vec<u32>]) -> Vec<Option<usize>> {
        match self {
            Assignment::OldestToClosest => oldest_to_closest(costs),
            Assignment::Nearest => nearest(costs),
            Assignment::Hungarian => hungarian(costs),
        }
    }
}

fn oldest_to_closest(costs: &[Vec<u32>]) -> Vec<Option<usize>> {
    let mut given = vec![None; costs.len()];
    for task in 0..costs.first().map_or(0, Vec::len) {
        let free = (0..costs.len()).filter(|robot| given[*robot].is_none());
        let Some(closest) = free.min_by_key(|robot| costs[*robot][task]) else { break };
        given[closest] = Some(task);
    }
    given
}

fn nearest(costs: &[Vec<u32>]) -> Vec<Option<usize>> {
    let mut pairs: Vec<(u32, usize, usize)> = Vec::new();
    for (robot, row) in costs.iter().enumerate() {
        pairs.extend(row.iter().enumerate().map(|(task, cost)| (*cost, task, robot)));
    }
    pairs.sort_unstable();
    let mut given = vec![None; costs.len()];
    let mut taken = vec![false; costs.first().map_or(0, Vec::len)];
    for (_, task, robot) in pairs {
        if given[robot].is_none() && !taken[task] {
            (given[robot], taken[task]) = (Some(task), true);
        }
    }
    given
}

/// Kuhn's method with potentials; rows are the smaller side.
fn hungarian(costs: &[Vec<u32>]) -> Vec<Option<usize>> {
    let (robots, tasks) = (costs.len(), costs.first().map_or(0, Vec::len));
    let turned = robots > tasks;
    let (rows, columns) = if turned { (tasks, robots) } else { (robots, tasks) };
    let cost = |row: usize, column: usize| f64::from(if turned { costs[column][row] } else { costs[row][column] });
    // Index 0 is a row and a column of no robot and no task.
    let (mut of_row, mut of_column) = (vec![0.0; rows + 1], vec![0.0; columns + 1]);
    let mut matched = vec![0; columns + 1];
    for row in 1..=rows {
        matched[0] = row;
        let (mut least, mut used) = (vec![f64::INFINITY; columns + 1], vec![false; columns + 1]);
        let mut way = vec![0; columns + 1];
        let mut column = 0;
        loop {
            used[column] = true;
            let (from, mut delta, mut next) = (matched[column], f64::INFINITY, 0);
            for other in (1..=columns).filter(|other| !used[*other]) {
                let reduced = cost(from - 1, other - 1) - of_row[from] - of_column[other];
                if reduced < least[other] {
                    (least[other], way[other]) = (reduced, column);
                }
                if least[other] < delta {
                    (delta, next) = (least[other], other);
                }
            }
            for other in 0..=columns {
                if used[other] {
                    of_row[matched[other]] += delta;
                    of_column[other] -= delta;
                } else {
                    least[other] -= delta;
                }
            }
            column = next;
            if matched[column] == 0 {
                break;
            }
        }
        while column != 0 {
            let before = way[column];
            matched[column] = matched[before];
            column = before;
        }
    }
    let mut given = vec![None; robots];
    for (column, row) in matched.into_iter().enumerate().skip(1) {
        let Some(row) = row.checked_sub(1) else { continue };
        let (robot, task) = if turned { (column - 1, row) } else { (row, column - 1) };
        given[robot] = Some(task);
    }
    given
}
