pub(in crate::robot) mod gain;

use std::fmt;
use std::time::Duration;

/// A robot's battery.
///
/// It counts in billionths of a percent, so that many small discharges add up exactly.
///
/// ```
/// use std::time::Duration;
///
/// use saoms_components::robot::{Battery, Consumption};
///
/// // As in the manual: 2 % in each execution, whatever its period.
/// let period = Duration::from_secs(1);
/// let mut battery = Battery::new(100.0, Consumption::per_execution(2.0));
/// battery.drain(period);
/// assert_eq!((battery.percent(), battery.executions_left(period, 1)), (98.0, 49));
/// assert_eq!(battery.to_string(), "98.0");
///
/// // 0.5 % for a block and 0.1 % a second; charging gains 4 % a second.
/// let mut battery = Battery::new(100.0, Consumption::physical(0.5, 0.1, 4.0));
/// battery.drive();
/// battery.drain(period);
/// assert_eq!(battery.percent(), 99.4);
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Battery {
    level: u64,
    consumption: Consumption,
}

/// Consumption and gain of a battery, in billionths of a percent.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Consumption {
    /// The manual's rule: by executions off the charger. An execution at the charger gains five times as much.
    PerExecution {
        /// Discharge of an execution.
        discharge: u64,
    },
    /// By distance and time, whatever the period of the robot.
    Physical {
        /// Discharge of a move to the next block.
        per_block: u64,
        /// Discharge of a second off the charger.
        per_second: u64,
        /// Gain of a second at the charger.
        charge_per_second: u64,
    },
}

/// 1 %.
const PERCENT: u64 = 1_000_000_000;

/// 100 %.
const FULL: u64 = 100 * PERCENT;

/// Charge of one execution, as a multiple of its discharge.
const CHARGE_FACTOR: u64 = 5;

const NANOSECONDS: u128 = 1_000_000_000;

impl Consumption {
    /// Consumption in percent of an execution; values outside 0 to 100 are clamped.
    pub fn per_execution(discharge: f64) -> Consumption {
        Consumption::PerExecution { discharge: level(discharge) }
    }

    /// Consumption in percent of a block and a second off the charger, and gain in percent of a second at the charger;
    /// values outside 0 to 100 are clamped.
    pub fn physical(per_block: f64, per_second: f64, charge_per_second: f64) -> Consumption {
        let [per_block, per_second, charge_per_second] = [per_block, per_second, charge_per_second].map(level);
        Consumption::Physical { per_block, per_second, charge_per_second }
    }

    /// Discharge of an execution of a robot that drives without a stop, where one starts every `period` and a move
    /// takes `moving` of them.
    fn driving(&self, period: Duration, moving: u32) -> u64 {
        match *self {
            Consumption::PerExecution { discharge } => discharge,
            Consumption::Physical { per_block, per_second, .. } => {
                during(per_second, period).saturating_add(per_block.div_ceil(u64::from(moving.max(1))))
            }
        }
    }

    /// Gain of an execution at the charger.
    fn charging(&self, period: Duration) -> u64 {
        match *self {
            Consumption::PerExecution { discharge } => discharge.saturating_mul(CHARGE_FACTOR),
            Consumption::Physical { charge_per_second, .. } => during(charge_per_second, period),
        }
    }

    /// Gain of an execution at the charger as a multiple of the discharge of an execution of a driving robot; `None`
    /// for a robot without discharge.
    pub(crate) fn charge_factor(&self, period: Duration, moving: u32) -> Option<f64> {
        #[expect(clippy::cast_precision_loss, reason = "an estimate")]
        match (self.charging(period) as f64, self.driving(period, moving)) {
            (_, 0) => None,
            (charging, driving) => Some(charging / driving as f64),
        }
    }

    fn is_none(&self) -> bool {
        matches!(
            self,
            Consumption::PerExecution { discharge: 0 } | Consumption::Physical { per_block: 0, per_second: 0, .. }
        )
    }
}

