//! Faults of robots and chargers that are none of their own doing: what scenarios and people put into a run, to see how
//! the fleet copes.

use std::time::Duration;

use saoms_api::{Message, Time, Topic, builtin_interfaces};

use crate::grid::{Block, Map};
use crate::validation::{MessageValidator, Problem, Sender, Validate, of_robot};

/// The greatest factor of a fault: a robot that is slower stands still, and a battery that drains faster is empty.
pub(crate) const MOST_FACTOR: f64 = 1000.0;

/// Robots that become slow.
///
/// Published by scenarios and from outside; read by the world.
pub const SLOW: Topic<Slow> = Topic::event("SLOWTOPIC");

/// A robot whose actions take longer.
#[derive(Clone, Debug, PartialEq, Message)]
pub struct Slow {
    /// Number of the robot.
    pub robot: u32,
    /// How many times as long a move, collecting and depositing take, from 1 to 1000. What is over within a period of
    /// the robot otherwise takes so many periods.
    pub factor: f64,
    /// How long the robot is slow; without it, to the end of the run.
    pub lasting: Option<builtin_interfaces::Duration>,
}

/// Batteries that lose charge.
///
/// Published by scenarios and from outside; read by robots and the world.
pub const DRAIN: Topic<Drain> = Topic::event("DRAINTOPIC");

/// A robot whose battery loses charge, at once or in what the robot does.
#[derive(Clone, Debug, PartialEq, Message)]
pub struct Drain {
    /// Number of the robot.
    pub robot: u32,
    /// What the battery loses at once, in percent of a full one.
    pub percent: Option<f64>,
    /// How many times as much everything takes that discharges it, from 1 to 1000.
    pub factor: Option<f64>,
    /// How long that takes more; without it, to the end of the run.
    pub lasting: Option<builtin_interfaces::Duration>,
}

/// Chargers that give nothing.
///
/// Published by scenarios and from outside; read by robots and the world.
pub const OUTAGE: Topic<Outage> = Topic::event("OUTAGETOPIC");

/// A charger that gives nothing. Robots are not told: they notice that their battery gains nothing there.
#[derive(Clone, Debug, PartialEq, Message)]
pub struct Outage {
    /// Block of the charger.
    pub charger: Block,
    /// How long it gives nothing; without it, to the end of the run.
    pub lasting: Option<builtin_interfaces::Duration>,
}

/// The end of something that begins at a time; `None` is never.
pub(crate) fn end_of(began: Time, lasting: Option<&builtin_interfaces::Duration>) -> Option<Time> {
    let time = lasting.map(|time| match u64::try_from(time.sec) {
        Ok(seconds) => Duration::new(seconds, 0).saturating_add(Duration::from_nanos(time.nanosec.into())),
        Err(_) => Duration::ZERO,
    });
    time.map(|time| began + time)
}

impl Validate for Slow {
    const WHAT: &'static str = "that it is slow";

    fn about(&self) -> String {
        of_robot(self.robot)
    }

    fn validate(
        &self,
        _sender: Sender<'_>,
        validator: &mut MessageValidator,
        _area: Option<&Map>,
    ) -> Result<(), Problem> {
        Problem::of_factor(self.factor)?;
        validator.check_known(self.robot)
    }
}

impl Validate for Drain {
    const WHAT: &'static str = "the drained battery";

    fn about(&self) -> String {
        of_robot(self.robot)
    }

    fn validate(
        &self,
        _sender: Sender<'_>,
        validator: &mut MessageValidator,
        _area: Option<&Map>,
    ) -> Result<(), Problem> {
        if let Some(percent) = self.percent.filter(|percent| !(0.0..=100.0).contains(percent)) {
            return Err(Problem::Battery { percent });
        }
        self.factor.map_or(Ok(()), Problem::of_factor)?;
        validator.check_known(self.robot)
    }
}

impl Validate for Outage {
    const WHAT: &'static str = "the outage";

    fn about(&self) -> String {
        format!("the charger at {}", self.charger)
    }

    fn validate(
        &self,
        _sender: Sender<'_>,
        _validator: &mut MessageValidator,
        area: Option<&Map>,
    ) -> Result<(), Problem> {
        Problem::of_free(self.charger, area)
    }
}
