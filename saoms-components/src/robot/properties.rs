use saoms_api::host::SmolStr;
use saoms_api::{Failure, Field, Finding, Place, Properties, PropertyField};

use crate::grid::Block;
use crate::robot::Consumption;

/// Rules by which a robot acts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Field, PropertyField)]
pub enum Policy {
    /// Never enters a block that another robot holds, and never takes a job for which the battery does not last.
    #[default]
    Safe,
    /// The rules of the manual, for its transcripts: robots can collide and run out of battery.
    Classic,
}

/// Discharge in percent of an execution, unless a property says otherwise: the manual's.
const DISCHARGE: f64 = 2.0;

/// Properties of a robot.
#[derive(Clone, Debug, Properties)]
pub struct RobotProperties {
    /// Name of the robot.
    #[property(name = "ID", required_text, unique = "robot", speaker)]
    pub(crate) id: SmolStr,
    /// Number of the robot; by default the digits at the end of its ID. Between equal robots the lower number goes
    /// first.
    #[property(range = 1.., unique = "robot number", speaker)]
    pub(crate) number: Option<u32>,
    /// Column of the block with its charger, where it starts.
    #[property(default = 0, range = 0..)]
    pub(crate) charge_x: i32,
    /// Row of the block with its charger; by default the robot's number.
    #[property(range = 0..)]
    pub(crate) charge_y: Option<i32>,
    /// Column of the block where the robot starts; by default that of its charger.
    #[property(range = 0..)]
    pub(crate) start_x: Option<i32>,
    /// Row of the block where the robot starts; by default that of its charger.
    #[property(range = 0..)]
    pub(crate) start_y: Option<i32>,
    /// Battery level at the start.
    #[property(default = 100.0, range = 0.0..=100.0, unit = "%")]
    pub(crate) battery: f64,
    /// Discharge of the battery in an execution off the charger, as in the manual; while the robot charges, it gains
    /// five times as much. By default 2, unless the battery discharges by distance or time.
    #[property(range = 0.0..=100.0, unit = "% per execution")]
    pub(crate) discharge: Option<f64>,
    /// Discharge of the battery for a move to the next block, whatever the robot's period; with `chargePerSecond`.
    #[property(range = 0.0..=100.0, unit = "% per block")]
    pub(crate) discharge_per_block: Option<f64>,
    /// Discharge of the battery in a second off the charger, whatever the robot's period; with `chargePerSecond`.
    #[property(range = 0.0..=100.0, unit = "% per s")]
    pub(crate) discharge_per_second: Option<f64>,
    /// Gain of the battery in a second at the charger, where the battery discharges by distance or time.
    #[property(range = 0.001..=100.0, unit = "% per s")]
    pub(crate) charge_per_second: Option<f64>,
    /// True if the robot starts asleep at its charger and takes no jobs until it is woken.
    #[property(default = false)]
    pub(crate) asleep: bool,
    /// True if the robot is stopped: it keeps its block and its job, and gives no orders to its hardware. `saoms estop`
    /// sets it, and `saoms release` removes it.
    #[property(default = false, live)]
    pub(crate) stopped: bool,
    /// True if the robot is to leave the fleet: it finishes its job, goes to its charger and stays there asleep,
    /// whoever wakes it. A change of the fleet sets it for robots that it removes.
    #[property(default = false, live)]
    pub(crate) leaving: bool,
    /// Rules by which the robot acts: `safe`, which neither collides nor runs out of battery, or `classic`, the
    /// manual's.
    #[property(default = "safe")]
    pub(crate) policy: Policy,
}

impl RobotProperties {
    pub(crate) fn number(&self) -> Result<u32, Failure> {
        if let Some(number) = self.number {
            return Ok(number);
        }
        let id = self.id.trim();
        let digits = &id[id.trim_end_matches(|sign: char| sign.is_ascii_digit()).len()..];
        match digits.parse() {
            Ok(number @ 1..) => Ok(number),
            _ => {
                let message = "this robot has no number: give it `number`, or an ID that ends in 1 or more";
                Err(Finding::new(Place::property("ID"), message).into())
            }
        }
    }

    /// How the battery discharges and charges: by execution, or by distance and time.
    pub(crate) fn consumption(&self) -> Result<Consumption, Failure> {
        let finding = |property: &str, message: &str, help: &str| -> Result<Consumption, Failure> {
            Err(Finding::new(Place::property(property), message).help(help).into())
        };
        let physical = self.discharge_per_block.or(self.discharge_per_second);
        match (self.discharge, physical, self.charge_per_second) {
            (discharge, None, None) => Ok(Consumption::per_execution(discharge.unwrap_or(DISCHARGE))),
            (None, Some(_), Some(charge)) => {
                let [per_block, per_second] =
                    [self.discharge_per_block, self.discharge_per_second].map(Option::unwrap_or_default);
                Ok(Consumption::physical(per_block, per_second, charge))
            }
            (Some(_), _, _) => finding(
                "discharge",
                "the battery discharges per execution and also by distance or time",
                "remove `discharge`, or `dischargePerBlock`, `dischargePerSecond` and `chargePerSecond`",
            ),
            (None, Some(_), None) => finding(
                if self.discharge_per_block.is_some() { "dischargePerBlock" } else { "dischargePerSecond" },
                "the battery discharges by distance or time, but `chargePerSecond` is missing",
                "add `chargePerSecond`: with `2`, an empty battery is full after 50 s at the charger",
            ),
            (None, None, Some(_)) => finding(
                "chargePerSecond",
                "the battery discharges per execution, so it also charges per execution",
                "add `dischargePerBlock` or `dischargePerSecond`, or remove `chargePerSecond`",
            ),
        }
    }

    /// Block where the robot with this charger starts.
    pub(crate) fn start(&self, charger: Block) -> Block {
        Block::new(self.start_x.unwrap_or(charger.x), self.start_y.unwrap_or(charger.y))
    }

    /// A finding if the robot would start asleep where it cannot charge.
    pub(crate) fn check_sleep(&self, charger: Block) -> Result<(), Failure> {
        if !self.asleep || self.start(charger) == charger {
            return Ok(());
        }
        let property = if self.start_x.is_some() { "startX" } else { "startY" };
        let message = "this robot starts asleep, but not at its charger";
        let help = "remove `startX` and `startY`, or `asleep`: a robot that sleeps charges at its charger";
        Err(Finding::new(Place::property(property), message).help(help).into())
    }

    pub(crate) fn charge_block(&self, number: u32) -> Result<Block, Failure> {
        let row = self.charge_y.map_or_else(|| i32::try_from(number), Ok);
        row.map(|y| Block::new(self.charge_x, y))
            .map_err(|_| Failure::new(format!("no row has the number of robot {number}: give the robot a `chargeY`")))
    }
}
