use std::fmt;

/// A robot's battery.
///
/// It counts in thousandths of a percent, so that many small discharges add up exactly.
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

/// Charge of one execution, as a multiple of its discharge.
const CHARGE_FACTOR: u32 = 5;

impl Battery {
    /// A battery with this level and discharge per execution, both in percent; values outside 0 to 100 are clamped.
    pub fn new(percent: f64, discharge: f64) -> Battery {
        Battery { level: thousandths(percent), discharge: thousandths(discharge) }
    }

    /// Level in percent.
    pub fn percent(&self) -> f64 {
        f64::from(self.level) / 1000.0
    }

    /// Sets the level, in percent.
    pub fn set_percent(&mut self, percent: f64) {
        self.level = thousandths(percent);
    }

    /// Discharges the battery by one execution.
    pub fn drain(&mut self) {
        self.level = self.level.saturating_sub(self.discharge);
    }

    /// Charges the battery by one execution.
    pub fn charge(&mut self) {
        self.level = (self.level + self.discharge * CHARGE_FACTOR).min(FULL);
    }

    /// True if the battery is full. A battery without discharge always is.
    pub fn is_full(&self) -> bool {
        self.level == FULL || self.discharge == 0
    }

    /// True if the battery is empty.
    pub fn is_empty(&self) -> bool {
        self.level == 0 && self.discharge > 0
    }

    /// True if at most `percent` percent are left.
    pub fn is_at_most(&self, percent: u32) -> bool {
        self.level <= percent.saturating_mul(1000)
    }

    /// Number of executions that the battery lasts; `u32::MAX` without discharge.
    pub fn executions_left(&self) -> u32 {
        self.level.checked_div(self.discharge).unwrap_or(u32::MAX)
    }

    /// Number of executions that the full battery lasts.
    pub fn executions_when_full(&self) -> u32 {
        FULL.checked_div(self.discharge).unwrap_or(u32::MAX)
    }
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "cut to 0..=100 before")]
fn thousandths(percent: f64) -> u32 {
    (percent.clamp(0.0, 100.0) * 1000.0).round() as u32
}

impl fmt::Display for Battery {
    /// Format with one decimal, as on the console of the manual's figures.
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{:.1}", self.percent())
    }
}
