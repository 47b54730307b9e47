//! A problem solved by the reference: PIBT and an assignment, step by step, with perfect knowledge.

use std::collections::VecDeque;

use saoms_components::grid::Block;
use saoms_testkit::{Problem, Task};

use crate::Solved;
use crate::assignment::Assignment;
use crate::pibt::{FAR, Occupation, Pibt};

/// Visible work that no robot has begun.
struct Waiting {
    stops: VecDeque<usize>,
    since: u32,
}

/// Solves a problem in this number of steps at most.
pub(crate) fn solve(problem: &Problem, how: (Occupation, Assignment), steps: u32, seed: u64) -> Solved {
    let (occupation, assignment) = how;
    let place = |block: &Block| problem.map.place(*block).unwrap_or(0);
    let starts: Vec<usize> = problem.starts.iter().map(place).collect();
    let robots = starts.len();
    let mut pibt = Pibt::new(&problem.map, starts, occupation, seed);
    let mut own: Vec<VecDeque<usize>> = vec![VecDeque::new(); robots];
    let mut hidden: VecDeque<VecDeque<usize>> = VecDeque::new();
    for task in &problem.tasks {
        match task {
            Task::VisitBy(stop, robot) => own[*robot].push_back(place(stop)),
            _ => hidden.push_back(task.stops().iter().map(place).collect()),
        }
    }
    let total = problem.tasks.len();
    // What each robot has begun.
    let mut doing: Vec<Option<VecDeque<usize>>> = vec![None; robots];
    let mut waiting: VecDeque<Waiting> = VecDeque::new();
    let mut solved = Solved::default();
    let mut planned: Vec<Option<usize>> = vec![None; robots];
    for now in 0..=steps {
        // Whoever is where it has to be goes on at once.
        loop {
            let mut changed = false;
            let open = waiting.len() + doing.iter().filter(|one| one.is_some()).count();
            let room = problem.revealed.map_or(usize::MAX, |most| most.saturating_sub(open));
            let revealed = hidden.len().min(room);
            waiting.extend(hidden.drain(..revealed).map(|stops| Waiting { stops, since: now }));
            for robot in 0..robots {
                if doing[robot].is_none()
                    && let Some(stop) = own[robot].pop_front()
                {
                    doing[robot] = Some(VecDeque::from([stop]));
                }
            }
            assign(&mut pibt, assignment, &doing, &waiting, &mut planned);
            // A robot that is at the first block of its task has begun it.
            let mut begun: Vec<(usize, usize)> = Vec::new();
            for (robot, task) in planned.iter().enumerate() {
                if let Some(task) = task.filter(|task| waiting[*task].stops.front() == Some(&pibt.at[robot])) {
                    begun.push((task, robot));
                }
            }
            begun.sort_unstable();
            for (task, robot) in begun.into_iter().rev() {
                if let Some(one) = waiting.remove(task) {
                    solved.longest_wait = solved.longest_wait.max(now - one.since);
                    doing[robot] = Some(one.stops);
                    changed = true;
                }
            }
            for (robot, one) in doing.iter_mut().enumerate() {
                let Some(stops) = one else { continue };
                while stops.front() == Some(&pibt.at[robot]) {
                    stops.pop_front();
                    changed = true;
                }
                if stops.is_empty() {
                    *one = None;
                    solved.finished += 1;
                    solved.makespan = now;
                }
            }
            if !changed {
                break;
            }
        }
        if solved.finished == total || now == steps {
            break;
        }
        let goals: Vec<Option<usize>> = (0..robots)
            .map(|robot| match &doing[robot] {
                Some(stops) => stops.front().copied(),
                None => planned[robot].and_then(|task| waiting[task].stops.front().copied()),
            })
            .collect();
        pibt.step(&goals);
    }
    for one in &waiting {
        solved.longest_wait = solved.longest_wait.max(steps.saturating_sub(one.since));
    }
    solved
}

/// Plans which free robot goes to which waiting task.
fn assign(
    pibt: &mut Pibt,
    assignment: Assignment,
    doing: &[Option<VecDeque<usize>>],
    waiting: &VecDeque<Waiting>,
    planned: &mut [Option<usize>],
) {
    let free: Vec<usize> = (0..doing.len()).filter(|robot| doing[*robot].is_none()).collect();
    planned.fill(None);
    if free.is_empty() || waiting.is_empty() {
        return;
    }
    let mut costs = vec![Vec::with_capacity(waiting.len()); free.len()];
    for task in waiting {
        let way = task.stops.front().map(|first| pibt.way_to(*first));
        for (row, robot) in costs.iter_mut().zip(&free) {
            row.push(way.as_ref().map_or(FAR, |way| way[pibt.at[*robot]]));
        }
    }
    for (robot, task) in free.iter().zip(assignment.assign(&costs)) {
        planned[*robot] = task;
    }
}
