//! The methods by which luggage is assigned.

use std::time::Duration;

use saoms_api::Time;

use super::knowledge::MasterEnvironmentKnowledge;
use super::matching::{NEVER, each_takes_closest, each_to_closest, least_total};
use super::records::{Order, Unassigned};
use super::ways::Ways;
use super::{Candidate, Task};
use crate::master::open_luggage::WaitingPiece;

/// Number of periods of the slowest robot for which robots decide among themselves who takes new luggage.
const DECLARED: u32 = 5;

/// Radius of the first circle in which a robot is looked for, in blocks.
const CIRCLE: u32 = 32;

/// Greatest number of pieces that are looked at in one execution.
const LOOKED_AT: usize = 1024;

/// Greatest number of robots, and of pieces for each of them, that are matched at the least total way.
const MATCHED: usize = 128;

/// Number of moves in whose time luggage becomes urgent: half of the time for which luggage may wait at most.
const PATIENCE: u32 = 200;

/// Number of blocks that another piece has to save before a robot leaves the one that is assigned to it.
const WORTH: i64 = 6;

/// The same where that other piece has to be taken back from another robot first.
const EXCHANGE: i64 = 6;

/// What counts as the number of blocks where no way leads: such a robot is asked last, and refuses the luggage, so that
/// others hear that it cannot bring it.
const NO_WAY: u32 = 1 << 20;

/// What a moment of waiting counts for urgent luggage, in blocks for each move.
const URGENCY: i64 = 100;

/// Number of parts of a block in which costs are counted.
const PARTS: i64 = 4;

/// What a block between origin and destination counts for a piece, in parts of a block: long ones go first, so that the
/// last ones are short.
const LENGTH: i64 = 1;

impl MasterEnvironmentKnowledge {
    /// What waits, and who is free.
    pub(super) fn unassigned(&self, now: Time) -> Unassigned {
        let count = |number: usize| u32::try_from(number).unwrap_or(u32::MAX);
        Unassigned { pieces: count(self.open.waiting().count()), robots: count(self.crew.free(now).count()) }
    }

    fn candidates(&self, now: Time) -> Vec<Candidate> {
        let mut robots: Vec<Candidate> = self.crew.free(now).map(Candidate::of).collect();
        let mut asleep = self.crew.asleep(now).map(Candidate::of).peekable();
        if asleep.peek().is_some()
            && self.open.waiting().take(LOOKED_AT).any(|piece| self.is_for_asleep(piece.job.luggage))
        {
            robots.extend(asleep);
        }
        robots
    }

    /// True if nobody who is awake is going to bring the luggage.
    fn is_for_asleep(&self, luggage: u32) -> bool {
        self.crew.awake().all(|member| self.open.is_refused(luggage, member.robot))
    }

    fn order(&self, robot: u32, luggage: u32, withdrawn: bool) -> Option<Order> {
        let WaitingPiece { job, .. } = self.open.job(luggage)?;
        Some(Order { robot, luggage, from: job.from, to: job.to, withdrawn })
    }

    fn may(&self, robot: &Candidate, luggage: u32) -> bool {
        !self.open.is_refused(luggage, robot.robot) && (!robot.asleep || self.is_for_asleep(luggage))
    }

    fn orders(&self, robots: &[Candidate], tasks: &[Task], pairs: Vec<(usize, usize)>) -> Vec<Order> {
        let order = |(robot, task): (usize, usize)| self.order(robots[robot].robot, tasks[task].luggage, false);
        pairs.into_iter().filter_map(order).collect()
    }
}

fn task(piece: WaitingPiece, reach: u32) -> Task {
    Task { luggage: piece.job.luggage, from: piece.job.from, reach }
}

