//! In place of `RobotListMS`, with either policy.

use saoms_api::{Context, Entry, Failure, Knowledge, Loop, LoopClass, Properties, Publisher, record};
use saoms_components::grid::Block;
use saoms_components::messages::{ROBOT_LIST, RobotList};

use crate::step::{Decision, Step};

/// What a composite can set.
#[derive(Debug, Properties)]
pub struct AnnouncerProperties {
    /// Change of the battery level after which the robot announces itself again.
    #[property(default = 20.0, range = 0.0..=100.0, unit = "%")]
    step: f64,
}

/// Announces the robot only when something changed that others have to know, or its battery by much.
#[derive(Debug, LoopClass)]
#[looping(name = "own.Announcer", senses("robots"))]
pub struct Announcer {
    #[properties]
    properties: AnnouncerProperties,
    said: Option<RobotList>,
    #[publishes(ROBOT_LIST)]
    robots: Publisher<RobotList>,
    #[senses]
    number: Entry<u32>,
    #[senses]
    period: Entry<u64>,
    #[senses]
    battery: Entry<f64>,
    #[senses]
    in_charge: Entry<bool>,
    #[senses]
    asleep: Entry<bool>,
    #[senses]
    critical: Entry<bool>,
    #[senses]
    charge_block: Entry<Block>,
    #[senses]
    block: Entry<Block>,
}

impl Announcer {
    fn now(&self, robot: &dyn Knowledge) -> Result<RobotList, Failure> {
        Ok(RobotList {
            robot: self.number.get(robot)?,
            active: !self.critical.get(robot)?,
            battery: self.battery.get(robot)?,
            in_charge: self.in_charge.get(robot)?,
            asleep: self.asleep.get(robot)?,
            charger: self.charge_block.get(robot)?,
            period: self.period.get(robot)?,
            block: self.block.get(robot)?,
            ..RobotList::default()
        })
    }
}

impl Loop for Announcer {
    type Properties = AnnouncerProperties;
    type Knowledge = dyn Knowledge;
    type Symptom = Step<RobotList>;
    type Decision = Decision<RobotList>;

    fn analyze(&mut self, robot: &mut dyn Knowledge, _: &mut Context<'_>) -> Result<Option<Step<RobotList>>, Failure> {
        let now = self.now(robot)?;
        let is_news = self.said.as_ref().is_none_or(|said| {
            let battery =
                if (now.battery - said.battery).abs() < self.properties.step { said.battery } else { now.battery };
            RobotList { battery, block: said.block, ..now.clone() } != *said
        });
        let why = record!(battery_level: "battery is at {battery} %", battery = now.battery);
        Ok(is_news.then(|| Step::new(why, record!(announces_state: "announces its state"), now)))
    }

    fn plan(
        &mut self,
        step: Step<RobotList>,
        _: &mut dyn Knowledge,
        _: &mut Context<'_>,
    ) -> Result<Option<Decision<RobotList>>, Failure> {
        Ok(Some(step.decide()))
    }

    fn execute(
        &mut self,
        decision: Decision<RobotList>,
        _: &mut dyn Knowledge,
        context: &mut Context<'_>,
    ) -> Result<(), Failure> {
        self.said = Some(decision.act.clone());
        context.send(&self.robots, decision.act)
    }

    fn shutdown(&mut self, robot: &mut dyn Knowledge, context: &mut Context<'_>) -> Result<(), Failure> {
        let last = RobotList { active: false, ..self.now(robot)? };
        context.send(&self.robots, last)
    }
}
