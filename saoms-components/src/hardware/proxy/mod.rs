//! Hardware in another program, for robots that do not wait for it.

use std::collections::BTreeMap;

use saoms_api::CallError;
use saoms_api::Failure;
use saoms_api::extension::{CallLine, CallOutcome, CallProxy, RemoteProxy, submit};
use saoms_api::host::cdr::{self, Reader};
use saoms_api::host::{Arguments, Interface, Operation, ServiceCall};

use crate::grid::Block;
use crate::hardware::{Action, ActionKind, BEGIN, CANCEL, ENTER, Hardware, POLL, Progress, RETIRE};
submit! { RemoteProxy { interface: <dyn Hardware as Interface>::NAME, make: || Box::<HardwareProxy>::default() } }

/// Other operations by their places in the interface.
const AREA: Operation = 1;
const BATTERY: Operation = 6;

/// The proxy of hardware in another program.
///
/// A begun action runs until its hardware says that it has ended: what cannot be reached runs on. All other answers are
/// fresh ones, for which the robot asks again in its next period, but for the level of the battery: that is the newest
/// one. If the program of the hardware ends or begins anew, the running action has failed, and the robot is registered
/// with the next one.
#[derive(Default)]
struct HardwareProxy {
    /// The program with which the robots are registered.
    program: Option<u64>,
    robots: BTreeMap<u32, Robot>,
    /// Calls on their way whose answers somebody waits for, by operation and arguments.
    questions: BTreeMap<(Operation, Vec<u8>), u64>,
}

/// What is known of a robot.
#[derive(Default)]
struct Robot {
    /// Its name, and where it stands; `None` before it was registered.
    place: Option<(String, Block)>,
    action: Option<Running>,
    battery: Battery,
}

/// The last action.
struct Running {
    action: Action,
    stage: Stage,
}

#[derive(Clone, Copy)]
enum Stage {
    /// The call that began it is not answered.
    Begun(u64),
    /// The hardware has said that it runs; the call that asks again.
    Runs(Option<u64>),
    Over(Progress),
}

#[derive(Default)]
struct Battery {
    asked: Option<u64>,
    /// The newest answer, in CDR.
    newest: Option<Vec<u8>>,
}

impl CallProxy for HardwareProxy {
    fn call(&mut self, line: &mut dyn CallLine, call: &mut dyn ServiceCall) -> Result<(), CallError> {
        let (operation, arguments) = (call.operation(), call.arguments());
        let reply = match operation {
            ENTER => {
                let (robot, name, block): (u32, String, Block) = decoded(&arguments)?;
                let bytes = self.enter(line, robot, &name, block)?;
                self.robots.entry(robot).or_default().battery.newest = None;
                bytes
            }
            AREA => self.ask(line, AREA, arguments, None)?.1,
            BEGIN => {
                let (robot, action): (u32, Action) = decoded(&arguments)?;
                self.is_registered(line, robot)?;
                let begun = line.start(BEGIN, arguments, self.program);
                self.robots.entry(robot).or_default().action = Some(Running { action, stage: Stage::Begun(begun) });
                encoded(Progress::Running)
            }
            POLL => self.poll(line, decoded::<(u32,)>(&arguments)?.0)?,
            CANCEL => {
                let (robot,) = decoded(&arguments)?;
                line.start(CANCEL, arguments, self.program);
                self.robots.entry(robot).or_default().action = None;
                cdr::encode(&())
            }
            RETIRE => self.retire(line, decoded::<(u32,)>(&arguments)?.0)?,
            BATTERY => self.battery(line, decoded::<(u32,)>(&arguments)?.0)?,
            _ => {
                let (robot,) = decoded(&arguments)?;
                self.is_registered(line, robot)?;
                self.ask(line, operation, arguments, self.program)?.1
            }
        };
        call.reply(&reply)
    }
}

impl HardwareProxy {
    /// Registers a robot; its real place.
    fn enter(&mut self, line: &mut dyn CallLine, robot: u32, name: &str, block: Block) -> Result<Vec<u8>, CallError> {
        let arguments = arguments((robot, name.to_owned(), block));
        let (program, bytes) = self.ask(line, ENTER, arguments, None)?;
        self.program = Some(program);
        let place = cdr::decode(&bytes).map_err(mismatch)?;
        self.robots.entry(robot).or_default().place = Some((name.to_owned(), place));
        Ok(bytes)
    }

    /// Registers a robot with a program that has begun anew.
    fn is_registered(&mut self, line: &mut dyn CallLine, robot: u32) -> Result<(), CallError> {
        let place = self.robots.get(&robot).and_then(|known| known.place.clone());
        let Some((name, block)) = place.filter(|_| self.program.is_none()) else { return Ok(()) };
        let bytes = self.enter(line, robot, &name, block)?;
        let real: Block = cdr::decode(&bytes).map_err(mismatch)?;
        if real == block {
            return Ok(());
        }
        let failure =
            Failure::new(format!("its program began anew, and robot {robot} is at {real} rather than {block}"));
        Err(CallError::Failed { provider: line.provider().to_owned(), failure })
    }

    /// The answer to a fresh question, with the program that gave it.
    fn ask(
        &mut self,
        line: &mut dyn CallLine,
        operation: Operation,
        arguments: Vec<u8>,
        program: Option<u64>,
    ) -> Result<(u64, Vec<u8>), CallError> {
        let busy = CallError::Busy { provider: line.provider().to_owned() };
        let key = (operation, arguments);
        let Some(asked) = self.questions.get(&key).copied() else {
            let asked = line.start(operation, key.1.clone(), program);
            self.questions.insert(key, asked);
            return Err(busy);
        };
        let Some(outcome) = line.outcome(asked) else { return Err(busy) };
        self.questions.remove(&key);
        match outcome {
            CallOutcome::Reply { program, bytes } => Ok((program, bytes)),
            CallOutcome::Refused(error) => Err(error),
            CallOutcome::Gone => {
                self.lose();
                Err(busy)
            }
            CallOutcome::Stopped => Err(busy),
        }
    }

