//! Priority inheritance with backtracking (Okumura et al., 2022): the reference for ways through a grid.

use std::collections::HashMap;
use std::rc::Rc;

use saoms_api::Chance;
use saoms_components::grid::Map;

/// Which blocks a moving robot holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Occupation {
    /// Its next block alone, as published: another robot may follow into the block that it leaves.
    Next,
    /// Both blocks until it has arrived, as in our World: nobody enters a block that was held before the step.
    Both,
}

/// Number that counts as no way.
pub(crate) const FAR: u32 = u32::MAX / 4;

/// Priority that a robot gains in each step in a dead end, beside the usual one.
const DEAD_END: f64 = 10.0;

/// Robots on a map, by the places of their blocks.
pub(crate) struct Pibt {
    neighbours: Vec<Vec<usize>>,
    dead_end: Vec<bool>,
    ways: HashMap<usize, Rc<Vec<u32>>>,
    occupation: Occupation,
    pub(crate) at: Vec<usize>,
    priority: Vec<f64>,
    /// The robot that stands at each place.
    here: Vec<Option<usize>>,
    /// The robot that each place is promised to.
    promised: Vec<Option<usize>>,
    next: Vec<Option<usize>>,
    /// True for a robot that stays for this step, to enter a place that another one leaves.
    follows: Vec<bool>,
    chance: Chance,
}

impl Pibt {
    pub(crate) fn new(map: &Map, starts: Vec<usize>, occupation: Occupation, seed: u64) -> Self {
        let neighbours: Vec<Vec<usize>> = (0..map.size()).map(|place| neighbours(map, place)).collect();
        let mut here = vec![None; map.size()];
        starts.iter().enumerate().for_each(|(robot, place)| here[*place] = Some(robot));
        let count = starts.len();
        let tie = |robot: usize| (count - robot) as f64 / (count + 1) as f64;
        Self {
            dead_end: dead_ends(&neighbours),
            neighbours,
            ways: HashMap::new(),
            occupation,
            priority: (0..count).map(tie).collect(),
            at: starts,
            promised: vec![None; map.size()],
            here,
            next: vec![None; count],
            follows: vec![false; count],
            chance: Chance::new(seed),
        }
    }

    /// The distances of all places to this one.
    pub(crate) fn way_to(&mut self, goal: usize) -> Rc<Vec<u32>> {
        let neighbours = &self.neighbours;
        let found = self.ways.entry(goal).or_insert_with(|| {
            let mut distances = vec![FAR; neighbours.len()];
            distances[goal] = 0;
            let mut queue = std::collections::VecDeque::from([goal]);
            while let Some(place) = queue.pop_front() {
                for next in &neighbours[place] {
                    if distances[*next] == FAR {
                        distances[*next] = distances[place] + 1;
                        queue.push_back(*next);
                    }
                }
            }
            Rc::new(distances)
        });
        Rc::clone(found)
    }

    /// Moves all robots by one step; a robot without a goal stays where nobody needs its block.
    pub(crate) fn step(&mut self, goals: &[Option<usize>]) {
        for (robot, goal) in goals.iter().enumerate() {
            let tie = self.priority[robot].fract();
            self.priority[robot] = match goal {
                Some(goal) if *goal != self.at[robot] => {
                    let more = if self.dead_end[self.at[robot]] { DEAD_END } else { 0.0 };
                    self.priority[robot] + 1.0 + more
                }
                _ => tie,
            };
        }
        let mut order: Vec<usize> = (0..goals.len()).collect();
        order.sort_by(|one, other| self.priority[*other].total_cmp(&self.priority[*one]));
        for robot in order {
            if self.next[robot].is_none() {
                self.plan(robot, None, goals);
            }
        }
        self.follows.fill(false);
        for robot in 0..goals.len() {
            self.here[self.at[robot]] = None;
        }
        for robot in 0..goals.len() {
            self.at[robot] = self.next[robot].take().unwrap_or(self.at[robot]);
            self.here[self.at[robot]] = Some(robot);
            self.promised[self.at[robot]] = None;
        }
    }

    /// Finds the next place of a robot; `false` if it stays for good, so that who wants its place looks for another.
    fn plan(&mut self, robot: usize, parent: Option<usize>, goals: &[Option<usize>]) -> bool {
        let own = self.at[robot];
        let way = goals[robot].map(|goal| self.way_to(goal));
        let mut places = self.neighbours[own].clone();
        places.push(own);
        self.chance.shuffle(&mut places);
        // Without a goal it is best where it is.
        places.sort_by_key(|place| way.as_ref().map_or(u32::from(*place != own), |way| way[*place]));
        for place in places {
            if self.promised[place].is_some() || parent.is_some_and(|parent| self.at[parent] == place) {
                continue;
            }
            if place == own && parent.is_some() {
                // It is to leave, if it can.
                continue;
            }
            let other = self.here[place].filter(|other| *other != robot);
            match (other, self.occupation) {
                (None, _) => {
                    self.go(robot, place);
                    return place != own;
                }
                (Some(other), Occupation::Next) => {
                    if self.next[other] == Some(own) {
                        continue;
                    }
                    self.go(robot, place);
                    if self.next[other].is_some() || self.plan(other, Some(robot), goals) {
                        return true;
                    }
                }
                (Some(other), Occupation::Both) => {
                    let leaves = match self.next[other] {
                        Some(next) => next != place || self.follows[other],
                        None => {
                            // Meanwhile it stays.
                            self.next[robot] = Some(own);
                            self.plan(other, Some(robot), goals)
                        }
                    };
                    if leaves {
                        // It enters the place in the next step.
                        self.go(robot, own);
                        self.follows[robot] = true;
                        return true;
                    }
                    self.next[robot] = None;
                }
            }
        }
        self.go(robot, own);
        false
    }

    fn go(&mut self, robot: usize, place: usize) {
        self.next[robot] = Some(place);
        self.promised[place] = Some(robot);
    }
}

fn neighbours(map: &Map, place: usize) -> Vec<usize> {
    let block = map.block(place);
    if !map.is_free(block) {
        return Vec::new();
    }
    let beside =
        [(1, 0), (-1, 0), (0, 1), (0, -1)].map(|(x, y)| saoms_components::grid::Block::new(block.x + x, block.y + y));
    beside.into_iter().filter(|next| map.is_free(*next)).filter_map(|next| map.place(next)).collect()
}

/// The places from which one leaves only through the same place.
fn dead_ends(neighbours: &[Vec<usize>]) -> Vec<bool> {
    let mut ways: Vec<usize> = neighbours.iter().map(Vec::len).collect();
    let mut dead = vec![false; neighbours.len()];
    let mut open: Vec<usize> = (0..ways.len()).filter(|place| ways[*place] == 1).collect();
    while let Some(place) = open.pop() {
        dead[place] = true;
        for next in neighbours[place].iter().filter(|next| !dead[**next]) {
            ways[*next] -= 1;
            if ways[*next] == 1 {
                open.push(*next);
            }
        }
    }
    dead
}
