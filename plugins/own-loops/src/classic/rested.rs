//! In place of `RobotMS`.

use saoms_api::{Context, Effector, Entry, Failure, Knowledge, Loop, LoopClass, Properties, Subscription, record};
use saoms_components::messages::{ROBOT_STATE, RobotState};

use crate::step::{Decision, Step};

/// What a composite can set.
#[derive(Debug, Properties)]
pub struct RestedProperties {
    /// Battery level that a call has to wait for.
    #[property(default = 100.0, range = 0.0..=100.0, unit = "%")]
    least: f64,
}

/// Wakes when it is called, but not before its battery is charged so far, and lets nobody send it to charge.
#[derive(Debug, LoopClass)]
#[looping(name = "own.classic.Rested", effects("readyToGoUnderCharge", "relieved"))]
pub struct Rested {
    #[properties]
    properties: RestedProperties,
    #[subscribes(ROBOT_STATE)]
    calls: Subscription<RobotState>,
    called: Option<u32>,
    #[senses]
    number: Entry<u32>,
    #[senses]
    battery: Entry<f64>,
    #[senses]
    healer: Entry<bool>,
    #[effects]
    in_charge: Effector<bool>,
    #[effects]
    asleep: Effector<bool>,
    #[effects]
    busy: Effector<bool>,
    #[effects]
    stands_in_for: Effector<Option<u32>>,
}

impl Loop for Rested {
    type Properties = RestedProperties;
    type Knowledge = dyn Knowledge;
    type Symptom = Step<u32>;
    type Decision = Decision<u32>;

    fn monitor(&mut self, robot: &mut dyn Knowledge, context: &mut Context<'_>) -> Result<(), Failure> {
        let number = self.number.get(robot)?;
        let mut calls = context.receive(&self.calls).filter(|call| call.robot == number && call.awake);
        self.called = calls.next_back().map(|call| call.emulate).or(self.called);
        Ok(())
    }

    fn analyze(&mut self, robot: &mut dyn Knowledge, _: &mut Context<'_>) -> Result<Option<Step<u32>>, Failure> {
        if !self.in_charge.get(robot)? {
            self.called = None;
        }
        let battery = self.battery.get(robot)?;
        let Some(substituted) = self.called.filter(|_| battery >= self.properties.least) else { return Ok(None) };
        self.called = None;
        let why = record!(called_and_rested: "is called, and its battery is at {battery} %", battery);
        Ok(Some(Step::new(why, record!(wakes: "wakes up"), substituted)))
    }

    fn plan(
        &mut self,
        step: Step<u32>,
        _: &mut dyn Knowledge,
        _: &mut Context<'_>,
    ) -> Result<Option<Decision<u32>>, Failure> {
        Ok(Some(step.decide()))
    }

    fn execute(
        &mut self,
        decision: Decision<u32>,
        robot: &mut dyn Knowledge,
        _: &mut Context<'_>,
    ) -> Result<(), Failure> {
        let busy = self.healer.get(robot)?;
        self.in_charge.set(robot, false)?;
        self.asleep.set(robot, false)?;
        self.busy.set(robot, busy)?;
        self.stands_in_for.set(robot, Some(decision.act).filter(|robot| *robot > 0))
    }
}
