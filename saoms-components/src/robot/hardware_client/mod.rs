mod gauge;
mod patience;
#[cfg(test)]
mod tests;

use saoms_api::{CallError, Context, Failure, Field};

use crate::grid::{Block, Map};
use crate::hardware::{Action, ActionKind, HardwareReference, Progress};

use gauge::Gauge;
use patience::Patience;

/// Client of a robot's hardware, called through its reference `world`. If that is not wired, every action succeeds at
/// once.
#[derive(Debug, Default)]
pub(crate) struct HardwareClient {
    hardware: HardwareReference,
    wired: bool,
    entered: bool,
    /// True while the component behind the reference is not started, or has failed.
    absent: bool,
    /// True once it is out of service.
    retired: bool,
    /// True if the robot goes on after a failure, and does not know yet what the hardware did meanwhile.
    catching_up: bool,
    /// True if it does so in another program than that which began the running action. It stays so if the robot fails
    /// meanwhile: only who has caught up knows what became of that action.
    is_recalled: bool,
    /// True if this instance has asked a person what became of that, and what a person said.
    pub(crate) asks_a_person: bool,
    pub(crate) told: Option<Progress>,
    running: Option<Action>,
    patience: Patience,
    gauge: Gauge,
}

/// What outlives a failure of the robot.
#[derive(Clone, Copy, Debug, Field)]
pub(crate) struct HardwareMemory {
    entered: bool,
    retired: bool,
    running: Option<Action>,
    is_recalled: bool,
    told: Option<Progress>,
    measures: bool,
}

/// Result of a call to the hardware.
pub(crate) enum Reply<T> {
    /// The hardware answered.
    Answer(T),
    /// The hardware could not be reached now; a later call may succeed.
    Later,
}

impl HardwareClient {
    pub(crate) fn new(context: &mut Context<'_>) -> Result<HardwareClient, Failure> {
        let hardware: HardwareReference = context.reference("world")?;
        let wired = context.is_wired(&hardware);
        let is_recalled = context.goes_on_from_earlier_program();
        Ok(HardwareClient { hardware, wired, is_recalled, ..HardwareClient::default() })
    }

    pub(crate) fn memory(&self) -> HardwareMemory {
        let HardwareClient { entered, retired, running, is_recalled, told, .. } = *self;
        HardwareMemory { entered, retired, running, is_recalled, told, measures: self.gauge.measures() }
    }

    /// Goes on with hardware that did not stop meanwhile.
    pub(crate) fn restore(&mut self, memory: HardwareMemory) {
        (self.retired, self.running) = (memory.retired, memory.running);
        self.gauge = Gauge::of(memory.measures);
        self.entered = memory.entered;
        self.catching_up = self.wired && memory.entered && !memory.retired;
        self.is_recalled = self.catching_up && (self.is_recalled || memory.is_recalled);
        self.told = memory.told.filter(|_| self.is_recalled);
    }

    /// True if the robot goes on after a failure, and does not know yet what the hardware did meanwhile.
    pub(crate) fn is_catching_up(&self) -> bool {
        self.catching_up
    }

    /// True as long as the robot does not know what became of the action that an earlier program began.
    pub(crate) fn is_recalled(&self) -> bool {
        self.is_recalled
    }

    /// The robot knows what the hardware did meanwhile, and what it does now.
    pub(crate) fn caught_up(&mut self, running: Option<Action>) {
        (self.catching_up, self.is_recalled, self.running) = (false, false, running);
        self.asks_no_more();
    }

    /// What a person could say is not needed any more.
    pub(crate) fn asks_no_more(&mut self) {
        (self.asks_a_person, self.told) = (false, None);
    }

    /// What became of the action that an earlier program began; the outer `None` where there is none, the inner one
    /// where the hardware does not know.
    pub(crate) fn recall(
        &mut self,
        context: &mut Context<'_>,
        robot: u32,
    ) -> Result<Option<Reply<Option<Progress>>>, Failure> {
        let Some(action) = self.running.filter(|_| self.is_recalled) else { return Ok(None) };
        match self.hardware.recall(context, robot, action) {
            // Hardware of an earlier version has no such operation.
            Err(CallError::Mismatch { .. }) => Ok(Some(Reply::Answer(None))),
            answer => reply(answer).map(Some),
        }
    }

