use std::collections::BTreeMap;
use std::time::Duration;

use saoms_api::{Failure, Field, Time};

use crate::grid::{Block, Map};
use crate::hardware::{Action, Progress};
use crate::messages::Collision;

/// The real positions of the robots, and their collisions.
///
/// A robot holds its block and, while it moves, the block that it moves to. Two robots that hold the same block
/// collide. Two robots that exchange their blocks collide as well, which counts as one collision.
#[derive(Debug)]
pub(super) struct Referee {
    map: Map,
    bodies: BTreeMap<u32, Body>,
    /// Number of robots that hold each block of the map. Empty until the first robot enters, since a world is also
    /// built by checks.
    holders: Vec<u16>,
    /// Robots that currently meet in a block.
    meetings: Vec<Meeting>,
    /// Number of moving robots.
    moving: usize,
}

#[derive(Debug)]
pub(super) struct Body {
    pub(super) name: String,
    pub(super) block: Block,
    /// Target of its move, and the time at which it arrives.
    pub(super) moving: Option<(Block, Time)>,
    /// Action of its gripper, and the time at which it ends.
    pub(super) handling: Option<(Action, Time)>,
    /// True if it is out of service.
    pub(super) retired: bool,
    /// True if somebody took it off the floor: it holds no block.
    pub(super) gone: bool,
    /// Time at which it registered.
    pub(super) entered: Time,
    /// The last action of its gripper that ended, and how.
    pub(super) handled: Option<(Action, Progress)>,
    /// True if it registered again, and has not shown yet whether it knows what it carries.
    pub(super) entered_again: bool,
    /// Period of its component, as it says.
    pub(super) period: Duration,
    /// By what its actions take longer, and until when.
    pub(super) slow: Option<Slowness>,
    /// When its last move was over, and whether it took time.
    pub(super) moved: (Time, bool),
}

/// How slow a robot is.
#[derive(Clone, Copy, Debug, PartialEq, Field)]
pub(super) struct Slowness {
    /// How many times as long its actions take.
    pub(super) factor: f64,
    /// When that ends; `None` is never.
    pub(super) until: Option<Time>,
}

impl Slowness {
    /// The time of an action that begins now: what is left of it when the slowness ends takes its usual time.
    fn lasting(&self, usual: Duration, period: Duration, now: Time) -> Duration {
        let slowed = usual.max(period).as_nanos() as f64 * self.factor;
        let left = self.until.map_or(f64::INFINITY, |until| until.since(now).as_nanos() as f64);
        let nanos = if slowed <= left { slowed } else { left + (1.0 - left / slowed) * usual.as_nanos() as f64 };
        Duration::from_nanos(nanos.round() as u64)
    }
}

/// A robot that entered a block where another one was.
#[derive(Clone, Copy, Debug, PartialEq, Field)]
pub(super) struct Meeting {
    entered: u32,
    from: Block,
    other: u32,
    block: Block,
}

impl Referee {
    pub(super) fn new(map: Map) -> Referee {
        Referee { map, bodies: BTreeMap::new(), holders: Vec::new(), meetings: Vec::new(), moving: 0 }
    }

    /// The same positions as those of an earlier referee.
    pub(super) fn with(map: Map, bodies: impl Iterator<Item = (u32, Body)>, meetings: Vec<Meeting>) -> Referee {
        let mut referee = Referee { bodies: bodies.collect(), meetings, ..Referee::new(map) };
        let on_floor = referee.bodies.values().filter(|body| !body.gone);
        let blocks = on_floor.flat_map(|body| [Some(body.block), body.moving.map(|(to, _)| to)]);
        let held: Vec<Block> = blocks.flatten().collect();
        held.into_iter().for_each(|block| referee.hold(block));
        referee.moving = referee.bodies.values().filter(|body| body.moving.is_some()).count();
        referee
    }

    /// The robots, by number.
    pub(super) fn bodies(&self) -> impl Iterator<Item = (&u32, &Body)> {
        self.bodies.iter()
    }

    /// Robots that meet in a block.
    pub(super) fn meetings(&self) -> &[Meeting] {
        &self.meetings
    }

