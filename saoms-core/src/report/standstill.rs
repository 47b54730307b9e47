use std::fmt;

use saoms_api::Time;
use serde::{Deserialize, Serialize};

/// A standstill: nothing happened in the fleet for a long time, although work was left.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Standstill {
    /// The time of the last effect, in seconds of the run.
    pub since_s: f64,
    /// True if it ended the run, since nothing can happen any more.
    pub ends: bool,
    /// Components that wait, or do not run: first those that see work left.
    pub waiting: Vec<Waiting>,
}

// The time is a number.
impl Eq for Standstill {}

/// A component that waits.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Waiting {
    /// Its name.
    pub component: String,
    /// False if it is not scheduled.
    pub runs: bool,
    /// What it waits for, in its own words; `None` if it did not say.
    pub waits_for: Option<String>,
}

/// Maximum number of groups of components that the text names.
const GROUPS: usize = 5;

/// One line: since when, and who waits for what. Components that wait for the same are named together.
impl fmt::Display for Standstill {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let since = Time::from_nanos((self.since_s * 1e9).round() as u64);
        let more = if self.ends { ", and nothing more can" } else { "" };
        write!(formatter, "nothing has happened since {since}{more}")?;
        let mut groups: Vec<(&Waiting, usize)> = Vec::new();
        for one in &self.waiting {
            let same =
                |(other, _): &&mut (&Waiting, usize)| (one.runs, &one.waits_for) == (other.runs, &other.waits_for);
            match groups.iter_mut().find(same) {
                Some((_, more)) => *more += 1,
                None => groups.push((one, 0)),
            }
        }
        let hidden: usize = groups.iter().skip(GROUPS).map(|(_, more)| more + 1).sum();
        for (place, (first, more)) in groups.iter().take(GROUPS).enumerate() {
            let (comma, Waiting { component, runs, waits_for }) = (if place > 0 { "; " } else { ": " }, first);
            write!(formatter, "{comma}`{component}`")?;
            if *more > 0 {
                write!(formatter, " and {more} more")?;
            }
            match (runs, waits_for, more) {
                (false, _, 0) => formatter.write_str(" is not started")?,
                (false, ..) => formatter.write_str(" are not started")?,
                (true, Some(what), 0) => write!(formatter, " waits for {what}")?,
                (true, Some(what), _) => write!(formatter, " wait for {what}")?,
                (true, None, 0) => formatter.write_str(" sees work left")?,
                (true, None, _) => formatter.write_str(" see work left")?,
            }
        }
        if hidden > 0 { write!(formatter, "; {hidden} more wait") } else { Ok(()) }
    }
}
