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
#[looping(
    name = "own.FixedBattery",
    senses("battery", "charging", "block", "next", "chargeBlock", "asleep", "chargeAt", "trouble"),
    effects("mustCharge", "inCharge", "trouble")
)]
pub struct FixedBattery {
    properties: FixedBatteryProperties,
    battery: Entry<f64>,
    charging: Entry<bool>,
    block: Entry<Block>,
    next: Entry<Block>,
    charge_block: Entry<Block>,
    asleep: Entry<bool>,
    charge_at: Entry<f64>,
    must_charge: Effector<bool>,
    in_charge: Effector<bool>,
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

    fn new(properties: FixedBatteryProperties) -> Result<Self, Failure> {
        Ok(FixedBattery {
            properties,
            battery: Entry::default(),
            charging: Entry::default(),
            block: Entry::default(),
            next: Entry::default(),
            charge_block: Entry::default(),
            asleep: Entry::default(),
            charge_at: Entry::default(),
            must_charge: Effector::default(),
            in_charge: Effector::default(),
            trouble: Effector::default(),
        })
    }

    fn initialize(&mut self, robot: &mut dyn Knowledge, _: &mut Context<'_>) -> Result<(), Failure> {
        self.battery = robot.entry("battery")?;
        self.charging = robot.entry("charging")?;
        self.block = robot.entry("block")?;
        self.next = robot.entry("next")?;
        self.charge_block = robot.entry("chargeBlock")?;
        self.asleep = robot.entry("asleep")?;
        self.charge_at = robot.entry("chargeAt")?;
        self.must_charge = robot.effector("mustCharge")?;
        self.in_charge = robot.effector("inCharge")?;
        self.trouble = robot.effector("trouble")?;
        Ok(())
    }

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