    pub(super) fn map(&self) -> &Map {
        &self.map
    }

    /// Registers a robot at a block. A robot that was registered before, as before a restart, stays where it was.
    pub(super) fn enter(&mut self, robot: u32, name: String, block: Block, now: Time) -> Result<Block, Failure> {
        if let Some(body) = self.bodies.get(&robot) {
            if body.name != name {
                return Err(Failure::new(format!(
                    "robots `{}` and `{name}` both have the number {robot}: give one of them another `number`",
                    body.name
                )));
            }
            if !body.gone {
                self.cancel(robot)?;
                if let Some(body) = self.bodies.get_mut(&robot) {
                    (body.retired, body.entered_again, body.entered) = (false, true, now);
                }
                return self.block(robot);
            }
        }
        let (x, y) = (self.map.width() - 1, self.map.height() - 1);
        if !self.map.contains(block) {
            return Err(Failure::new(format!(
                "robot {robot} starts at {block}, outside the map from (0,0) to ({x},{y}): give it another charge block"
            )));
        }
        if !self.map.is_free(block) {
            return Err(Failure::new(format!(
                "robot {robot} starts at {block}, which is blocked on the map: give it another charge block"
            )));
        }
        if let Some(other) = self.holder(block, robot) {
            return Err(Failure::new(format!(
                "robot {robot} starts at {block}, where robot {other} is already: give it another charge block"
            )));
        }
        self.hold(block);
        self.bodies.insert(
            robot,
            Body {
                name,
                block,
                moving: None,
                handling: None,
                retired: false,
                gone: false,
                entered: now,
                handled: None,
                entered_again: false,
                period: Duration::ZERO,
                slow: None,
                moved: (Time::START, false),
            },
        );
        Ok(block)
    }

    /// True if a robot stands on the floor.
    pub(super) fn is_on_floor(&self, robot: u32) -> bool {
        self.bodies.get(&robot).is_some_and(|body| !body.gone)
    }

    /// Number of robots in this world.
    pub(super) fn robots(&self) -> usize {
        self.bodies.values().filter(|body| !body.gone).count()
    }

    /// True if no robot is in this world.
    pub(super) fn is_empty(&self) -> bool {
        self.bodies.is_empty()
    }

    /// Notes the period of a robot, as it says.
    pub(super) fn note_period(&mut self, robot: u32, micros: u64) {
        if let Some(body) = self.bodies.get_mut(&robot) {
            body.period = Duration::from_micros(micros);
        }
    }

    /// Makes a robot of this world slow.
    pub(super) fn slow_down(&mut self, robot: u32, slowness: Slowness) {
        if let Some(body) = self.bodies.get_mut(&robot) {
            body.slow = Some(slowness);
        }
    }

    /// The time that an action takes which takes `usual` otherwise: of a slow robot so many times that, and at least so
    /// many of its periods.
    pub(super) fn lasting(&self, robot: u32, usual: Duration, now: Time) -> Duration {
        let Some(body) = self.bodies.get(&robot) else { return usual };
        let Some(slow) = body.slow else { return usual };
        match Some(slow).filter(|slow| slow.until.is_none_or(|until| now < until)) {
            // Not at once: in the execution in which it hears that a slow move is over it would be two blocks farther.
            None if body.moved.1 && now.since(body.moved.0) <= body.period.saturating_mul(2) => {
                usual.max(Duration::from_nanos(1))
            }
            None => usual,
            Some(slow) => slow.lasting(usual, body.period, now),
        }
    }

    fn body(&self, robot: u32) -> Result<&Body, Failure> {
        self.bodies.get(&robot).ok_or_else(|| unknown(robot))
    }

    pub(super) fn block(&self, robot: u32) -> Result<Block, Failure> {
        self.body(robot).map(|body| body.block)
    }

    pub(super) fn is_running(&self, robot: u32) -> Result<bool, Failure> {
        self.body(robot).map(|body| body.moving.is_some() || body.handling.is_some())
    }

