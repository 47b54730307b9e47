//! In place of `BatteryMS`.

use saoms_api::{Context, Effector, Entry, Failure, Knowledge, Loop, LoopClass, Properties, record};
use saoms_components::grid::Block;
use saoms_components::robot::Trouble;

use crate::step::{Decision, Step};

/// What a composite can set.
#[derive(Debug, Properties)]
pub struct FixedBatteryProperties {
    /// Battery level at which the robot goes to its charger, wherever it is.
    #[property(default = 60.0, range = 1.0..=100.0, unit = "%")]
    level: f64,
}

/// Goes to the charger at a fixed battery level, in spite of the job, and stays there until the battery is full.
#[derive(Debug, LoopClass)]
#[looping(name = "own.FixedBattery", senses("trouble"))]
pub struct FixedBattery {
    #[properties]
    properties: FixedBatteryProperties,
    #[senses]
    battery: Entry<f64>,
    #[senses]
    charging: Entry<bool>,
    #[senses]
    block: Entry<Block>,
    #[senses]
    next: Entry<Block>,
    #[senses]
    charge_block: Entry<Block>,
    #[senses]
    asleep: Entry<bool>,
    #[senses]
    charge_at: Entry<f64>,
    #[effects]
    must_charge: Effector<bool>,
    #[effects]
    in_charge: Effector<bool>,
    #[effects]
    trouble: Effector<Option<Trouble>>,
}

/// What it can do.
#[derive(Debug)]
pub enum Act {
    /// Go to the charger.
    Return,
    /// Leave it.
    Leave,
    /// Start or end charging.
    Charge(bool),
    /// Stop for good.
    Stop,
}

impl Loop for FixedBattery {
    type Properties = FixedBatteryProperties;
    type Knowledge = dyn Knowledge;
    type Symptom = Step<Act>;
    type Decision = Decision<Act>;

    fn analyze(&mut self, robot: &mut dyn Knowledge, _: &mut Context<'_>) -> Result<Option<Step<Act>>, Failure> {
        let (battery, charging, charger) =
            (self.battery.get(robot)?, self.charging.get(robot)?, self.charge_block.get(robot)?);
        let must_charge = self.must_charge.get(robot)?;
        let is_there = self.block.get(robot)? == charger && self.next.get(robot)? == charger;
        let charges = is_there && (charging || self.asleep.get(robot)?);
        if charges != self.in_charge.get(robot)? {
            let what = if charges { record!(charges: "charges") } else { record!(charges_no_more: "charges no more") };
            let why = record!(battery_level: "battery is at {battery} %", battery);
            return Ok(Some(Step::new(why, what, Act::Charge(charges))));
        }
        if is_there {
            let why = record!(battery_full: "battery is full");
            let leaves = record!(leaves_charger_when_full: "leaves its charger");
            return Ok((must_charge && battery >= 100.0).then(|| Step::new(why, leaves, Act::Leave)));
        }
        if battery <= 0.0 {
            let why = record!(battery_empty: "battery is empty");
            let stops = record!(stops_with_empty_battery: "stops where it is");
            return Ok(self.trouble.get(robot)?.is_none().then(|| Step::new(why, stops, Act::Stop)));
        }
        let level = self.properties.level.max(self.charge_at.get(robot)?);
        let why = record!(battery_below_level: "battery is at {battery} %, which is {level} % or less", battery, level);
        let goes = record!(goes_to_charge: "goes to charge");
        Ok((!must_charge && battery <= level).then(|| Step::new(why, goes, Act::Return)))
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
            Act::Return => self.must_charge.set(robot, true),
            Act::Leave => self.must_charge.set(robot, false),
            Act::Charge(charges) => self.in_charge.set(robot, charges),
            Act::Stop => self.trouble.set(robot, Some(Trouble::Battery)),
        }
    }
}
