//! The table for people.

use std::fmt;

use saoms_api::host::one_line;

use super::{AdaptationReport, KindReport, Spread};

/// Kinds that the table shows at most; the report has all.
const ROWS: usize = 24;

/// `p50/max` of times in seconds, or a line.
fn times(spread: Option<Spread>) -> String {
    spread.map_or_else(|| "-".to_owned(), |spread| format!("{:.3}/{:.3}", spread.p50, spread.max))
}

/// The name of a kind; what a loop began by itself says so.
fn name(kind: &KindReport) -> String {
    format!("{}{}", one_line(&kind.kind), if kind.own { " (own)" } else { "" })
}

/// A line for each kind of event, below a heading; nothing without events.
impl fmt::Display for AdaptationReport {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.kinds.is_empty() {
            return Ok(());
        }
        let shown = &self.kinds[..self.kinds.len().min(ROWS)];
        let width = shown.iter().map(|kind| name(kind).chars().count()).max().unwrap_or(0).max("event".len());
        writeln!(
            formatter,
            "{:width$}  {:>5}  {:>16}  {:>15}  {:>15}  {:>15}  {:>9}  {:>7}  {:>8}",
            "event", "count", "detect s p50/max", "decide", "effect", "settle", "overtaken", "lasting", "needless"
        )?;
        for kind in shown {
            let [detect, decide, effect, settle] =
                [kind.detect_s, kind.decide_s, kind.effect_s, kind.settle_s].map(times);
            writeln!(
                formatter,
                "{:width$}  {:>5}  {detect:>16}  {decide:>15}  {effect:>15}  {settle:>15}  {:>9}  {:>7}  {:>8}",
                name(kind),
                kind.count,
                kind.overtaken,
                kind.lasting,
                kind.needless
            )?;
        }
        if self.kinds.len() > shown.len() {
            writeln!(formatter, "and {} more kinds: see --report", self.kinds.len() - shown.len())?;
        }
        if self.unmeasured > 0 {
            writeln!(formatter, "{} more events were not measured", self.unmeasured)?;
        }
        if self.detached > 0 {
            writeln!(formatter, "{} records belong to no event: their cause is lost, or too old", self.detached)?;
        }
        Ok(())
    }
}