    pub(super) fn handling(&self, robot: u32) -> Result<Option<(Action, Time)>, Failure> {
        self.body(robot).map(|body| body.handling)
    }

    pub(super) fn begin_handling(&mut self, robot: u32, action: Action, until: Time) -> Result<(), Failure> {
        let body = self.bodies.get_mut(&robot).ok_or_else(|| unknown(robot))?;
        body.handling = Some((action, until));
        Ok(())
    }

    pub(super) fn end_handling(&mut self, robot: u32, progress: Progress) {
        if let Some(body) = self.bodies.get_mut(&robot)
            && let Some((action, _)) = body.handling.take()
        {
            body.handled = Some((action, progress));
        }
    }

    /// True if this was the robot's last action, and it is done: the robot that begins it again did not hear of that.
    pub(super) fn has_done(&self, robot: u32, action: Action) -> bool {
        self.bodies.get(&robot).is_some_and(|body| body.handled == Some((action, Progress::Done)))
    }

    /// True if the robot registered again, and has not shown yet whether it knows what it carries.
    pub(super) fn has_entered_again(&self, robot: u32) -> bool {
        self.bodies.get(&robot).is_some_and(|body| body.entered_again)
    }

    /// The robot has shown that it knows what it carries; true if that was open.
    pub(super) fn remembers(&mut self, robot: u32) -> bool {
        self.bodies.get_mut(&robot).is_some_and(|body| std::mem::take(&mut body.entered_again))
    }

    /// The robot has shown that it begins anew; true if that was open.
    pub(super) fn has_forgotten(&mut self, robot: u32) -> bool {
        let Some(body) = self.bodies.get_mut(&robot).filter(|body| body.entered_again) else { return false };
        (body.entered_again, body.handled) = (false, None);
        true
    }

    /// Starts a move that lasts until `until`. The inner error is the reason why the move is impossible.
    pub(super) fn begin_move(
        &mut self,
        robot: u32,
        to: Block,
        (now, until): (Time, Time),
    ) -> Result<Result<Option<Collision>, String>, Failure> {
        let from = self.block(robot)?;
        if from.distance(to) != 1 {
            return Ok(Err(format!("{to} is not beside {from}")));
        }
        if !self.map.is_free(to) {
            return Ok(Err(format!("{to} is not a free block of the map")));
        }
        let collision = self.collide(robot, from, to);
        self.hold(to);
        if let Some(body) = self.bodies.get_mut(&robot) {
            body.handled = None;
            body.moving = Some((to, until));
            body.moved.1 = until > now;
            self.moving += 1;
        }
        Ok(Ok(collision))
    }

    /// Progress of the robot's move.
    pub(super) fn progress(&mut self, robot: u32, now: Time) -> Progress {
        let Some(body) = self.bodies.get_mut(&robot) else { return Progress::Failed };
        match body.moving {
            Some((_, until)) if now < until => Progress::Running,
            Some((to, _)) => {
                let from = std::mem::replace(&mut body.block, to);
                body.moving = None;
                body.moved.0 = now;
                self.moving -= 1;
                self.leave(robot, from);
                Progress::Done
            }
            None => body.handled.map_or(Progress::Done, |(_, progress)| progress),
        }
    }

    /// Ends the moves that are over, including those of robots that did not ask.
    pub(super) fn settle(&mut self, now: Time) {
        if self.moving == 0 {
            return;
        }
        let over = |body: &Body| body.moving.is_some_and(|(_, until)| until <= now);
        let done: Vec<u32> = self.bodies.iter().filter(|(_, body)| over(body)).map(|(robot, _)| *robot).collect();
        for robot in done {
            self.progress(robot, now);
        }
    }

    /// Stops a robot; an unfinished move leaves it where it was.
    pub(super) fn cancel(&mut self, robot: u32) -> Result<(), Failure> {
        let body = self.bodies.get_mut(&robot).ok_or_else(|| unknown(robot))?;
        body.handling = None;
        if let Some((to, _)) = body.moving.take() {
            self.moving -= 1;
            self.leave(robot, to);
        }
        Ok(())
    }

