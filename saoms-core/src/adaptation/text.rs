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

/// How much less was finished after it than before, in percent, or a line.
fn dip(kind: &KindReport) -> String {
    let dip = kind.throughput.and_then(|throughput| throughput.dip_percent);
    dip.map_or_else(|| "-".to_owned(), |dip| format!("{dip:.0}"))
}

/// The name of the kind; what a loop began by itself says so.
impl fmt::Display for KindReport {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{}{}", one_line(&self.kind), if self.own { " (own)" } else { "" })
    }
}

/// A line for each kind of event, below a heading; nothing without events.
impl fmt::Display for AdaptationReport {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.kinds.is_empty() {
            return Ok(());
        }
        let shown = &self.kinds[..self.kinds.len().min(ROWS)];
        let width = shown.iter().map(|kind| kind.to_string().chars().count()).max().unwrap_or(0).max("event".len());
        writeln!(
            formatter,
            "{:width$}  {:>5}  {:>16}  {:>15}  {:>15}  {:>15}  {:>9}  {:>7}  {:>8}  {:>6}",
            "event",
            "count",
            "detect s p50/max",
            "decide",
            "effect",
            "settle",
            "overtaken",
            "lasting",
            "needless",
            "dip %"
        )?;
        for kind in shown {
            let [detect, decide, effect, settle] =
                [kind.detect_s, kind.decide_s, kind.effect_s, kind.settle_s].map(times);
            writeln!(
                formatter,
                "{:width$}  {:>5}  {detect:>16}  {decide:>15}  {effect:>15}  {settle:>15}  {:>9}  {:>7}  {:>8}  {:>6}",
                kind.to_string(),
                kind.count,
                kind.overtaken,
                kind.lasting,
                kind.needless,
                dip(kind)
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
