//! The battery level that the hardware measures.

/// Number of executions after which hardware is asked again that could not measure the battery.
const ASK_AGAIN: u32 = 50;

/// What is known of the hardware's measurement of the battery.
#[derive(Debug, Default)]
pub(super) struct Gauge {
    measures: bool,
    /// Number of executions in which it is not asked, since it has said that it cannot.
    silent_for: u32,
}

impl Gauge {
    /// That of a robot which goes on.
    pub(super) fn of(measures: bool) -> Gauge {
        Gauge { measures, silent_for: 0 }
    }

    /// True if the hardware measures the battery, so that the robot does not count.
    pub(super) fn measures(&self) -> bool {
        self.measures
    }

    /// True if the hardware is asked in this execution.
    pub(super) fn asks(&mut self) -> bool {
        let fewer = self.silent_for.checked_sub(1);
        self.silent_for = fewer.unwrap_or(0);
        fewer.is_none()
    }

    /// Takes in an answer, and returns the level if it has one. What is no number changes nothing.
    pub(super) fn take_in(&mut self, answer: Option<f64>) -> Option<f64> {
        match answer {
            Some(percent) if percent.is_finite() => {
                self.measures = true;
                Some(percent)
            }
            Some(_) => None,
            None => {
                *self = Gauge { measures: false, silent_for: ASK_AGAIN };
                None
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hardware_without_a_gauge_is_asked_now_and_then() {
        let mut gauge = Gauge::default();
        let mut asked = Vec::new();
        for execution in 0..120 {
            if gauge.asks() {
                asked.push(execution);
                gauge.take_in(None);
            }
        }
        assert_eq!(asked, [0, 51, 102]);
    }

    #[test]
    fn only_numbers_are_levels() {
        let mut gauge = Gauge::default();
        assert_eq!((gauge.take_in(Some(f64::NAN)), gauge.measures()), (None, false));
        assert_eq!((gauge.take_in(Some(70.0)), gauge.measures()), (Some(70.0), true));
        assert_eq!((gauge.take_in(Some(f64::INFINITY)), gauge.measures()), (None, true));
        assert_eq!((gauge.take_in(None), gauge.measures(), gauge.asks()), (None, false, false));
    }
}
