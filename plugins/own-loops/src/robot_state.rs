//! In place of `RobotMS`.

use saoms_api::{Context, Effector, Entry, Failure, Knowledge, Loop, LoopClass, Properties, Subscription, record};
use saoms_components::messages::{ROBOT_STATE, RobotState};
use saoms_components::robot::WaitingLuggage;

use crate::step::{Decision, Step};

/// What a composite can set.
#[derive(Debug, Properties)]
pub struct NapsProperties {
    /// Number of executions without work after which the robot sleeps.
    #[property(default = 20, range = 1.., unit = "executions")]
    after: u32,
}

/// Sleeps by itself when nothing is to be done, and wakes as soon as luggage waits, or when it is called.
#[derive(Debug, LoopClass)]
#[looping(name = "own.Naps", senses("busy", "transporter", "offersHelp", "critical"))]
pub struct Naps {
    #[properties]
    properties: NapsProperties,
    #[subscribes(ROBOT_STATE)]
    calls: Subscription<RobotState>,
    called: Option<RobotState>,
    idle: u32,
    #[senses]
    number: Entry<u32>,
    /// What it is kept awake by.
    works: [Entry<bool>; 4],
    #[senses]
    block: Entry<saoms_components::grid::Block>,
    #[senses]
    charge_block: Entry<saoms_components::grid::Block>,
    #[senses]
    requests: Entry<Vec<WaitingLuggage>>,
    #[effects]
    asleep: Effector<bool>,
    #[effects]
    relieved: Effector<bool>,
    #[effects]
    stands_in_for: Effector<Option<u32>>,
}

/// What it can do.
#[derive(Debug)]
pub enum Act {
    /// Wake, perhaps as the substitute of this robot.
    Wake(u32),
    /// Sleep.
    Sleep,
    /// Sleep after the job.
    Finish,
}

impl Loop for Naps {
    type Properties = NapsProperties;
    type Knowledge = dyn Knowledge;
    type Symptom = Step<Act>;
    type Decision = Decision<Act>;

    fn initialize(&mut self, robot: &mut dyn Knowledge, _: &mut Context<'_>) -> Result<(), Failure> {
        for (entry, name) in self.works.iter_mut().zip(["busy", "transporter", "offersHelp", "critical"]) {
            *entry = robot.entry(name)?;
        }
        Ok(())
    }

    fn monitor(&mut self, robot: &mut dyn Knowledge, context: &mut Context<'_>) -> Result<(), Failure> {
        let number = self.number.get(robot)?;
        let mut mine = context.receive(&self.calls).filter(|call| call.robot == number);
        self.called = mine.next_back().cloned().or(self.called.take());
        Ok(())
    }

    fn analyze(&mut self, robot: &mut dyn Knowledge, _: &mut Context<'_>) -> Result<Option<Step<Act>>, Failure> {
        let asleep = self.asleep.get(robot)?;
        let luggage = u32::try_from(self.requests.get(robot)?.len()).unwrap_or(u32::MAX);
        let mut works = luggage > 0;
        for entry in &self.works {
            works |= entry.get(robot)?;
        }
        self.idle = if works { 0 } else { self.idle + 1 };
        let wakes = record!(wakes: "wakes up");
        if let Some(call) = self.called.take() {
            let robot = call.emulate;
            return Ok(Some(match call.awake {
                true => Step::new(record!(called: "is called, for robot {robot}", robot), wakes, Act::Wake(robot)),
                false => Step::new(
                    record!(sent_to_sleep: "is sent to sleep"),
                    record!(sleeps_when_free: "sleeps after its job"),
                    Act::Finish,
                ),
            }));
        }
        if asleep {
            let waits = record!(pieces_wait: "{luggage} {luggage:piece waits|pieces wait}", luggage);
            return Ok((luggage > 0).then(|| Step::new(waits, wakes, Act::Wake(0))));
        }
        let is_home = self.block.get(robot)? == self.charge_block.get(robot)?;
        let sleeps = is_home && !works && (self.idle >= self.properties.after || self.relieved.get(robot)?);
        let idle = record!(has_nothing_to_do: "has nothing to do");
        Ok(sleeps.then(|| Step::new(idle, record!(sleeps: "sleeps"), Act::Sleep)))
    }

    fn plan(
        &mut self,
        step: Step<Act>,
        _: &mut dyn Knowledge,
        _: &mut Context<'_>,
    ) -> Result<Option<Decision<Act>>, Failure> {
        Ok(Some(step.decide()))
    }

    fn execute(
        &mut self,
        decision: Decision<Act>,
        robot: &mut dyn Knowledge,
        _: &mut Context<'_>,
    ) -> Result<(), Failure> {
        self.relieved.set(robot, matches!(decision.act, Act::Finish))?;
        match decision.act {
            Act::Wake(substitutes) => {
                self.stands_in_for.set(robot, Some(substitutes).filter(|substituted| *substituted > 0))?;
                self.asleep.set(robot, false)
            }
            Act::Sleep => self.asleep.set(robot, true),
            Act::Finish => Ok(()),
        }
    }
}
