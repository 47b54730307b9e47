//! Output of results.

use std::fs;
use std::io::Write as _;
use std::path::Path;

use serde::Serialize;

use super::{Outcome, RESULTS};

/// Writes `NAME.md` and `NAME.json`, and shows the page.
pub(crate) fn write(name: &str, page: &str, raw: &impl Serialize) -> Outcome<()> {
    let folder = Path::new(RESULTS);
    fs::create_dir_all(folder)?;
    fs::write(folder.join(name).with_extension("md"), page)?;
    fs::write(folder.join(name).with_extension("json"), serde_json::to_vec_pretty(raw)?)?;
    std::io::stdout().write_all(page.as_bytes())?;
    Ok(())
}

/// Median of some values; of an even number of them, the mean of the two in the middle.
pub(crate) fn median(values: impl Iterator<Item = f64>) -> Option<f64> {
    let mut values: Vec<f64> = values.filter(|value| value.is_finite()).collect();
    values.sort_by(f64::total_cmp);
    let upper = values.get(values.len() / 2)?;
    let lower = values.get(values.len().saturating_sub(1) / 2)?;
    Some(f64::midpoint(*lower, *upper))
}

/// Cell of a table for a goal.
pub(crate) fn verdict(met: bool) -> &'static str {
    if met { "met" } else { "missed" }
}
