//! Robots and their ways: invariants 1, 2, 3, 5 and 6.

use std::collections::BTreeMap;

use saoms_api::Time;
use saoms_api::host::{FIRST_ELSEWHERE, SharedMessage};

use super::floor::Floor;
use super::strain::{Outages, Supply};
use super::tide::Tide;
use super::{BATTERY, Finder, MOVES, NO_DEADLOCK, NO_SWAP, ONE_IN_A_BLOCK, bound};
use crate::grid::{Block, Map};
use crate::hardware::Area;
use crate::messages::{
    Collision, CriticalSituation, CriticalStage, EventLuggage, Fault, FaultKind, LuggageStage, Position, Removal,
    RobotList, job_name,
};

/// The robots of a site.
#[derive(Debug, Default)]
pub(super) struct Robots {
    map: Option<Map>,
    all: BTreeMap<u32, Robot>,
    outages: Outages,
    /// Who holds which blocks, where no world tells of collisions.
    floor: Floor,
}

#[derive(Debug, Default)]
struct Robot {
    /// When it was heard of first.
    heard: Option<Time>,
    block: Option<Block>,
    moved: Time,
    /// In microseconds.
    period: u64,
    job: Option<(u32, Time)>,
    /// When its battery gained last: it stands at a charger.
    charged: Time,
    /// True if it said last that it works.
    is_active: bool,
    /// True if it is out of service, so that nothing is expected of it.
    is_out: bool,
    /// When somebody took it off the floor, until it begins anew: it may hear of that late.
    gone: Option<Time>,
    /// When it began, as it said last.
    began: Option<Time>,
    is_empty: bool,
    supply: Supply,
    stands_still: bool,
}

impl Robot {
    /// True if it began after it was gone.
    fn is_since(&self, gone: Time) -> bool {
        self.began.is_none_or(|began| began > gone)
    }
}

/// What the world says of collisions.
pub(super) fn hear_collision(message: &SharedMessage, finder: &mut Finder<'_>) {
    let Some(collision) = message.get::<Collision>() else { return };
    finder.note(if collision.swap { NO_SWAP } else { ONE_IN_A_BLOCK }, collision.to_string());
}

impl Robots {
    pub(super) fn hear_area(&mut self, message: &SharedMessage) {
        if let Some(area) = message.get::<Area>() {
            self.map = area.clone().into();
        }
    }

    /// The seconds from the first word of each robot to the end of the run, all in all.
    pub(super) fn seconds(&self, end: Time) -> f64 {
        let heard = self.all.values().filter_map(|robot| robot.heard);
        heard.map(|heard| end.since(heard).as_secs_f64()).sum()
    }

    /// The longest period of a robot, in microseconds.
    pub(super) fn longest_period(&self) -> u64 {
        self.all.values().map(|robot| robot.period).max().unwrap_or_default()
    }

    /// The position of a robot. Without a world it also says who holds its blocks, unless it may be late, as one of
    /// another program.
    pub(super) fn hear_position(&mut self, message: &SharedMessage, has_world: bool, finder: &mut Finder<'_>) {
        let Some(Position { robot: number, block, next, .. }) = message.get::<Position>().cloned() else { return };
        let robot = self.all.entry(number).or_default();
        if robot.gone.is_some() {
            return;
        }
        if !has_world && message.header().sender < FIRST_ELSEWHERE {
            self.floor.hear(number, block, next, finder);
        }
        let before = robot.block.replace(block);
        if before != Some(block) {
            (robot.moved, robot.stands_still) = (finder.at, false);
            robot.supply.note_move();
        }
        let is_blocked = |block: Block| self.map.as_ref().is_some_and(|map| !map.is_free(block));
        if let Some(before) = before.filter(|before| before.distance(block) > 1) {
            finder.note(MOVES, format!("robot {number} was at {before}, and is at {block}"));
        } else if block.distance(next) > 1 {
            finder.note(MOVES, format!("robot {number} is at {block}, and moves to {next}"));
        } else if let Some(wrong) = [block, next].into_iter().find(|block| is_blocked(*block)) {
            finder.note(MOVES, format!("robot {number} is at {block}, and moves to {next}: {wrong} is not free"));
        }
    }

