use saoms_api::{Context, Failure, Record, info, record, warn};

use crate::grid::Block;
use crate::hardware::{Action, ActionKind, Progress};
use crate::messages::{Collision, FIRST_VISIT, LuggageStage};

use super::hardware_client::Reply;
use super::knowledge::JobEnd;
use super::{RobotKnowledge, Trouble, Variables};

/// Number of consecutive failures to move or to deposit after which the hardware counts as broken.
const MOST_FAILURES: u32 = 5;

/// Number of executions for which a robot waits for the next job after one that a master assigned.
const LINGERING: u32 = 4;

/// Maximum number of attempts to collect luggage.
const MOST_ATTEMPTS: u32 = 3;

/// Outcome of the hardware call in this execution.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Outcome {
    /// The hardware could not be reached, so the action did not start.
    NotBegun,
    /// The action is running.
    Running,
    /// The action is done, and the robot's knowledge is updated.
    Done,
    /// The action failed.
    Failed,
}

impl Outcome {
    /// True if the action is running or still has to start.
    pub(crate) const fn is_open(self) -> bool {
        matches!(self, Outcome::Running | Outcome::NotBegun)
    }
}

impl RobotKnowledge {
    /// Starts an action; if it is done at once, updates the robot's knowledge.
    pub(crate) fn begin(&mut self, context: &mut Context<'_>, action: Action) -> Result<Outcome, Failure> {
        if self.stopped || self.waits_for_grant(action) || self.waits_for_master(action) {
            return Ok(Outcome::NotBegun);
        }
        if action.kind != ActionKind::Move {
            self.show_ready(context, action);
        }
        let begun = self.hardware.begin(context, self.number, action);
        self.note_running();
        match begun? {
            Reply::Later => Ok(Outcome::NotBegun),
            Reply::Answer(progress) => {
                self.begun = context.cause();
                if action.kind == ActionKind::Move {
                    self.next = action.block;
                }
                self.take_in(context, action, progress)
            }
        }
    }

    /// Polls the running action; if it is over, updates the robot's knowledge. `None` if no action is running.
    ///
    /// What changes follows from the decision of the loop that began the action.
    pub(crate) fn poll(&mut self, context: &mut Context<'_>) -> Result<Option<(Action, Outcome)>, Failure> {
        let Some(action) = self.hardware.running() else { return Ok(None) };
        let polled = self.hardware.poll(context, self.number);
        self.note_running();
        let outcome = match polled? {
            Reply::Later => Outcome::Running,
            Reply::Answer(progress) => {
                let before = self.noted();
                context.because(self.begun);
                let outcome = self.take_in(context, action, progress)?;
                self.note_changes(context, before);
                outcome
            }
        };
        Ok(Some((action, outcome)))
    }

    /// What an action can change.
    pub(super) fn noted(&self) -> (Block, Block, Variables) {
        (self.block, self.next, self.variables)
    }

    /// Writes to the journal what an action changed outside of a loop's execution, where nobody else looks.
    pub(super) fn note_changes(&self, context: &mut Context<'_>, before: (Block, Block, Variables)) {
        let (block, next, was) = before;
        let now = &self.variables;
        context.changed("block", block, self.block);
        context.changed("next", next, self.next);
        context.changed("busy", was.busy, now.busy);
        context.changed("transporter", was.transporter, now.transporter);
        context.changed("hasLuggage", was.has_luggage, now.has_luggage);
        context.changed("healer", was.healer, now.healer);
    }

    /// Takes the hardware out of service and learns where the robot stays; `false` while the hardware cannot be
    /// reached.
    pub(crate) fn retire(&mut self, context: &mut Context<'_>) -> Result<bool, Failure> {
        let Reply::Answer(block) = self.hardware.retire(context, self.number)? else { return Ok(false) };
        self.end_open_action(context);
        self.note_running();
        self.stays_at(block);
        Ok(true)
    }

    /// Takes in where its hardware stays, which it may not have heard of: its last move was over before it was stopped.
    fn stays_at(&mut self, block: Option<Block>) {
        let Some(block) = block.filter(|block| *block != self.block) else { return };
        self.block = block;
        if let Some(zones) = &mut self.zones {
            zones.arrive(block);
        }
    }

    /// Takes the hardware out of service at the end of the robot. Hardware that is busy is a failure, so that the
    /// shutdown is tried again.
    pub(crate) fn leave_hardware(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        let block = self.hardware.leave(context, self.number)?;
        self.stays_at(block);
        if self.gone {
            // Where it starts again it is in nobody's way, should somebody hear of it who does not know that it is
            // gone.
            self.block = self.charge_block;
        }
        self.note_running();
        Ok(())
    }

