//! A robot that goes on after a failure: it finds out what its hardware did meanwhile.
//!
//! What the execution that failed told the hardware is not in the state that the robot goes on from: an action may be
//! over, and another one begun. Of the latter it is known which it can be: a move to the block that the robot had
//! announced, or that a zone had granted, or the work of the gripper where it is. Until it knows, the robot is silent,
//! so that what it had announced counts for the others.

use saoms_api::{Cause, Context, Failure};

use super::actions::Outcome;
use super::hardware_client::Reply;
use super::{Policy, RobotKnowledge};
use crate::grid::Block;
use crate::hardware::{Action, ActionKind, Progress};

/// The kind of the alert about an action of which nobody knows whether it was done.
const OPEN_ACTION: &str = "open_action";

impl RobotKnowledge {
    /// Finds out what the hardware did and does; `false` as long as it does not know.
    pub(super) fn catch_up(&mut self, context: &mut Context<'_>) -> Result<bool, Failure> {
        // Somebody took it off the floor while it was out, of which it did not hear.
        let Reply::Answer(is_on_floor) = self.hardware.is_on_floor(context, self.number)? else { return Ok(false) };
        if !is_on_floor {
            self.leave_floor(context)?;
            return Ok(false);
        }
        if !self.routes.knows_area() {
            let Reply::Answer(map) = self.hardware.area(context)? else { return Ok(false) };
            self.routes.learn_again(map, self.charge_block, &self.lists.charging_places);
        }
        if let Some(zones) = &mut self.zones {
            zones.hear_grants(context, self.routes.map());
        }
        let Some(progress) = self.progress_meanwhile(context)? else { return Ok(false) };
        let running = self.hardware.running();
        if progress == Progress::Running {
            let known = running.filter(|action| !self.may_have_begun_after(*action));
            let Some(action) = known.or_else(|| self.only_action().filter(|_| running.is_none())) else {
                return Ok(false);
            };
            if running.is_none() {
                self.begun = Cause::default();
                self.next = if action.kind == ActionKind::Move { action.block } else { self.block };
            }
            self.caught_up(context, Some(action));
            return Ok(true);
        }
        let arrived = running.filter(|action| action.kind == ActionKind::Move && progress == Progress::Done);
        let expected = arrived.map_or(self.block, |action| action.block);
        let Reply::Answer(block) = self.hardware.locate(context, self.number, &self.name, expected)? else {
            return Ok(false);
        };
        // That tells the hardware that the robot has not begun anew.
        let Reply::Answer(_) = self.hardware.ask(context, self.number)? else { return Ok(false) };
        self.caught_up(context, None);
        if let Some(action) = running {
            let arrived = action.kind == ActionKind::Move && block == action.block;
            self.take_in_late(context, action, if arrived { Progress::Done } else { progress })?;
        }
        if block != self.block {
            self.moved_to(block);
        }
        Ok(true)
    }

    /// Progress of what the hardware did; `None` as long as it is not known.
    fn progress_meanwhile(&mut self, context: &mut Context<'_>) -> Result<Option<Progress>, Failure> {
        let known = match self.hardware.recall(context, self.number)? {
            None => self.hardware.ask(context, self.number)?,
            Some(Reply::Later) => Reply::Later,
            Some(Reply::Answer(Some(progress))) => Reply::Answer(progress),
            Some(Reply::Answer(None)) => self.ask_a_person(context),
        };
        Ok(match known {
            Reply::Answer(progress) => Some(progress),
            Reply::Later => None,
        })
    }

    fn caught_up(&mut self, context: &mut Context<'_>, running: Option<Action>) {
        self.end_open_action(context);
        self.hardware.caught_up(running);
        self.note_running();
    }

    /// Ends the alert about an action of which nobody knew, also that of an instance before, or of an earlier program.
    pub(super) fn end_open_action(&mut self, context: &mut Context<'_>) {
        if self.hardware.is_recalled() {
            self.hardware.asks_no_more();
            context.alert_over(OPEN_ACTION, "");
        }
    }

    /// Asks a person what became of an action that an earlier program began. What was said counts until the robot has
    /// caught up, which hardware that is busy may delay.
    fn ask_a_person(&mut self, context: &mut Context<'_>) -> Reply<Progress> {
        let Some(progress) = self.hardware.told else {
            if !std::mem::replace(&mut self.hardware.asks_a_person, true) {
                let what = self.hardware.running().map(|action| action.to_string()).unwrap_or_default();
                let name = context.name().to_owned();
                context.alert(
                    OPEN_ACTION,
                    "",
                    format_args!(
                        "the program ended while the robot was about to {what}, and its hardware does not know whether \
                         it did: look, and say `saoms call {name}.settle done=true`, or `done=false` if it did not"
                    ),
                );
            }
            return Reply::Later;
        };
        Reply::Answer(progress)
    }

    fn take_in_late(
        &mut self,
        context: &mut Context<'_>,
        action: Action,
        progress: Progress,
    ) -> Result<Outcome, Failure> {
        let before = self.noted();
        context.because(self.begun);
        let outcome = self.take_in(context, action, progress)?;
        self.note_changes(context, before);
        context.because(Cause::default());
        Ok(outcome)
    }

    /// True if an execution that found this action done may have begun another one.
    fn may_have_begun_after(&self, action: Action) -> bool {
        let is_move = action.kind == ActionKind::Move && self.policy == Policy::Safe;
        let announced = match &self.zones {
            Some(zones) => zones.next_after(action.block),
            None => self.traffic.wanted(action.block),
        };
        is_move && (announced.is_some() || self.uses_gripper_at(action.block))
    }

    /// The only action that an execution can have begun; `None` if there are several.
    fn only_action(&self) -> Option<Action> {
        let announced = match (self.policy, &self.zones) {
            (Policy::Safe, Some(zones)) => zones.next_after(self.block),
            (Policy::Safe, None) => self.traffic.wanted(self.next),
            (Policy::Classic, _) => Some(self.next).filter(|next| *next != self.block),
        };
        match announced {
            Some(_) if self.uses_gripper_at(self.block) => None,
            Some(block) => Some(Action::move_to(block)),
            None => self.gripping().filter(|_| self.uses_gripper_at(self.block)),
        }
    }

    fn uses_gripper_at(&self, block: Block) -> bool {
        self.destination().is_some_and(|destination| destination == block || destination.distance(block) == 1)
    }

    /// Takes in a move of which it did not hear.
    fn moved_to(&mut self, block: Block) {
        if self.block.distance(block) == 1 {
            self.tally.blocks += 1;
            self.use_battery_to_drive();
            self.traffic.went(self.block);
        }
        (self.block, self.next) = (block, block);
        if let Some(zones) = &mut self.zones {
            zones.arrive(block);
        }
    }
}