    /// The program of the hardware has ended, and what it ran.
    fn lose(&mut self) {
        self.program = None;
        for action in self.robots.values_mut().filter_map(|robot| robot.action.as_mut()) {
            if !matches!(action.stage, Stage::Over(_)) {
                action.stage = Stage::Over(Progress::Failed);
            }
        }
    }

    /// Progress of the last action, as far as it is known.
    fn poll(&mut self, line: &mut dyn CallLine, robot: u32) -> Result<Vec<u8>, CallError> {
        let running = self.robots.get(&robot).and_then(|known| known.action.as_ref());
        let Some(Running { action, stage }) = running else {
            self.is_registered(line, robot)?;
            return self.ask(line, POLL, arguments((robot,)), self.program).map(|(_, bytes)| bytes);
        };
        let (action, stage) = (*action, *stage);
        let outcome = match stage {
            Stage::Begun(call) | Stage::Runs(Some(call)) => line.outcome(call),
            Stage::Runs(None) => None,
            Stage::Over(progress) => return Ok(encoded(progress)),
        };
        let next = match (outcome, stage) {
            (Some(CallOutcome::Reply { bytes, .. }), _) => match cdr::decode(&bytes).map_err(mismatch)? {
                Progress::Running => Stage::Runs(None),
                progress => Stage::Over(progress),
            },
            // It did not begin.
            (Some(CallOutcome::Refused(CallError::NotRunning { .. } | CallError::Busy { .. })), Stage::Begun(_)) => {
                Stage::Begun(line.start(BEGIN, arguments((robot, action)), self.program))
            }
            (Some(CallOutcome::Refused(CallError::NotRunning { .. } | CallError::Busy { .. })), _) => Stage::Runs(None),
            (Some(CallOutcome::Refused(error)), _) => {
                self.robots.entry(robot).or_default().action = None;
                return Err(error);
            }
            (Some(CallOutcome::Gone), _) => {
                self.lose();
                Stage::Over(Progress::Failed)
            }
            (Some(CallOutcome::Stopped), _) => Stage::Over(Progress::Failed),
            (None, stage) => stage,
        };
        let next = match next {
            Stage::Runs(None) => Stage::Runs(Some(line.start(POLL, arguments((robot,)), self.program))),
            next => next,
        };
        let known = self.robots.entry(robot).or_default();
        known.action = Some(Running { action, stage: next });
        if let (Stage::Over(Progress::Done), ActionKind::Move, Some((_, place))) =
            (next, action.kind, known.place.as_mut())
        {
            *place = action.block;
        }
        Ok(encoded(match next {
            Stage::Over(progress) => progress,
            Stage::Begun(_) | Stage::Runs(_) => Progress::Running,
        }))
    }

    /// Takes a robot out of service. At the end of its own program it is not waited for: the hardware hears of it, and
    /// the robot stays where it is known to be.
    fn retire(&mut self, line: &mut dyn CallLine, robot: u32) -> Result<Vec<u8>, CallError> {
        if line.is_ending() {
            let place = self.robots.get(&robot).and_then(|known| known.place.as_ref());
            let Some((_, place)) = place.filter(|_| self.program.is_some()) else {
                return Err(CallError::NotRunning { provider: line.provider().to_owned() });
            };
            line.start(RETIRE, arguments((robot,)), self.program);
            return Ok(cdr::encode(place));
        }
        self.is_registered(line, robot)?;
        let bytes = self.ask(line, RETIRE, arguments((robot,)), self.program)?.1;
        self.robots.entry(robot).or_default().action = None;
        Ok(bytes)
    }

    /// The newest level of the battery.
    fn battery(&mut self, line: &mut dyn CallLine, robot: u32) -> Result<Vec<u8>, CallError> {
        self.is_registered(line, robot)?;
        let known = self.robots.entry(robot).or_default();
        let outcome = known.battery.asked.and_then(|asked| line.outcome(asked));
        let is_answered = outcome.is_some();
        if is_answered || known.battery.asked.is_none() {
            known.battery.asked = Some(line.start(BATTERY, arguments((robot,)), self.program));
        }
        match outcome {
            Some(CallOutcome::Reply { bytes, .. }) => known.battery.newest = Some(bytes),
            Some(CallOutcome::Refused(error @ (CallError::Failed { .. } | CallError::Mismatch { .. }))) => {
                return Err(error);
            }
            Some(CallOutcome::Gone) => self.lose(),
            Some(CallOutcome::Refused(_) | CallOutcome::Stopped) | None => {}
        }
        let newest = self.robots.get(&robot).and_then(|known| known.battery.newest.clone());
        newest.ok_or_else(|| CallError::Busy { provider: line.provider().to_owned() })
    }
}

fn encoded(progress: Progress) -> Vec<u8> {
    cdr::encode(&progress)
}

fn arguments<A: Arguments>(all: A) -> Vec<u8> {
    let mut writer = cdr::Writer::new();
    all.write(&mut writer);
    writer.into_bytes()
}

fn decoded<A: Arguments>(bytes: &[u8]) -> Result<A, CallError> {
    let mut reader = Reader::new(bytes).map_err(mismatch)?;
    let all = A::read(&mut reader).map_err(mismatch)?;
    reader.finish().map_err(mismatch)?;
    Ok(all)
}

fn mismatch(error: impl std::fmt::Display) -> CallError {
    CallError::Mismatch { message: error.to_string() }
}

#[cfg(test)]
mod tests;
