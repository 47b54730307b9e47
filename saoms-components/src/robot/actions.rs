use saoms_api::{Context, Failure};

use crate::grid::Block;
use crate::hardware::{Action, ActionKind, Progress};
use crate::messages::{Collision, LuggageStage};

use super::hooks::Reply;
use super::{RobotKnowledge, Trouble};

/// Hardware that fails so often one after the other to move or to deposit is broken.
const MOST_FAILURES: u32 = 5;

/// A robot tries so often to collect luggage.
const MOST_ATTEMPTS: u32 = 3;

/// How an action of the hardware stands after this execution's call.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Outcome {
    /// The hardware could not be reached, so nothing began.
    NotBegun,
    /// It goes on.
    Running,
    /// It is done, and the robot's knowledge says so.
    Done,
    /// It failed.
    Failed,
}

impl Outcome {
    /// Whether the action is not over, or has yet to begin.
    pub(crate) const fn is_open(self) -> bool {
        matches!(self, Outcome::Running | Outcome::NotBegun)
    }
}

impl RobotKnowledge {
    /// Starts an action and, where it is done at once, takes in what it changed.
    pub(crate) fn begin(&mut self, context: &mut Context<'_>, action: Action) -> Result<Outcome, Failure> {
        if action.kind != ActionKind::Move {
            self.show_ready(context, action);
        }
        match self.hooks.begin(context, self.number, action)? {
            Reply::Later => Ok(Outcome::NotBegun),
            Reply::Answer(progress) => {
                if action.kind == ActionKind::Move {
                    self.next = action.block;
                }
                self.take_in(context, action, progress)
            }
        }
    }

    /// Asks how the running action goes and, where it is over, takes in what it changed. `None` when none is running.
    pub(crate) fn poll(&mut self, context: &mut Context<'_>) -> Result<Option<(Action, Outcome)>, Failure> {
        let Some(action) = self.hooks.running() else { return Ok(None) };
        let outcome = match self.hooks.poll(context, self.number)? {
            Reply::Later => Outcome::Running,
            Reply::Answer(progress) => self.take_in(context, action, progress)?,
        };
        Ok(Some((action, outcome)))
    }

    /// Ends the work of the hardware for good, and learns where the robot stays; `false` while it cannot be reached.
    pub(crate) fn retire(&mut self, context: &mut Context<'_>) -> Result<bool, Failure> {
        let Reply::Answer(block) = self.hooks.retire(context, self.number)? else { return Ok(false) };
        self.block = block.unwrap_or(self.block);
        Ok(true)
    }

    fn take_in(
        &mut self,
        context: &mut Context<'_>,
        action: Action,
        progress: Progress,
    ) -> Result<Outcome, Failure> {
        match progress {
            Progress::Running => Ok(Outcome::Running),
            Progress::Done => {
                self.failures = 0;
                self.done(context, action).map(|()| Outcome::Done)
            }
            Progress::Failed => {
                self.failed(context, action);
                Ok(Outcome::Failed)
            }
        }
    }

    fn done(&mut self, context: &mut Context<'_>, action: Action) -> Result<(), Failure> {
        let Action { kind, block, luggage } = action;
        let name = &self.name;
        match kind {
            ActionKind::Move => {
                self.block = block;
                self.judge(context, block)?;
            }
            ActionKind::Collect => {
                context.console(format_args!("{name} says: Luggage collected."));
                context.info(format_args!("collected luggage {luggage} at {block}"));
                self.variables.has_luggage = true;
            }
            ActionKind::Deposit => {
                context.console(format_args!("{name} says: Luggage deposited."));
                context.info(format_args!("deposited luggage {luggage} at {block}"));
                self.untold = self.job.map(|job| (job, LuggageStage::Delivered));
                if self.job.is_some() && !self.hooks.is_wired() {
                    context.count("luggage.delivered", 1);
                }
                self.drop_job();
            }
        }
        Ok(())
    }

    fn failed(&mut self, context: &mut Context<'_>, action: Action) {
        self.failures += 1;
        if self.failures == MOST_FAILURES && action.kind != ActionKind::Collect {
            self.trouble = Some(Trouble::Hardware);
        }
        let Action { kind, block, luggage } = action;
        match kind {
            ActionKind::Move => {
                self.next = self.block;
                context.warn(format_args!("could not move to {block}"));
            }
            ActionKind::Collect => {
                if self.failures < MOST_ATTEMPTS {
                    context.warn(format_args!("could not collect luggage {luggage} at {block}: tries again"));
                    return;
                }
                context
                    .warn(format_args!("could not collect luggage {luggage} at {block}: gives the job up"));
                self.untold = self.job.map(|job| (job, LuggageStage::Refused));
                self.failures = 0;
                self.drop_job();
            }
            ActionKind::Deposit => {
                context.warn(format_args!("could not deposit luggage {luggage} at {block}: tries again"));
            }
        }
    }

    /// The robot is free again.
    pub(super) fn drop_job(&mut self) {
        let variables = &mut self.variables;
        (variables.busy, variables.transporter, variables.has_luggage) = (false, false, false);
        variables.healer = false;
        self.job = None;
    }

    /// Without a world nobody else counts collisions: who enters a block that another robot announced to be on does.
    fn judge(&self, context: &mut Context<'_>, block: Block) -> Result<(), Failure> {
        let other = self.lists.peers.on(block).filter(|_| !self.hooks.is_wired());
        let Some(other) = other.map(|peer| peer.robot) else { return Ok(()) };
        let collision = Collision { robot: self.number, other, block, swap: false };
        context.count("collisions.vertex", 1);
        context.warn(format_args!("{collision}"));
        context.send(&self.collisions, collision)
    }

    fn show_ready(&self, context: &mut Context<'_>, action: Action) {
        let what = if action.kind == ActionKind::Collect { "collect" } else { "deposit" };
        let (name, block) = (&self.name, action.block);
        context.console(format_args!("{name} says: Ready to {what} luggage in position {block}"));
    }
}
