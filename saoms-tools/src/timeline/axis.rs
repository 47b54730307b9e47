//! Round numbers beside axes.

/// A round step with which a range is divided into at most `parts`: 1, 2 or 5 times a power of ten.
fn step(range: f64, parts: f64) -> f64 {
    let least = range / parts;
    let power = 10_f64.powf(least.log10().floor());
    [1.0, 2.0, 5.0, 10.0].into_iter().map(|step| step * power).find(|step| *step >= least).unwrap_or(range)
}

/// The upper end of an axis from 0 that holds this value, and its step.
pub(super) fn scale(most: f64) -> (f64, f64) {
    let most = if most.is_finite() && most > 0.0 { most } else { 1.0 };
    let step = step(most, 3.0);
    ((most / step).ceil() * step, step)
}

/// The steps of seconds by which people count.
const TIMES: [f64; 14] = [
    60.0, 120.0, 300.0, 600.0, 1800.0, 3600.0, 7200.0, 14_400.0, 21_600.0, 43_200.0, 86_400.0, 172_800.0, 432_000.0,
    864_000.0,
];

/// Times on an axis until this one, in seconds, with their labels.
pub(super) fn times(end: f64) -> Vec<(f64, String)> {
    let parts = 12.0;
    let step = match end / parts {
        least if least <= 30.0 => step(end, parts),
        least => TIMES.into_iter().find(|step| *step >= least).unwrap_or(end),
    };
    if !step.is_finite() || step <= 0.0 {
        return Vec::new();
    }
    (0..=100_u32)
        .map(|place| f64::from(place) * step)
        .take_while(|time| *time <= end)
        .map(|at| (at, label(at)))
        .collect()
}

fn label(seconds: f64) -> String {
    match seconds {
        hours if hours >= 3600.0 => format!("{} h", number(hours / 3600.0)),
        minutes if minutes >= 60.0 => format!("{} min", number(minutes / 60.0)),
        seconds => format!("{} s", number(seconds)),
    }
}

/// A number with up to three decimals.
pub(super) fn number(value: f64) -> f64 {
    let rounded = (value * 1000.0).round() / 1000.0;
    if rounded == 0.0 { 0.0 } else { rounded }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_have_round_numbers() {
        assert_eq!(scale(10.0), (10.0, 5.0));
        assert_eq!(scale(14.0), (15.0, 5.0));
        assert_eq!(scale(0.0), (1.0, 0.5));
        assert_eq!(scale(f64::NAN), (1.0, 0.5));
        let labels = |end| times(end).into_iter().map(|(_, label)| label).collect::<Vec<_>>().join(" ");
        assert_eq!(labels(10.2), "0 s 1 s 2 s 3 s 4 s 5 s 6 s 7 s 8 s 9 s 10 s");
        assert_eq!(
            labels(3600.0),
            "0 s 5 min 10 min 15 min 20 min 25 min 30 min 35 min 40 min 45 min 50 min 55 min 1 h"
        );
        assert_eq!(labels(86_400.0).split(' ').count(), 26);
        assert_eq!(labels(0.0), "");
    }
}
