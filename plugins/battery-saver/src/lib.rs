//! A loop that changes the battery level at which a robot charges: listing 10.2 of the manual.
//!
//! Batteries last for years if they are never discharged deeply. A robot charges when its battery is as low as the way
//! to the charger allows. With this loop it learns from each time that this was too low, and charges earlier from then
//! on. The loop does not depend on robots: it reads and sets entries of any knowledge that has them.

use saoms_api::{Context, Effector, Entry, Failure, Knowledge, Loop, LoopClass, Own, Record, Recordable, record};

/// A loop that learns the battery level at which a robot has to charge, so that its battery is never discharged deeply.
#[derive(Debug, LoopClass)]
#[looping(name = "saver.BatterySaver")]
pub struct BatterySaver {
    /// Minimum battery level that the loop aims for.
    #[property(default = 40.0, range = 0.0..=100.0, unit = "%")]
    floor: f64,
    /// Step by which the robot charges earlier after a lower level, and later after a far higher level.
    #[property(default = 10.0, range = 1.0..=50.0, unit = "%")]
    step: f64,
    #[senses]
    battery: Entry<f64>,
    #[senses]
    in_charge: Entry<bool>,
    #[effects]
    charge_at: Effector<f64>,
    /// Lowest battery level since the last charge.
    #[entry(unit = "%", default = 100.0)]
    lowest: Effector<f64>,
    has_left: bool,
}

/// Observation when the robot starts to charge.
#[derive(Clone, Copy, Debug)]
pub enum Symptom {
    /// The battery was lower than it should be.
    Deep(f64),
    /// The battery was far higher.
    Shallow(f64),
}

/// Battery level in percent at which the robot charges from now on; 0 for the latest possible moment.
#[derive(Clone, Copy, Debug)]
pub struct ChargeAt(f64);

impl Recordable for Symptom {
    fn record(&self) -> Record {
        match *self {
            Symptom::Deep(lowest) => record!(charged_late: "battery was down to {lowest} %, which is too low", lowest),
            Symptom::Shallow(lowest) => {
                record!(charged_early: "battery was never below {lowest} %: it charges too early", lowest)
            }
        }
    }
}

impl Recordable for ChargeAt {
    fn record(&self) -> Record {
        let percent = self.0;
        record!(sets_threshold: "charges at {percent} % from now on", percent)
    }
}

impl Loop for BatterySaver {
    type Properties = Own<Self>;
    type Knowledge = dyn Knowledge;
    type Symptom = Symptom;
    type Decision = ChargeAt;

    /// Records the lowest battery level.
    fn monitor(&mut self, robot: &mut dyn Knowledge, _: &mut Context<'_>) -> Result<(), Failure> {
        if self.in_charge.get(robot)? {
            return Ok(());
        }
        let before = if self.has_left { self.lowest.get(robot)? } else { 100.0 };
        let lowest = before.min(self.battery.get(robot)?);
        self.has_left = true;
        self.lowest.set(robot, lowest)
    }

    /// Decides once, when the robot starts to charge, if that was too late, or far too early.
    fn analyze(&mut self, robot: &mut dyn Knowledge, _: &mut Context<'_>) -> Result<Option<Symptom>, Failure> {
        let in_charge = self.in_charge.get(robot)?;
        if !in_charge || !std::mem::replace(&mut self.has_left, false) {
            return Ok(None);
        }
        let (floor, step) = (self.floor, self.step);
        let (lowest, charges_early) = (self.lowest.get(robot)?, self.charge_at.get(robot)? > 0.0);
        Ok(if lowest < floor {
            Some(Symptom::Deep(lowest))
        } else {
            (charges_early && lowest > floor + 2.0 * step).then_some(Symptom::Shallow(lowest))
        })
    }

    /// Charges a step earlier, or later.
    fn plan(
        &mut self,
        symptom: Symptom,
        robot: &mut dyn Knowledge,
        _: &mut Context<'_>,
    ) -> Result<Option<ChargeAt>, Failure> {
        let (floor, step) = (self.floor, self.step);
        let now = self.charge_at.get(robot)?;
        Ok(Some(ChargeAt(match symptom {
            Symptom::Deep(_) => (now.max(floor) + step).min(100.0),
            Symptom::Shallow(_) => (now - step).max(0.0),
        })))
    }

    fn execute(&mut self, decision: ChargeAt, robot: &mut dyn Knowledge, _: &mut Context<'_>) -> Result<(), Failure> {
        self.charge_at.set(robot, decision.0)
    }
}

saoms_api::plugin! {
    loops: [BatterySaver],
}
