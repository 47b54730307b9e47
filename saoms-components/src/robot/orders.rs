//! Orders to the hardware that loops write into entries, and questions about what they began.

use saoms_api::{Context, Failure, Loops};

use super::RobotKnowledge;
use super::actions::Outcome;
use crate::hardware::{Action, ActionKind};

impl RobotKnowledge {
    /// Asks the hardware about an action that no loop asks about. What changes is an effect of the loop that ordered
    /// the action.
    pub(super) fn poll_unwatched(&mut self, loops: &Loops, context: &mut Context<'_>) -> Result<(), Failure> {
        if (self.moving && !self.polling.moves) || (self.handling && !self.polling.handling) {
            let entry = if self.moving { "drive" } else { "grip" };
            self.polled = loops.act_for(entry, context, |context| self.poll(context))?;
        }
        Ok(())
    }

    /// Carries out the orders of this execution. The wheels go first: a robot cannot use its gripper while it moves.
    pub(super) fn carry_out(&mut self, loops: &Loops, context: &mut Context<'_>) -> Result<(), Failure> {
        let (drive, grip) = (self.orders.drive.take(), std::mem::take(&mut self.orders.grip));
        if self.hardware.running().is_some() || self.variables.critical || self.stopped {
            return Ok(());
        }
        if let Some(to) = drive.filter(|to| *to != self.block) {
            if self.block.distance(to) != 1 || !self.routes.is_free(to) {
                let block = self.block;
                return Err(Failure::new(format!(
                    "`drive` is {to}, but the robot is at {block}: expected a free block beside that one"
                )));
            }
            let outcome = self.act("drive", Action::move_to(to), loops, context)?;
            if matches!(outcome, Outcome::Done | Outcome::Running) {
                self.energy.pace().note_way(true, true);
            }
        } else if let Some(action) = self.gripping().filter(|_| grip) {
            self.act("grip", action, loops, context)?;
        }
        Ok(())
    }

    /// The next work of the gripper for the job.
    pub(super) fn gripping(&self) -> Option<Action> {
        let job = self.job.filter(|_| self.variables.busy)?;
        let carries = self.variables.has_luggage;
        Some(if carries { Action::deposit(job.luggage, job.to) } else { Action::collect(job.luggage, job.from) })
    }

    fn act(
        &mut self,
        entry: &str,
        action: Action,
        loops: &Loops,
        context: &mut Context<'_>,
    ) -> Result<Outcome, Failure> {
        loops.act_for(entry, context, |context| {
            let before = self.noted();
            let outcome = self.begin(context, action)?;
            self.note_changes(context, before);
            Ok(outcome)
        })
    }

    /// Notes what the hardware does now.
    pub(super) fn note_running(&mut self) {
        let kind = self.hardware.running().map(|action| action.kind);
        self.moving = kind == Some(ActionKind::Move);
        self.handling = kind.is_some() && !self.moving;
    }
}
