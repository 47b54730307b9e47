use std::fmt;

/// A robot's battery.
///
/// It counts thousandths of a percent, so that many small discharges add up exactly.
///
/// ```
/// use saoms_components::robot::Battery;
///
/// let mut battery = Battery::new(100.0, 2.0);
/// battery.drain();
/// assert_eq!((battery.percent(), battery.executions_left()), (98.0, 49));
/// assert_eq!(battery.to_string(), "98.0");
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Battery {
    level: u32,
    discharge: u32,
}

/// 100 %.
const FULL: u32 = 100_000;

/// In charge a battery gains so many times what an execution takes.
const CHARGE_FACTOR: u32 = 5;

impl Battery {
    /// A battery at this level that loses `discharge` with each execution, both in percent; values beyond 0 to 100 are cut.
    pub fn new(percent: f64, discharge: f64) -> Battery {
        Battery { level: thousandths(percent), discharge: thousandths(discharge) }
    }

    /// The level in percent.
    pub fn percent(&self) -> f64 {
        f64::from(self.level) / 1000.0
    }

    /// Sets the level, in percent.
    pub fn set_percent(&mut self, percent: f64) {
        self.level = thousandths(percent);
    }

    /// Takes what one execution needs.
    pub fn drain(&mut self) {
        self.level = self.level.saturating_sub(self.discharge);
    }

    /// Gives what one execution in charge gains.
    pub fn charge(&mut self) {
        self.level = (self.level + self.discharge * CHARGE_FACTOR).min(FULL);
    }

    /// Whether it is charged as far as it goes. One that nothing drains always is.
    pub fn is_full(&self) -> bool {
        self.level == FULL || self.discharge == 0
    }

    /// Whether nothing is left.
    pub fn is_empty(&self) -> bool {
        self.level == 0 && self.discharge > 0
    }

    /// Whether at most so many percent are left.
    pub fn is_at_most(&self, percent: u32) -> bool {
        self.level <= percent.saturating_mul(1000)
    }

    /// How many executions it lasts; `u32::MAX` where nothing drains it.
    pub fn executions_left(&self) -> u32 {
        self.level.checked_div(self.discharge).unwrap_or(u32::MAX)
    }

    /// How many executions it lasts when it is full.
    pub fn executions_when_full(&self) -> u32 {
        FULL.checked_div(self.discharge).unwrap_or(u32::MAX)
    }
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "cut to 0..=100 before")]
fn thousandths(percent: f64) -> u32 {
    (percent.clamp(0.0, 100.0) * 1000.0).round() as u32
}

impl fmt::Display for Battery {
    /// With one decimal, as the console of the manual's figures shows it.
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{:.1}", self.percent())
    }
}
