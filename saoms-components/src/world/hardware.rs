//! The simulated hardware of the robots.

use saoms_api::{Context, Failure, warn};

use super::World;
use super::luggage::HandlingOutcome;
use crate::grid::Block;
use crate::hardware::{Action, ActionKind, Area, Hardware, Progress};
use crate::messages::{Collision, Handling, HandlingKind, Removal};

impl World {
    fn begin_move(&mut self, context: &mut Context<'_>, robot: u32, to: Block) -> Result<Progress, Failure> {
        let now = context.now();
        let until = now + self.referee.lasting(robot, self.properties.move_time, now);
        match self.referee.begin_move(robot, to, (now, until))? {
            Ok(collision) => {
                if let Some(collision) = collision {
                    self.report(context, collision)?;
                }
                Ok(self.referee.progress(robot, context.now()))
            }
            Err(reason) => {
                warn!(context, "robot {robot} cannot move: {reason}");
                Ok(Progress::Failed)
            }
        }
    }

    fn report(&mut self, context: &mut Context<'_>, collision: Collision) -> Result<(), Failure> {
        if collision.swap {
            // It was counted as a meeting in one block when the first of the two robots moved.
            context.count("collisions.vertex", -1);
            context.count("collisions.swap", 1);
        } else {
            context.count("collisions.vertex", 1);
            self.collided += 1;
        }
        warn!(context, "{collision}");
        context.send(&self.collisions, collision)
    }

    /// True if a robot is at a block, or beside a robot that is out of service there.
    fn reaches(&self, robot: u32, block: Block) -> Result<bool, Failure> {
        let here = self.referee.block(robot)?;
        Ok(here == block || here.distance(block) == 1 && self.referee.is_retired_at(block))
    }

    /// Ends collecting or depositing.
    fn handle(&mut self, context: &mut Context<'_>, robot: u32, action: Action) -> Result<Progress, Failure> {
        let (referee, block) = (&self.referee, action.block);
        let lies_on = |other: u32| {
            (referee.is_retired(other) || referee.has_entered_again(other)) && referee.block(other) == Ok(block)
        };
        let other = self.stock.bearer(action.luggage).filter(|_| action.kind == ActionKind::Collect);
        let result = match action.kind {
            ActionKind::Collect => self.stock.collect(action.luggage, robot, block, lies_on),
            _ => self.stock.deposit(action.luggage, robot, block),
        };
        match result {
            Ok(HandlingOutcome::Unknown) => {
                self.memory.forget();
                return Ok(Progress::Running);
            }
            Ok(HandlingOutcome::Delivered { given_up }) => {
                self.tell(context, (robot, HandlingKind::Delivered, block), None, &[action.luggage])?;
                self.count_delivery(context, given_up);
            }
            Ok(HandlingOutcome::Handled) => {
                let is_collected = action.kind == ActionKind::Collect;
                let kind = if is_collected { HandlingKind::Collected } else { HandlingKind::PutDown };
                self.tell(context, (robot, kind, block), other, &[action.luggage])?;
            }
            Err(reason) => {
                warn!(context, "robot {robot} at {block}: {reason}");
                self.referee.end_handling(robot, Progress::Failed);
                return Ok(Progress::Failed);
            }
        }
        self.referee.end_handling(robot, Progress::Done);
        Ok(Progress::Done)
    }

    /// Says what a robot did with pieces at a block, and from which other robot it took them.
    pub(super) fn tell(
        &self,
        context: &mut Context<'_>,
        (robot, kind, block): (u32, HandlingKind, Block),
        other: Option<u32>,
        pieces: &[u32],
    ) -> Result<(), Failure> {
        let other = other.unwrap_or(0);
        let told = pieces.iter().map(|luggage| Handling { luggage: *luggage, robot, kind, block, other });
        told.into_iter().try_for_each(|handling| context.send(&self.handlings, handling))
    }