    /// Takes a robot out of service until it starts again, and returns its position.
    pub(super) fn retire(&mut self, robot: u32) -> Result<Block, Failure> {
        self.cancel(robot)?;
        let body = self.bodies.get_mut(&robot).ok_or_else(|| unknown(robot))?;
        body.retired = true;
        Ok(body.block)
    }

    /// Takes a robot out of service whose component failed at a time: what was over by then is done, and it stays where
    /// it is. False if it has registered again since.
    pub(super) fn fail(&mut self, robot: u32, since: Time) -> Result<bool, Failure> {
        if self.body(robot)?.entered > since {
            return Ok(false);
        }
        self.settle(since);
        self.retire(robot).map(|_| true)
    }

    /// Takes a robot off the floor until it starts again: it holds no block any more. Returns the block where it was;
    /// `None` if it is off the floor already.
    pub(super) fn remove(&mut self, robot: u32) -> Result<Option<Block>, Failure> {
        let block = self.retire(robot)?;
        let body = self.bodies.get_mut(&robot).ok_or_else(|| unknown(robot))?;
        if std::mem::replace(&mut body.gone, true) {
            return Ok(None);
        }
        (body.handled, body.entered_again) = (None, false);
        self.leave(robot, block);
        Ok(Some(block))
    }

    /// True if a robot that is out since then is off the floor, or out of service where it stands, or is back.
    pub(super) fn was_out(&self, robot: u32, is_gone: bool, since: Time) -> bool {
        let is_back = self.bodies.get(&robot).is_some_and(|body| body.entered > since);
        is_back || self.is_out(robot, is_gone, since)
    }

    /// True if a robot that is out since then is off the floor, or out of service where it stands.
    pub(super) fn is_out(&self, robot: u32, is_gone: bool, since: Time) -> bool {
        let body = self.bodies.get(&robot).filter(|body| body.entered <= since);
        body.is_some_and(|body| if is_gone { body.gone } else { body.retired })
    }

    pub(super) fn is_retired(&self, robot: u32) -> bool {
        self.bodies.get(&robot).is_some_and(|body| body.retired)
    }

    /// True if a robot that is out of service is on the block.
    pub(super) fn is_retired_at(&self, block: Block) -> bool {
        self.bodies.values().any(|body| body.retired && !body.gone && body.block == block)
    }

    fn collide(&mut self, robot: u32, from: Block, to: Block) -> Option<Collision> {
        let exchanges = |meeting: &Meeting| meeting.other == robot && meeting.block == from && meeting.from == to;
        if let Some(place) = self.meetings.iter().position(exchanges) {
            let meeting = self.meetings.remove(place);
            return Some(Collision { robot: meeting.entered, other: robot, block: from, swap: true });
        }
        let other = self.holder(to, robot)?;
        let meeting = Meeting { entered: robot, from, other, block: to };
        self.meetings.push(meeting);
        Some(Collision { robot, other, block: to, swap: false })
    }

    fn hold(&mut self, block: Block) {
        if let Some(place) = self.map.place(block) {
            if self.holders.is_empty() {
                self.holders = vec![0; self.map.size()];
            }
            self.holders[place] = self.holders[place].saturating_add(1);
        }
    }

    fn leave(&mut self, robot: u32, block: Block) {
        if let Some(holders) = self.map.place(block).and_then(|place| self.holders.get_mut(place)) {
            *holders = holders.saturating_sub(1);
        }
        if !self.meetings.is_empty() {
            self.meetings
                .retain(|meeting| meeting.block != block || (meeting.entered != robot && meeting.other != robot));
        }
    }

    /// Another robot that holds the block.
    fn holder(&self, block: Block, robot: u32) -> Option<u32> {
        if *self.holders.get(self.map.place(block)?)? == 0 {
            return None;
        }
        let holds = |body: &Body| body.block == block || body.moving.is_some_and(|(to, _)| to == block);
        self.bodies.iter().find(|(other, body)| **other != robot && !body.gone && holds(body)).map(|(other, _)| *other)
    }
}

fn unknown(robot: u32) -> Failure {
    Failure::new(format!("robot {robot} is not in this world"))
}
