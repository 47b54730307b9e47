//! Robots that are out without having said so: somebody took them off the floor, or their component failed.

use saoms_api::{Context, Failure, Time, record, warn};

use super::World;
use super::luggage::HandlingOutcome;
use crate::grid::Block;
use crate::messages::{Fault, FaultKind, HandlingKind, Removal};

impl World {
    /// Somebody took a robot off the floor, at this time.
    pub(super) fn take_away(&mut self, context: &mut Context<'_>, fault: &Fault, since: Time) -> Result<(), Failure> {
        let robot = fault.robot;
        if self.validator.check_known(robot).is_err() {
            // The master reports it.
            return Ok(());
        }
        // A robot of another world is off this floor anyway, and lay nothing down here.
        let (block, delivered, luggage) = match self.referee.remove(robot) {
            Ok(None) => return Ok(()),
            Ok(Some(block)) => {
                let (delivered, luggage) = self.put_down(context, robot, block)?;
                context.count("robots.gone", 1);
                context.effect(record!(frees_block: "robot {robot} is gone: {block} is free", robot, block));
                warn!(context, "{fault}: {block} is free");
                (Some(block), delivered, luggage)
            }
            Err(_) => (None, Vec::new(), Vec::new()),
        };
        self.say_left(context, Removal { robot, kind: Some(FaultKind::Gone), since, block, luggage, delivered })
    }

    /// A robot lets go of what it carries: what is at its destination there is delivered. Returns the numbers of these
    /// pieces, and those of the others.
    pub(super) fn put_down(
        &mut self,
        context: &mut Context<'_>,
        robot: u32,
        block: Block,
    ) -> Result<(Vec<u32>, Vec<u32>), Failure> {
        let delivered = self.stock.carried_to(robot, block);
        for luggage in &delivered {
            if let Ok(HandlingOutcome::Delivered { given_up }) = self.stock.deposit(*luggage, robot, block) {
                self.count_delivery(context, given_up);
            }
        }
        let unloaded = self.stock.unload(robot, block);
        self.tell(context, (robot, HandlingKind::Delivered, block), None, &delivered)?;
        self.tell(context, (robot, HandlingKind::PutDown, block), None, &unloaded)?;
        Ok((delivered, unloaded))
    }

    /// The component of a robot failed, and lost what it knew: the robot is stopped where it is, and others can take
    /// over what it carries.
    pub(super) fn stop_failed(&mut self, context: &mut Context<'_>, fault: &Fault, since: Time) -> Result<(), Failure> {
        let (robot, kind) = (fault.robot, Some(fault.kind));
        let removal = match self.referee.fail(robot, since) {
            Ok(is_out) => {
                let block = self.referee.block(robot)?;
                let (delivered, luggage) = match is_out || self.referee.has_forgotten(robot) {
                    true => self.put_down(context, robot, block)?,
                    false => (Vec::new(), Vec::new()),
                };
                context
                    .effect(record!(stops_failed_robot: "robot {robot} has failed: it stays at {block}", robot, block));
                warn!(context, "{fault}: it stays at {block}");
                Removal { robot, kind, since, block: Some(block), luggage, delivered }
            }
            // It is none of this world.
            Err(_) => Removal { robot, kind, since, ..Removal::default() },
        };
        self.say_left(context, removal)
    }

    /// Says what a robot left, and remembers it.
    pub(super) fn say_left(&mut self, context: &mut Context<'_>, removal: Removal) -> Result<(), Failure> {
        self.left.insert(removal.robot, removal.clone());
        context.send(&self.removals, removal)
    }

    /// The master did not hear what a robot left, which has been out since then. The news of that may be lost, too.
    pub(super) fn say_again(&mut self, context: &mut Context<'_>, fault: &Fault, since: Time) -> Result<(), Failure> {
        let (robot, kind, is_gone) = (fault.robot, Some(fault.kind), fault.kind == FaultKind::Gone);
        if !self.referee.was_out(robot, is_gone, since) {
            return if is_gone {
                self.take_away(context, fault, since)
            } else {
                self.stop_failed(context, fault, since)
            };
        }
        let removal = match self.left.get(&robot).filter(|left| is_gone || left.since >= since) {
            Some(left) => left.clone(),
            None => Removal { robot, kind, since, block: Some(self.referee.block(robot)?), ..Removal::default() },
        };
        context.send(&self.removals, removal)
    }

    /// Says of all robots that are out what they left, of their luggage what still lies where they let go of it: who
    /// begins while they are out has not heard of them.
    pub(super) fn say_all_again(&self, context: &mut Context<'_>) -> Result<(), Failure> {
        for left in self.left.values() {
            let Removal { robot, since, .. } = *left;
            let (Some(kind), Some(block)) = (left.kind, left.block) else { continue };
            if !self.referee.is_out(robot, kind == FaultKind::Gone, since) {
                continue;
            }
            let luggage = left.luggage.iter().copied().filter(|luggage| self.stock.lies_at(*luggage, block)).collect();
            context.send(&self.removals, Removal { luggage, ..left.clone() })?;
        }
        Ok(())
    }
}