/// Luggage that robots did not take by themselves, to the closest robots within growing circles.
pub(super) fn far(knowledge: &MasterEnvironmentKnowledge, now: Time) -> Vec<Order> {
    if !knowledge.is_large() || knowledge.open.is_nothing_waiting() {
        return Vec::new();
    }
    let declared = knowledge.crew.slowest().saturating_mul(DECLARED).max(Duration::from_nanos(1));
    let old = |piece: &WaitingPiece| now.since(piece.since) >= declared;
    let waiting = knowledge.open.waiting().take_while(old).filter(|piece| !knowledge.is_discussed(piece, now));
    let tasks = waiting.take(LOOKED_AT).map(|piece| {
        let times = now.since(piece.since).as_nanos() / declared.as_nanos();
        let doubled = CIRCLE.checked_shl(times.checked_ilog2().unwrap_or(0)).unwrap_or(u32::MAX);
        task(piece, doubled.max(CIRCLE))
    });
    let tasks: Vec<Task> = tasks.collect();
    if tasks.is_empty() {
        return Vec::new();
    }
    let robots = knowledge.candidates(now);
    let pairs = each_to_closest(&tasks, &robots, |robot, task| knowledge.may(robot, task.luggage));
    knowledge.orders(&robots, &tasks, pairs)
}

/// Visits for single robots, where these do not hear of them; the robots are busy then.
fn visits(knowledge: &MasterEnvironmentKnowledge, robots: &mut Vec<Candidate>) -> Vec<Order> {
    if !knowledge.is_large() {
        return Vec::new();
    }
    let own = knowledge.open.waiting().filter(|piece| piece.only.is_some()).take(LOOKED_AT);
    let tasks: Vec<Task> = own.map(|piece| task(piece, u32::MAX)).collect();
    let pairs = each_to_closest(&tasks, robots, |robot, task| knowledge.may(robot, task.luggage));
    let orders = knowledge.orders(robots, &tasks, pairs);
    robots.retain(|robot| orders.iter().all(|order| order.robot != robot.robot));
    orders
}

/// The oldest luggage first, to the closest robots.
pub(super) fn oldest(knowledge: &MasterEnvironmentKnowledge, now: Time) -> Vec<Order> {
    if knowledge.open.is_nothing_waiting() {
        return Vec::new();
    }
    let mut robots = knowledge.candidates(now);
    let mut orders = visits(knowledge, &mut robots);
    let waiting = knowledge.open.waiting().filter(|piece| piece.only.is_none()).take(LOOKED_AT);
    let tasks: Vec<Task> = waiting.map(|piece| task(piece, u32::MAX)).collect();
    if robots.len() > MATCHED {
        let pairs = each_to_closest(&tasks, &robots, |robot, task| knowledge.may(robot, task.luggage));
        orders.extend(knowledge.orders(&robots, &tasks, pairs));
        return orders;
    }
    let mut ways = Ways::on(knowledge.filter.area());
    let mut free = robots;
    for task in tasks.iter().filter(|_| !free.is_empty()).collect::<Vec<_>>() {
        let able = free.iter().enumerate().filter(|(_, robot)| knowledge.may(robot, task.luggage));
        let way = able.map(|(place, robot)| (ways.between(robot.block, task.from).unwrap_or(NO_WAY), place));
        let Some((_, place)) = way.min() else { continue };
        orders.extend(knowledge.order(free.remove(place).robot, task.luggage, false));
        if free.is_empty() {
            break;
        }
    }
    orders
}

