use saoms_api::Failure;

use crate::grid::Block;
use crate::hardware::{Action, ActionKind, Progress};
use crate::messages::{Collision, LuggageStage};

use super::{Body, Reply};

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

impl Body<'_, '_> {
    /// Starts an action and, where it is done at once, takes in what it changed.
    pub(crate) fn begin(&mut self, action: Action) -> Result<Outcome, Failure> {
        if action.kind != ActionKind::Move {
            self.show_ready(action);
        }
        match self.hooks.begin(self.context, self.knowledge.number, action)? {
            Reply::Later => Ok(Outcome::NotBegun),
            Reply::Answer(progress) => {
                if action.kind == ActionKind::Move {
                    self.knowledge.next = action.block;
                }
                self.take_in(action, progress)
            }
        }
    }

    /// Asks how the running action goes and, where it is over, takes in what it changed. `None` when none is running.
    pub(crate) fn poll(&mut self) -> Result<Option<(Action, Outcome)>, Failure> {
        let Some(action) = self.hooks.running() else { return Ok(None) };
        let outcome = match self.hooks.poll(self.context, self.knowledge.number)? {
            Reply::Later => Outcome::Running,
            Reply::Answer(progress) => self.take_in(action, progress)?,
        };
        Ok(Some((action, outcome)))
    }

    fn take_in(&mut self, action: Action, progress: Progress) -> Result<Outcome, Failure> {
        match progress {
            Progress::Running => Ok(Outcome::Running),
            Progress::Done => self.done(action).map(|()| Outcome::Done),
            Progress::Failed => self.failed(action).map(|()| Outcome::Failed),
        }
    }

    fn done(&mut self, action: Action) -> Result<(), Failure> {
        let Action { kind, block, luggage } = action;
        let name = &self.knowledge.name;
        match kind {
            ActionKind::Move => {
                self.knowledge.block = block;
                return self.judge(block);
            }
            ActionKind::Collect => {
                self.context.console(format_args!("{name} says: Luggage collected."));
                self.context.info(format_args!("collected luggage {luggage} at {block}"));
                self.knowledge.variables.has_luggage = true;
                return Ok(());
            }
            ActionKind::Deposit => {
                self.context.console(format_args!("{name} says: Luggage deposited."));
                self.context.info(format_args!("deposited luggage {luggage} at {block}"));
            }
        }
        if let Some(job) = self.knowledge.job {
            self.respond(&job, LuggageStage::Delivered)?;
            if !self.hooks.is_wired() {
                self.context.count("luggage.delivered", 1);
            }
        }
        self.drop_job();
        Ok(())
    }

    fn failed(&mut self, action: Action) -> Result<(), Failure> {
        let Action { kind, block, luggage } = action;
        match kind {
            ActionKind::Move => {
                self.knowledge.next = self.knowledge.block;
                self.context.warn(format_args!("could not move to {block}"));
            }
            ActionKind::Collect => {
                self.context
                    .warn(format_args!("could not collect luggage {luggage} at {block}: gives the job up"));
                self.drop_job();
            }
            ActionKind::Deposit => {
                self.context
                    .warn(format_args!("could not deposit luggage {luggage} at {block}: tries again"));
            }
        }
        Ok(())
    }

    /// The robot is free again.
    fn drop_job(&mut self) {
        let variables = &mut self.knowledge.variables;
        (variables.busy, variables.transporter, variables.has_luggage) = (false, false, false);
        self.knowledge.job = None;
    }

    /// Without a world nobody else counts collisions: who enters a block that another robot announced to be on does.
    fn judge(&mut self, block: Block) -> Result<(), Failure> {
        let other = self.knowledge.lists.peers.on(block).filter(|_| !self.hooks.is_wired());
        let Some(other) = other.map(|peer| peer.robot) else { return Ok(()) };
        let collision = Collision { robot: self.knowledge.number, other, block, swap: false };
        self.context.count("collisions.vertex", 1);
        self.context.warn(format_args!("{collision}"));
        self.topics.say_collision(self.context, collision)
    }

    fn show_ready(&mut self, action: Action) {
        let what = if action.kind == ActionKind::Collect { "collect" } else { "deposit" };
        let (name, block) = (&self.knowledge.name, action.block);
        self.context.console(format_args!("{name} says: Ready to {what} luggage in position {block}"));
    }
}
