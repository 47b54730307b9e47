use serde::{Deserialize, Serialize};

/// A figure of several events.
///
/// ```
/// use saoms_core::adaptation::Spread;
///
/// let spread = Spread::of(vec![0.3, 0.1, 0.4, 0.2]).unwrap();
/// assert_eq!((spread.count, spread.p50, spread.max), (4, 0.25, 0.4));
/// assert_eq!(Spread::of(Vec::new()), None);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Spread {
    /// How many events have it.
    pub count: usize,
    /// The median: of an even number of values the mean of the two in the middle.
    pub p50: f64,
    /// The mean.
    pub mean: f64,
    /// The greatest.
    pub max: f64,
}

impl Spread {
    /// The spread of these values; `None` without any.
    pub fn of(mut values: Vec<f64>) -> Option<Spread> {
        values.sort_by(f64::total_cmp);
        let count = values.len();
        let (lower, upper) = (values.get(count.checked_sub(1)? / 2)?, values.get(count / 2)?);
        let mean = values.iter().sum::<f64>() / count as f64;
        Some(Spread { count, p50: f64::midpoint(*lower, *upper), mean, max: *values.last()? })
    }
}