/// The least total way to the luggage, where robots may change it until they collect it.
pub(super) fn optimal(knowledge: &MasterEnvironmentKnowledge, now: Time) -> Vec<Order> {
    let mut robots = knowledge.candidates(now);
    let mut orders = visits(knowledge, &mut robots);
    let mut pieces: Vec<WaitingPiece> = knowledge.open.waiting().filter(|piece| piece.only.is_none()).collect();
    let on_the_way = knowledge.on_the_way(now);
    if robots.len() + on_the_way.len() > MATCHED {
        orders.extend(many(knowledge, robots, pieces, now));
        return orders;
    }
    if pieces.is_empty() && robots.is_empty() {
        return orders;
    }
    let free = robots.len();
    let first_taken = pieces.len();
    for (robot, piece) in on_the_way {
        robots.push(robot);
        pieces.push(piece);
    }
    let mut ways = Ways::on(knowledge.filter.area());
    let step = knowledge.crew.step().as_nanos().max(1);
    let urgency = |piece: &WaitingPiece| {
        let waited = i64::try_from(now.since(piece.since).as_nanos() / step).unwrap_or(i64::MAX);
        (waited - i64::from(PATIENCE)).clamp(0, 1_000_000) * URGENCY
    };
    let own = |row: usize| row.checked_sub(free).map(|place| first_taken + place);
    // What is to be preferred to other pieces, in parts of a block.
    let ahead = |piece: &WaitingPiece| {
        let length = i64::from(piece.job.from.distance(piece.job.to));
        urgency(piece).saturating_mul(PARTS) + length * LENGTH
    };
    let mut costs: Vec<Vec<i64>> = Vec::new();
    for (row, robot) in robots.iter().enumerate() {
        let cost = |(column, piece): (usize, &WaitingPiece)| {
            if !knowledge.may(robot, piece.job.luggage) {
                return NEVER;
            }
            let way = ways.between(robot.block, piece.job.from).unwrap_or(NO_WAY);
            let change = match own(row) {
                Some(own) if own == column => -WORTH,
                _ if column >= first_taken => EXCHANGE,
                _ => 0,
            };
            (i64::from(way) + change) * PARTS - ahead(piece)
        };
        costs.push(pieces.iter().enumerate().map(cost).collect());
    }
    // Those that still carry luggage compete for what they are going to be close to, but for urgent pieces: one that is
    // stuck would keep them from all others.
    for (robot, job) in knowledge.carrying() {
        let Some(rest) = ways.between(robot.block, job.to) else { continue };
        let cost = |(column, piece): (usize, &WaitingPiece)| {
            let is_kept = column >= first_taken || urgency(piece) > 0;
            if is_kept || !knowledge.may(&robot, piece.job.luggage) {
                return NEVER;
            }
            let Some(way) = ways.between(job.to, piece.job.from) else { return NEVER };
            (i64::from(rest) + i64::from(way) + 1) * PARTS - ahead(piece)
        };
        costs.push(pieces.iter().enumerate().map(cost).collect());
    }
    for (row, column) in least_total(&costs).into_iter().enumerate().take(robots.len()) {
        match (own(row), column) {
            // It takes that, and leaves its own.
            (_, Some(column)) if column < first_taken => {
                orders.extend(knowledge.order(robots[row].robot, pieces[column].job.luggage, false));
            }
            // Its own goes to another robot once this one has handed it back.
            (Some(own), column) if column != Some(own) => {
                orders.extend(knowledge.order(robots[row].robot, pieces[own].job.luggage, true));
            }
            _ => {}
        }
    }
    orders
}

/// The same for many robots, where the closest is close enough to the best.
fn many(
    knowledge: &MasterEnvironmentKnowledge,
    robots: Vec<Candidate>,
    pieces: Vec<WaitingPiece>,
    now: Time,
) -> Vec<Order> {
    let patience = knowledge.crew.step().saturating_mul(PATIENCE);
    let urgent = pieces.partition_point(|piece| now.since(piece.since) >= patience);
    let tasks: Vec<Task> = pieces.into_iter().map(|piece| task(piece, u32::MAX)).collect();
    let may = |robot: &Candidate, task: &Task| knowledge.may(robot, task.luggage);
    let (urgent, others) = tasks.split_at(urgent);
    let first = each_to_closest(urgent, &robots, may);
    let taken: std::collections::HashSet<usize> = first.iter().map(|(robot, _)| *robot).collect();
    let mut orders = knowledge.orders(&robots, urgent, first);
    let rest = robots.iter().enumerate().filter(|(place, _)| !taken.contains(place)).map(|(_, robot)| *robot);
    let rest: Vec<Candidate> = rest.collect();
    let pairs = match rest.len() < others.len() {
        true => each_takes_closest(others, &rest, may),
        false => each_to_closest(others, &rest, may),
    };
    orders.extend(knowledge.orders(&rest, others, pairs));
    orders
}