impl Battery {
    /// A battery with this level in percent, which is clamped to 0 to 100.
    pub fn new(percent: f64, consumption: Consumption) -> Battery {
        Battery { level: level(percent), consumption }
    }

    /// Level in percent.
    #[expect(clippy::cast_precision_loss, reason = "at most 100 billion")]
    pub fn percent(&self) -> f64 {
        self.level as f64 / PERCENT as f64
    }

    /// Sets the level, in percent.
    pub fn set_percent(&mut self, percent: f64) {
        self.level = level(percent);
    }

    /// Discharges the battery by an execution off the charger, at this time after the last one.
    pub fn drain(&mut self, elapsed: Duration) {
        let discharge = match self.consumption {
            Consumption::PerExecution { discharge } => discharge,
            Consumption::Physical { per_second, .. } => during(per_second, elapsed),
        };
        self.level = self.level.saturating_sub(discharge);
    }

    /// True if each execution off the charger discharges it.
    pub(super) fn drains_by_execution(&self) -> bool {
        matches!(self.consumption, Consumption::PerExecution { .. })
    }

    /// Discharges the battery by a move to the next block.
    pub fn drive(&mut self) {
        if let Consumption::Physical { per_block, .. } = self.consumption {
            self.level = self.level.saturating_sub(per_block);
        }
    }

    /// Charges the battery by an execution at the charger, at this time after the last one.
    pub fn charge(&mut self, elapsed: Duration) {
        self.level = self.level.saturating_add(self.consumption.charging(elapsed)).min(FULL);
    }

    /// True if the battery is full. A battery without discharge always is.
    pub fn is_full(&self) -> bool {
        self.level == FULL || self.consumption.is_none()
    }

    /// True if the battery is empty.
    pub fn is_empty(&self) -> bool {
        self.level == 0 && !self.consumption.is_none()
    }

    /// True if at most `percent` percent are left.
    pub fn is_at_most(&self, percent: u32) -> bool {
        self.level <= u64::from(percent).saturating_mul(PERCENT)
    }

    /// Number of executions that the battery lasts while the robot drives, where one starts every `period` and a move
    /// takes `moving` of them; `u32::MAX` without discharge.
    pub fn executions_left(&self, period: Duration, moving: u32) -> u32 {
        self.lasts(self.level, period, moving)
    }

    /// The same for a full battery.
    pub fn executions_when_full(&self, period: Duration, moving: u32) -> u32 {
        self.lasts(FULL, period, moving)
    }

    /// Number of executions of a driving robot that discharge the battery as much as so many of one that stands.
    pub(super) fn as_driving(&self, executions: u32, period: Duration, moving: u32) -> u32 {
        let Consumption::Physical { per_second, .. } = self.consumption else { return executions };
        let needs = during(per_second, period).saturating_mul(u64::from(executions));
        let driving = self.consumption.driving(period, moving).max(1);
        u32::try_from(needs.div_ceil(driving)).unwrap_or(u32::MAX)
    }

    fn lasts(&self, level: u64, period: Duration, moving: u32) -> u32 {
        let executions = level.checked_div(self.consumption.driving(period, moving));
        executions.and_then(|executions| u32::try_from(executions).ok()).unwrap_or(u32::MAX)
    }
}

/// Part of a rate per second in some time.
fn during(per_second: u64, time: Duration) -> u64 {
    u64::try_from(u128::from(per_second).saturating_mul(time.as_nanos()) / NANOSECONDS).unwrap_or(u64::MAX)
}

/// Percent as a level.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "cut to 0..=100 before")]
#[expect(clippy::cast_precision_loss, reason = "a power of ten")]
fn level(percent: f64) -> u64 {
    (percent.clamp(0.0, 100.0) * PERCENT as f64).round() as u64
}

impl fmt::Display for Battery {
    /// Format with one decimal, as on the console of the manual's figures.
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{:.1}", self.percent())
    }
}