    /// The robot has begun anew: what it carries it does not know of, so that it lies where it is.
    fn unload_if_forgotten(&mut self, context: &mut Context<'_>, robot: u32) -> Result<(), Failure> {
        if self.referee.has_forgotten(robot) {
            let block = self.referee.block(robot)?;
            let (delivered, luggage) = self.put_down(context, robot, block)?;
            if !delivered.is_empty() || !luggage.is_empty() {
                let since = context.now();
                let block = Some(block);
                self.say_left(context, Removal { robot, kind: None, since, block, luggage, delivered })?;
            }
        }
        Ok(())
    }
}

impl Hardware for World {
    fn enter(&mut self, context: &mut Context<'_>, robot: u32, name: String, block: Block) -> Result<Block, Failure> {
        self.memory.forget();
        let was_retired = self.referee.is_retired(robot);
        let block = self.referee.enter(robot, name, block, context.now())?;
        if was_retired && self.referee.has_forgotten(robot) {
            // Its luggage lies where other robots look for it.
            let unloaded = self.stock.unload(robot, block);
            self.tell(context, (robot, HandlingKind::PutDown, block), None, &unloaded)?;
        }
        Ok(block)
    }

    fn area(&mut self, _context: &mut Context<'_>) -> Result<Area, Failure> {
        Ok(self.referee.map().into())
    }

    fn begin(&mut self, context: &mut Context<'_>, robot: u32, action: Action) -> Result<Progress, Failure> {
        self.memory.forget();
        if self.referee.is_running(robot)? {
            return Err(Failure::new(format!("robot {robot} begins an action before its previous action has ended")));
        }
        self.unload_if_forgotten(context, robot)?;
        if self.referee.is_retired(robot) {
            return Ok(Progress::Failed);
        }
        if action.kind == ActionKind::Move {
            return self.begin_move(context, robot, action.block);
        }
        if self.referee.has_done(robot, action) {
            return Ok(Progress::Done);
        }
        // Decided once, at the beginning: meanwhile a robot that stood there may start again, and leave.
        if !self.reaches(robot, action.block)? {
            let here = self.referee.block(robot)?;
            warn!(context, "robot {robot} at {here} cannot reach {}", action.block);
            return Ok(Progress::Failed);
        }
        let now = context.now();
        let until = now + self.referee.lasting(robot, self.properties.handling_time, now);
        self.referee.begin_handling(robot, action, until)?;
        self.poll(context, robot)
    }

    fn poll(&mut self, context: &mut Context<'_>, robot: u32) -> Result<Progress, Failure> {
        // Only a robot that goes on asks before it begins something: it knows what it carries.
        if self.referee.remembers(robot) {
            self.memory.forget();
        }
        let progress = match self.referee.handling(robot)? {
            _ if self.referee.is_retired(robot) => Progress::Failed,
            None => self.referee.progress(robot, context.now()),
            Some((_, until)) if context.now() < until => Progress::Running,
            Some((action, _)) => self.handle(context, robot, action)?,
        };
        if progress != Progress::Running {
            self.memory.forget();
        }
        Ok(progress)
    }

    fn cancel(&mut self, context: &mut Context<'_>, robot: u32) -> Result<(), Failure> {
        self.memory.forget();
        self.unload_if_forgotten(context, robot)?;
        self.referee.cancel(robot)
    }

    fn retire(&mut self, context: &mut Context<'_>, robot: u32) -> Result<Block, Failure> {
        self.memory.forget();
        self.unload_if_forgotten(context, robot)?;
        self.referee.retire(robot)
    }

    fn recall(&mut self, context: &mut Context<'_>, robot: u32, _action: Action) -> Result<Option<Progress>, Failure> {
        // One that does not know the robot was started anew. Otherwise it knows what the robot began last, which may be
        // another action than that of which the robot knows.
        if self.referee.block(robot).is_err() {
            return Ok(None);
        }
        self.poll(context, robot).map(Some)
    }

    fn is_on_floor(&mut self, _context: &mut Context<'_>, robot: u32) -> Result<bool, Failure> {
        Ok(self.referee.is_on_floor(robot))
    }
}