    /// Asks about whatever it may do.
    pub(crate) fn ask(&mut self, context: &mut Context<'_>, robot: u32) -> Result<Reply<Progress>, Failure> {
        let answer = self.hardware.poll(context, robot);
        self.absent = is_absent(&answer);
        self.patience.note(is_over(&answer), busy(&answer), context);
        reply(answer)
    }

    /// Asks where the robot is; nothing runs.
    pub(crate) fn locate(
        &mut self,
        context: &mut Context<'_>,
        robot: u32,
        name: &str,
        block: Block,
    ) -> Result<Reply<Block>, Failure> {
        reply(self.hardware.enter(context, robot, name.to_owned(), block))
    }

    /// Asks for the area.
    pub(crate) fn area(&mut self, context: &mut Context<'_>) -> Result<Reply<Map>, Failure> {
        let answer = self.hardware.area(context);
        self.absent = is_absent(&answer);
        // That the hardware is not started is told by others.
        self.patience.note(self.absent || answer.is_ok(), busy(&answer), context);
        let area = match reply(answer)? {
            Reply::Answer(area) => area,
            Reply::Later => return Ok(Reply::Later),
        };
        let map: Option<Map> = area.into();
        map.map(Reply::Answer).ok_or_else(|| Failure::new("the world's map does not match its width and height"))
    }

    /// The battery level that the hardware measures, in percent; `None` if it told none now.
    pub(crate) fn battery(&mut self, context: &mut Context<'_>, robot: u32) -> Result<Option<f64>, Failure> {
        if !self.wired || !self.has_entered() || self.retired {
            return Ok(None);
        }
        if !self.gauge.asks() {
            return Ok(None);
        }
        Ok(match reply(self.hardware.battery(context, robot))? {
            Reply::Answer(percent) => self.gauge.take_in(percent),
            // The last level counts.
            Reply::Later => None,
        })
    }

    /// True if the hardware measures the battery, so that the robot does not count.
    pub(crate) fn measures_battery(&self) -> bool {
        self.gauge.measures()
    }

    /// True if there is hardware.
    pub(crate) fn is_wired(&self) -> bool {
        self.wired
    }

    /// True if the robot is registered with the hardware.
    pub(crate) fn has_entered(&self) -> bool {
        self.entered && !self.catching_up
    }

    /// True if the robot waits for the component behind its reference to be started.
    pub(crate) fn is_absent(&self) -> bool {
        self.absent
    }

    /// True if the robot stands on the floor; without hardware it does not before it has entered.
    pub(crate) fn is_on_floor(&mut self, context: &mut Context<'_>, robot: u32) -> Result<Reply<bool>, Failure> {
        if !self.wired {
            return Ok(Reply::Answer(false));
        }
        let answer = self.hardware.is_on_floor(context, robot);
        self.absent = is_absent(&answer);
        self.patience.note(self.absent || answer.is_ok(), busy(&answer), context);
        reply(answer)
    }

    /// Registers the robot; the answer is its real position.
    pub(crate) fn enter(
        &mut self,
        context: &mut Context<'_>,
        robot: u32,
        name: &str,
        block: Block,
    ) -> Result<Reply<Block>, Failure> {
        if !self.wired {
            self.entered = true;
        }
        if self.entered {
            return Ok(Reply::Answer(block));
        }
        let answer = self.hardware.enter(context, robot, name.to_owned(), block);
        self.absent = is_absent(&answer);
        // That the hardware is not started is told by others.
        self.patience.note(self.absent || answer.is_ok(), busy(&answer), context);
        let block = match reply(answer)? {
            Reply::Answer(block) => block,
            Reply::Later => return Ok(Reply::Later),
        };
        self.entered = true;
        Ok(Reply::Answer(block))
    }