    pub(super) fn take_in(
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
                if let Some(zones) = &mut self.zones {
                    zones.arrive(block);
                }
                self.use_battery_to_drive();
                self.tally.blocks += 1;
                self.judge(context, block)?;
            }
            ActionKind::Collect => {
                context.console(format_args!("{name} says: Luggage collected."));
                info!(context, "collected luggage {luggage} at {block}");
                self.variables.has_luggage = true;
            }
            ActionKind::Deposit => {
                context.console(format_args!("{name} says: Luggage deposited."));
                info!(context, "deposited luggage {luggage} at {block}");
                self.untold = self.job.map(|job| JobEnd { job, stage: LuggageStage::Delivered });
                self.tally.delivered += u64::from(self.job.is_some());
                if self.job.is_some() && !self.hardware.is_wired() {
                    context.count("luggage.delivered", 1);
                }
                self.drop_job();
            }
        }
        Ok(())
    }

    fn failed(&mut self, context: &mut Context<'_>, action: Action) {
        // What an operator stopped is no fault of the hardware.
        self.failures += u32::from(!self.stopped);
        if self.failures == MOST_FAILURES && action.kind != ActionKind::Collect {
            self.trouble = Some(Trouble::Hardware);
        }
        let Action { kind, block, luggage } = action;
        context.effect(failure_of(action));
        match kind {
            ActionKind::Move => {
                self.next = self.block;
                warn!(context, "could not move to {block}");
            }
            ActionKind::Collect => {
                if self.failures < MOST_ATTEMPTS {
                    warn!(context, "could not collect luggage {luggage} at {block}: tries again");
                    return;
                }
                warn!(context, "could not collect luggage {luggage} at {block}: gives up the job");
                self.untold = self.job.map(|job| JobEnd { job, stage: LuggageStage::Refused });
                self.lists.requests.refuse(luggage, self.job.map(|job| job.from));
                self.failures = 0;
                self.drop_job();
            }
            ActionKind::Deposit => {
                warn!(context, "could not deposit luggage {luggage} at {block}: tries again");
            }
        }
    }

    /// The robot is at the next block that it visits; after the last one its job is done.
    pub(super) fn visit(&mut self, context: &mut Context<'_>) {
        let (Some(job), false) = (self.job, self.stops.is_empty()) else { return };
        let stop = self.stops.remove(0);
        info!(context, "visits {stop} for visit {}", job.luggage - FIRST_VISIT);
        if self.stops.is_empty() {
            self.untold = Some(JobEnd { job, stage: LuggageStage::Delivered });
            self.tally.delivered += 1;
            self.drop_job();
        }
    }

    /// Ends the job, so that the robot is free again.
    pub(super) fn drop_job(&mut self) {
        let variables = &mut self.variables;
        (variables.busy, variables.transporter, variables.has_luggage) = (false, false, false);
        variables.healer = false;
        (self.job, self.lease) = (None, None);
        self.stops.clear();
        self.awaits_master = 0;
        if self.is_assigned {
            self.lingers = LINGERING;
        }
    }

    /// Reports a collision if no world does: the robot that enters a block which another robot announced as its own
    /// reports it.
    fn judge(&self, context: &mut Context<'_>, block: Block) -> Result<(), Failure> {
        let other = self.lists.peers.on(block).filter(|_| !self.hardware.is_wired());
        let Some(other) = other.map(|peer| peer.robot) else { return Ok(()) };
        let collision = Collision { robot: self.number, other, block, swap: false };
        context.count("collisions.vertex", 1);
        warn!(context, "{collision}");
        context.send(&self.collisions, collision)
    }

    fn show_ready(&self, context: &mut Context<'_>, action: Action) {
        let what = if action.kind == ActionKind::Collect { "collect" } else { "deposit" };
        let (name, block) = (&self.name, action.block);
        context.console(format_args!("{name} says: Ready to {what} luggage in position {block}"));
    }
}

/// A failed action, as the journal has it.
fn failure_of(action: Action) -> Record {
    let Action { kind, block, luggage } = action;
    match kind {
        ActionKind::Move => record!(could_not_move: "could not move to {block}", block),
        ActionKind::Collect => {
            record!(could_not_collect: "could not collect luggage {luggage} at {block}", luggage, block)
        }
        ActionKind::Deposit => {
            record!(could_not_deposit: "could not deposit luggage {luggage} at {block}", luggage, block)
        }
    }
}
