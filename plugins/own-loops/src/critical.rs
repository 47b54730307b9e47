//! In place of `CriticalSituationMS`, with either policy.

use saoms_api::{
    Cause, Context, Effector, Entry, Failure, Knowledge, Loop, LoopClass, Publisher, Subscription, record, warn,
};
use saoms_components::grid::Block;
use saoms_components::messages::{
    CRITICAL_SITUATION, CriticalKind, CriticalSituation, FAULT, Fault, ROBOT_LIST, RobotList,
};
use saoms_components::robot::{Job, Trouble};

use crate::step::{Decision, Step};

/// Asks for help when the robot breaks, and never helps another robot. The robot stops its hardware by itself once it
/// is `critical`.
#[derive(Debug, Default, LoopClass)]
#[looping(name = "own.Loner", effects("busy", "transporter", "healer", "asleep", "inCharge", "offersHelp"))]
pub struct Loner {
    #[subscribes(FAULT)]
    faults: Subscription<Fault>,
    #[publishes(CRITICAL_SITUATION)]
    situations: Publisher<CriticalSituation>,
    #[publishes(ROBOT_LIST)]
    robots: Publisher<RobotList>,
    broken_by: Option<Cause>,
    #[senses]
    number: Entry<u32>,
    #[senses]
    period: Entry<u64>,
    #[senses]
    block: Entry<Block>,
    #[senses]
    battery: Entry<f64>,
    #[senses]
    charge_block: Entry<Block>,
    #[effects]
    critical: Effector<bool>,
    #[effects]
    trouble: Effector<Option<Trouble>>,
    #[effects]
    job: Effector<Option<Job>>,
    #[effects]
    has_luggage: Effector<bool>,
    /// What a broken robot is not any more.
    rest: [Effector<bool>; 6],
    #[effects]
    stands_in_for: Effector<Option<u32>>,
}

const REST: [&str; 6] = ["busy", "transporter", "healer", "asleep", "inCharge", "offersHelp"];

/// What it can do.
#[derive(Debug)]
pub enum Act {
    /// Ask for help, and end.
    Break,
    /// Forget the robot that it was woken for.
    Forget,
}

impl Loop for Loner {
    type Properties = ();
    type Knowledge = dyn Knowledge;
    type Symptom = Step<Act>;
    type Decision = Decision<Act>;

    fn initialize(&mut self, robot: &mut dyn Knowledge, _: &mut Context<'_>) -> Result<(), Failure> {
        for (entry, name) in self.rest.iter_mut().zip(REST) {
            *entry = robot.effector(name)?;
        }
        Ok(())
    }

    fn monitor(&mut self, robot: &mut dyn Knowledge, context: &mut Context<'_>) -> Result<(), Failure> {
        let number = self.number.get(robot)?;
        let mut mine = context.receive(&self.faults).with_headers().filter(|(_, fault)| fault.breaks(number));
        if let Some((header, _)) = mine.next_back()
            && self.trouble.get(robot)?.is_none()
        {
            self.broken_by = Some(header.cause);
            self.trouble.set(robot, Some(Trouble::Breakdown))?;
        }
        Ok(())
    }

    fn analyze(&mut self, robot: &mut dyn Knowledge, context: &mut Context<'_>) -> Result<Option<Step<Act>>, Failure> {
        if self.critical.get(robot)? {
            return Ok(None);
        }
        if self.trouble.get(robot)?.is_some() {
            context.because(self.broken_by.unwrap_or_default());
            let why = record!(breaks_down: "breaks down at {block}", block = self.block.get(robot)?);
            return Ok(Some(Step::new(why, record!(calls_for_help: "asks for help"), Act::Break)));
        }
        let substituted = self.stands_in_for.get(robot)?;
        Ok(substituted.map(|robot| {
            let why = record!(called_to_stand_in: "is called to stand in for robot {robot}", robot);
            Step::new(why, record!(helps_nobody: "helps nobody"), Act::Forget)
        }))
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
        context: &mut Context<'_>,
    ) -> Result<(), Failure> {
        self.stands_in_for.set(robot, None)?;
        if matches!(decision.act, Act::Forget) {
            return Ok(());
        }
        let (number, block, job) = (self.number.get(robot)?, self.block.get(robot)?, self.job.get(robot)?);
        let kind = match job {
            Some(_) if self.has_luggage.get(robot)? => CriticalKind::CarriesLuggage,
            Some(_) => CriticalKind::OnTheWay,
            None => CriticalKind::Idle,
        };
        let Job { luggage, from, to } = job.unwrap_or(Job { luggage: 0, from: block, to: block });
        let critical = number;
        let situation = CriticalSituation { critical, block, luggage, from, to, kind, ..CriticalSituation::default() };
        context.send(&self.situations, situation)?;
        let (battery, charger) = (self.battery.get(robot)?, self.charge_block.get(robot)?);
        let period = self.period.get(robot)?;
        let last = RobotList { robot: number, active: false, battery, charger, period, block, ..RobotList::default() };
        context.send(&self.robots, last)?;
        context.count("assistance", 1);
        warn!(context, "breaks down at {block}: asks for help");
        self.job.set(robot, None)?;
        self.has_luggage.set(robot, false)?;
        for entry in &self.rest {
            entry.set(robot, false)?;
        }
        self.critical.set(robot, true)
    }
}
