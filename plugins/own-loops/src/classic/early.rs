//! In place of `BatteryMS`.

use saoms_api::{Context, Effector, Entry, Failure, Knowledge, Loop, LoopClass, Properties, record};
use saoms_components::grid::Block;

use crate::step::{Decision, Step};

/// What a composite can set.
#[derive(Debug, Properties)]
pub struct EarlyBatteryProperties {
    /// Battery level at which the robot charges after its job; 35 in the manual.
    #[property(default = 60.0, range = 0.0..=100.0, unit = "%")]
    low: f64,
}

/// Sends the robot to charge at another level than the manual's, and lets it sleep when the battery is full.
#[derive(Debug, LoopClass)]
#[looping(name = "own.classic.EarlyBattery")]
pub struct EarlyBattery {
    #[properties]
    properties: EarlyBatteryProperties,
    #[senses]
    battery: Entry<f64>,
    #[senses]
    charging: Entry<bool>,
    #[senses]
    in_charge: Entry<bool>,
    #[senses]
    healer: Entry<bool>,
    #[senses]
    block: Entry<Block>,
    #[senses]
    charge_block: Entry<Block>,
    #[senses]
    charge_at: Entry<f64>,
    #[effects]
    busy: Effector<bool>,
    #[effects("readyToGoUnderCharge")]
    ready: Effector<bool>,
}

/// What it can do.
#[derive(Debug)]
pub enum Act {
    /// Charge after the job.
    Charge,
    /// Be busy with charging, or not any more.
    BeBusy(bool),
}

impl Loop for EarlyBattery {
    type Properties = EarlyBatteryProperties;
    type Knowledge = dyn Knowledge;
    type Symptom = Step<Act>;
    type Decision = Decision<Act>;

    fn analyze(&mut self, robot: &mut dyn Knowledge, _: &mut Context<'_>) -> Result<Option<Step<Act>>, Failure> {
        let (battery, healer) = (self.battery.get(robot)?, self.healer.get(robot)?);
        if self.in_charge.get(robot)? {
            let (charging, busy) = (self.charging.get(robot)?, self.busy.get(robot)?);
            let why = record!(battery_level: "battery is at {battery} %", battery);
            let what = if charging {
                record!(charges: "charges")
            } else {
                record!(waits_to_be_woken: "sleeps until it is woken")
            };
            let acts = if charging { !busy } else { busy && !healer };
            return Ok(acts.then(|| Step::new(why, what, Act::BeBusy(charging))));
        }
        let level = self.properties.low.max(self.charge_at.get(robot)?);
        let is_away = self.block.get(robot)? != self.charge_block.get(robot)?;
        let is_news = is_away && !self.ready.get(robot)? && !healer;
        let why = record!(low_battery: "battery is low: {battery} %", battery);
        let charges = record!(charges_after_job: "goes to charge after its job");
        Ok((is_news && battery <= level).then(|| Step::new(why, charges, Act::Charge)))
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
        match decision.act {
            Act::Charge => self.ready.set(robot, true),
            Act::BeBusy(busy) => self.busy.set(robot, busy),
        }
    }
}