    /// The state of a robot, which faults may keep from its grants.
    pub(super) fn hear_state(&mut self, message: &SharedMessage, is_kept: bool, finder: &mut Finder<'_>) {
        let Some(state) = message.get::<RobotList>() else { return };
        let robot = self.all.entry(state.robot).or_default();
        robot.heard.get_or_insert(finder.at);
        robot.period = state.period;
        robot.began = state.began;
        robot.gone = robot.gone.filter(|gone| !robot.is_since(*gone));
        if state.active && robot.gone.is_none() {
            robot.is_out = false;
        }
        if robot.supply.hear(state, (finder.at, robot.moved), is_kept, &self.outages) {
            (robot.charged, robot.stands_still) = (finder.at, false);
        }
        // One whose battery is empty may say in the same breath that it works no more.
        let was_active = std::mem::replace(&mut robot.is_active, state.active);
        let is_empty = (state.active || was_active) && state.is_out_of_battery();
        let is_excused = || robot.supply.is_excused(robot.block.unwrap_or(state.block).distance(state.charger));
        if is_empty && !robot.is_empty && !is_excused() {
            finder.note(BATTERY, format!("the battery of robot {} is empty, and it is not at a charger", state.robot));
        }
        robot.is_empty = is_empty;
    }

    /// The battery of a robot.
    pub(super) fn supply(&mut self, robot: u32) -> &mut Supply {
        &mut self.all.entry(robot).or_default().supply
    }

    /// The chargers that give nothing.
    pub(super) fn outages(&mut self) -> &mut Outages {
        &mut self.outages
    }

    pub(super) fn hear_luggage(&mut self, message: &SharedMessage, at: Time) {
        let Some(EventLuggage { robot, luggage, stage, .. }) = message.get::<EventLuggage>().cloned() else { return };
        let Some(robot) = self.all.get_mut(&robot) else { return };
        match stage {
            LuggageStage::Taken => (robot.job, robot.stands_still) = (Some((luggage, at)), false),
            LuggageStage::Release | LuggageStage::Delivered | LuggageStage::Refused | LuggageStage::GivenUp
                if robot.job.is_some_and(|(own, _)| own == luggage) =>
            {
                robot.job = None;
            }
            _ => {}
        }
    }

    pub(super) fn hear_fault(&mut self, message: &SharedMessage) {
        if let Some(fault) = message.get::<Fault>() {
            let since = fault.since.unwrap_or(message.header().sent);
            let robot = self.all.get_mut(&fault.robot).filter(|_| fault.kind == FaultKind::Gone);
            if let Some(robot) = robot.filter(|robot| !robot.is_since(since)) {
                robot.gone = Some(since);
            }
            let starts_elsewhere = fault.kind == FaultKind::Gone || fault.is_failure() && fault.block.is_none();
            self.put_out(fault.robot, starts_elsewhere);
        }
    }

    /// The world says what a robot left that is out.
    pub(super) fn hear_removal(&mut self, message: &SharedMessage) {
        let Some(Removal { robot, kind: Some(_), since, .. }) = message.get::<Removal>() else { return };
        if self.all.get(robot).is_some_and(|robot| !robot.is_since(*since)) {
            self.put_out(*robot, false);
        }
    }

    pub(super) fn hear_critical(&mut self, message: &SharedMessage) {
        let Some(said) = message.get::<CriticalSituation>() else { return };
        if said.stage == CriticalStage::Request && said.healer == 0 {
            self.put_out(said.critical, false);
        }
    }

    fn put_out(&mut self, number: u32, is_gone: bool) {
        let Some(robot) = self.all.get_mut(&number) else { return };
        (robot.is_out, robot.job) = (true, None);
        if is_gone {
            // Where it comes back it is put down.
            robot.block = None;
            self.floor.leave(number);
        }
    }

    /// Looks for robots that stand still although they have a job.
    pub(super) fn look(&mut self, tide: &Tide, finder: &mut Finder<'_>) {
        // Who waits beside a robot that charges goes on once that is charged.
        let charged: Vec<(Block, Time)> =
            self.all.values().filter_map(|robot| Some((robot.block?, robot.charged))).collect();
        let charged_beside = |block: Option<Block>| {
            let beside = charged.iter().filter(|(other, _)| block.is_some_and(|block| block.distance(*other) <= 1));
            beside.map(|(_, at)| *at).max().unwrap_or_default()
        };
        for (number, robot) in &mut self.all {
            let Some((luggage, since)) = robot.job.filter(|_| !robot.is_out && !robot.stands_still) else { continue };
            let stood = tide.calm(since.max(robot.moved).max(charged_beside(robot.block)), finder.at);
            if let Some(time) = stood.filter(|time| tide.is_too_long(*time, bound(robot.period))) {
                robot.stands_still = true;
                let block = robot.block.map(|block| format!(" at {block}")).unwrap_or_default();
                let time = time.as_secs();
                let what = job_name(luggage);
                finder.note(NO_DEADLOCK, format!("robot {number} has stood{block} for {time} s with {what}"));
            }
        }
    }
}
