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
#[looping(
    name = "own.classic.EarlyBattery",
    senses("battery", "charging", "inCharge", "healer", "block", "chargeBlock", "chargeAt"),
    effects("busy", "readyToGoUnderCharge")
)]
pub struct EarlyBattery {
    properties: EarlyBatteryProperties,
    battery: Entry<f64>,
    charging: Entry<bool>,
    in_charge: Entry<bool>,
    healer: Entry<bool>,
    block: Entry<Block>,
    charge_block: Entry<Block>,
    charge_at: Entry<f64>,
    busy: Effector<bool>,
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

    fn new(properties: EarlyBatteryProperties) -> Result<Self, Failure> {
        Ok(EarlyBattery {
            properties,
            battery: Entry::default(),
            charging: Entry::default(),
            in_charge: Entry::default(),
            healer: Entry::default(),
            block: Entry::default(),
            charge_block: Entry::default(),
            charge_at: Entry::default(),
            busy: Effector::default(),
            ready: Effector::default(),
        })
    }

    fn initialize(&mut self, robot: &mut dyn Knowledge, _: &mut Context<'_>) -> Result<(), Failure> {
        self.battery = robot.entry("battery")?;
        self.charging = robot.entry("charging")?;
        self.in_charge = robot.entry("inCharge")?;
        self.healer = robot.entry("healer")?;
        self.block = robot.entry("block")?;
        self.charge_block = robot.entry("chargeBlock")?;
        self.charge_at = robot.entry("chargeAt")?;
        self.busy = robot.effector("busy")?;
        self.ready = robot.effector("readyToGoUnderCharge")?;
        Ok(())
    }

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
