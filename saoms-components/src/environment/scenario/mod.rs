//! What a scenario says: lines of events, as `docs/scenarios.md` describes them.

mod complete;
mod draw;
mod event;
pub(super) mod line;
mod next;
mod words;

use std::ops::Range;
use std::time::Duration;

use saoms_api::Finding;

pub use draw::{Drawn, Spot};
pub use next::{Next, next};

/// What happens, and when.
///
/// ```
/// use saoms_components::environment::Scenario;
///
/// let scenario = Scenario::read(&["at 6s luggage (3,1) to (3,10)", "then 1s landing 4"]).unwrap();
/// assert_eq!(scenario.lines().len(), 2);
///
/// let findings = Scenario::read(&["at 6s lugage (3,1) to (3,10)"]).unwrap_err();
/// assert_eq!(findings[0].replacement(), Some("luggage"));
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Scenario {
    lines: Vec<Line>,
}

/// A line of a scenario: something that happens once or several times.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Line {
    /// Which of the texts it is in.
    pub text: usize,
    /// From the start, or after the last event of the line before.
    pub time: Drawn<Duration>,
    /// Whether the time counts from the line before.
    pub follows: bool,
    /// From one event to the next.
    pub every: Drawn<Duration>,
    /// How many events there are; `None` where the line has no such end.
    pub times: Option<u64>,
    /// The time after which there are no more.
    pub until: Option<Duration>,
    /// What happens.
    pub happening: Happening,
    /// The bytes of the word that says so.
    pub bytes: Range<usize>,
}

/// Something that can happen.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Happening {
    /// Luggage waits to be brought somewhere.
    Luggage {
        /// Where it is.
        from: Written<Spot>,
        /// Where it has to go.
        to: Written<Spot>,
    },
    /// An airplane lands, and so many pieces of luggage are expected.
    Landing(Drawn<u32>),
    /// An airplane is about to take off, and so many pieces are expected.
    Takeoff(Drawn<u32>),
    /// A robot breaks down: its number, or the name whose last digits are its number.
    Breakdown(Written<Drawn<u32>>),
    /// Nothing, but the run goes on until then.
    End,
}

/// What a scenario says, and the bytes of the text that say it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Written<T> {
    /// What is said.
    pub value: T,
    /// Where.
    pub bytes: Range<usize>,
}

/// Wrong lines of a scenario that are told: of one kind nobody is told more.
const MOST_WRONG: usize = 1000;

impl Scenario {
    /// Reads a scenario from its lines, given in any number of texts.
    ///
    /// # Errors
    /// Everything that is wrong with it, as findings about the property `scenario`.
    pub fn read<S: AsRef<str>>(texts: &[S]) -> Result<Scenario, Vec<Finding>> {
        let (scenario, findings) = Scenario::read_partly(texts);
        if findings.is_empty() { Ok(scenario) } else { Err(findings) }
    }

    /// The lines that are right, and what is wrong with the others. Behind [`MOST_WRONG`] wrong ones nothing is read.
    pub(crate) fn read_partly<S: AsRef<str>>(texts: &[S]) -> (Scenario, Vec<Finding>) {
        let (mut lines, mut findings): (Vec<Line>, Vec<Finding>) = (Vec::new(), Vec::new());
        // Whether `then` has something to count from; a wrong line before is taken for one.
        let mut endless = false;
        for (place, text) in texts.iter().enumerate() {
            for part in line::split(text.as_ref()) {
                let read = line::read(text.as_ref(), part, endless);
                endless = read.as_ref().is_ok_and(|line| line.times.is_none() && line.until.is_none());
                match read {
                    Ok(line) => lines.push(Line { text: place, ..line }),
                    Err(_) if findings.len() == MOST_WRONG => return (Scenario { lines }, findings),
                    Err(fault) => findings.push(fault.finding("scenario", place)),
                }
            }
        }
        (Scenario { lines }, findings)
    }

    /// Its lines in order.
    pub fn lines(&self) -> &[Line] {
        &self.lines
    }

    /// Whether blocks of the whole area are drawn, so that it has to be known.
    pub fn needs_area(&self) -> bool {
        let spots = self.lines.iter().filter_map(|line| match &line.happening {
            Happening::Luggage { from, to } => Some([from.value, to.value]),
            _ => None,
        });
        spots.flatten().any(|spot| spot == Spot::Anywhere)
    }
}