    /// The running action.
    pub(crate) fn running(&self) -> Option<Action> {
        self.running
    }

    /// True if the hardware is out of service.
    pub(crate) fn is_retired(&self) -> bool {
        self.retired
    }

    /// True if the gripper is working.
    pub(crate) fn is_handling(&self) -> bool {
        self.running.is_some_and(|action| action.kind != ActionKind::Move)
    }

    /// True if the hardware was busy at the last call.
    pub(crate) fn keeps_waiting(&self) -> bool {
        self.patience.waits() && self.running.is_none()
    }

    /// True if the robot is moving.
    pub(crate) fn is_moving(&self) -> bool {
        self.running.is_some_and(|action| action.kind == ActionKind::Move)
    }

    /// Starts an action.
    pub(crate) fn begin(
        &mut self,
        context: &mut Context<'_>,
        robot: u32,
        action: Action,
    ) -> Result<Reply<Progress>, Failure> {
        if !self.wired {
            return Ok(Reply::Answer(Progress::Done));
        }
        let answer = self.hardware.begin(context, robot, action);
        self.absent = is_absent(&answer);
        self.patience.note(is_over(&answer), busy(&answer), context);
        let progress = reply(answer)?;
        if matches!(progress, Reply::Answer(Progress::Running)) {
            self.running = Some(action);
        }
        Ok(progress)
    }

    /// Progress of the running action; done if none is running.
    pub(crate) fn poll(&mut self, context: &mut Context<'_>, robot: u32) -> Result<Reply<Progress>, Failure> {
        if self.running.is_none() {
            return Ok(Reply::Answer(Progress::Done));
        }
        if self.catching_up {
            return Ok(Reply::Later);
        }
        let progress = self.ask(context, robot)?;
        if matches!(progress, Reply::Answer(Progress::Done | Progress::Failed)) {
            self.running = None;
        }
        Ok(progress)
    }

    /// Takes the hardware out of service; the answer is the robot's position. `None` without hardware.
    pub(crate) fn retire(&mut self, context: &mut Context<'_>, robot: u32) -> Result<Reply<Option<Block>>, Failure> {
        reply(self.call_retire(context, robot))
    }

    /// The same at the end of the robot: hardware that is busy is a failure, and none is left to stop where it has
    /// ended before.
    pub(crate) fn leave(&mut self, context: &mut Context<'_>, robot: u32) -> Result<Option<Block>, Failure> {
        match self.call_retire(context, robot) {
            Err(CallError::NotRunning { .. }) => Ok(None),
            answer => Ok(answer?),
        }
    }

    fn call_retire(&mut self, context: &mut Context<'_>, robot: u32) -> Result<Option<Block>, CallError> {
        let block = if self.wired && self.entered {
            let answer = self.hardware.retire(context, robot);
            self.absent = is_absent(&answer);
            self.patience.note(busy(&answer).is_none(), busy(&answer), context);
            Some(answer?)
        } else {
            None
        };
        (self.running, self.retired) = (None, true);
        Ok(block)
    }
}

/// True if nothing is running after a call, whatever came of it.
fn is_over(answer: &Result<Progress, CallError>) -> bool {
    !matches!(answer, Ok(Progress::Running) | Err(CallError::Busy { .. }))
}

/// True if the component behind the reference is not started, or has failed.
fn is_absent<T>(answer: &Result<T, CallError>) -> bool {
    matches!(answer, Err(CallError::NotRunning { .. }))
}

/// The name of a component that was busy.
fn busy<T>(answer: &Result<T, CallError>) -> Option<&str> {
    match answer {
        Err(CallError::Busy { provider }) => Some(provider),
        _ => None,
    }
}

/// Hardware that is busy, or not started yet, is called again in the next period.
fn reply<T>(answer: Result<T, CallError>) -> Result<Reply<T>, Failure> {
    match answer {
        Ok(value) => Ok(Reply::Answer(value)),
        Err(CallError::Busy { .. } | CallError::NotRunning { .. }) => Ok(Reply::Later),
        Err(error) => Err(error.into()),
    }
}
