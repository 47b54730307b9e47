//! Scenarios: lines of events, as `docs/scenarios.md` describes them.

mod bare_times;
mod complete;
mod continuation;
mod event;
mod fault_words;
mod language;
pub(super) mod line;
mod meant;
mod random;
mod strain;
mod tokenizer;
mod vocabulary;

use std::ops::Range;
use std::time::Duration;

use saoms_api::Finding;

pub(crate) use bare_times::bare_times;
pub use continuation::{Continuation, continuations};
pub use random::{RandomRange, Spot};
pub(in crate::environment) use vocabulary::Vocabulary;

use crate::text::TextFault;

/// A scenario: events and their times.
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

/// A line of a scenario: an event that happens once or several times.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Line {
    /// Index of the text that contains the line.
    pub text: u32,
    /// Time since the start, or since the last event of the line before.
    pub time: RandomRange<Duration>,
    /// True if the time counts from the line before.
    pub follows: bool,
    /// Time from one event to the next.
    pub every: RandomRange<Duration>,
    /// Number of events; `None` if it is not limited.
    pub times: Option<u64>,
    /// Time after which there are no more events.
    pub until: Option<Duration>,
    /// The event.
    pub event: EventSpec,
    /// Byte range of the word that names the event.
    pub bytes: Range<usize>,
}

/// An event as a scenario describes it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum EventSpec {
    /// New luggage that waits for a robot.
    Luggage {
        /// Block where the luggage is.
        from: Spanned<Spot>,
        /// Destination of the luggage.
        to: Spanned<Spot>,
    },
    /// Blocks that a robot visits.
    Visit {
        /// The blocks, in their order.
        stops: Vec<Spanned<Spot>>,
        /// The only robot that may do it, given as for a breakdown.
        by: Option<Spanned<RandomRange<u32>>>,
    },
    /// A landing with the number of pieces of luggage that are expected.
    Landing(RandomRange<u32>),
    /// A take-off with the number of pieces of luggage that are expected.
    Takeoff(RandomRange<u32>),
    /// A breakdown of the robot with this number, given as a number or as a name that ends with it.
    Breakdown(Spanned<RandomRange<u32>>),
    /// The robot with this number is taken off the floor, given as for a breakdown.
    Gone(Spanned<RandomRange<u32>>),
    /// An event that other classes take, or a fault of messages or executions, as it is written.
    Raised(Box<str>),
    /// No event: the run lasts until this time.
    End,
}

/// A value of a scenario with its place in the text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Spanned<T> {
    /// The value.
    pub value: T,
    /// Byte range of the value in the text.
    pub bytes: Range<usize>,
}

/// What is before a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::environment) enum Before {
    /// Nothing.
    Start,
    /// A line with a last event.
    Event,
    /// A line without a last event.
    Endless,
}

/// Maximum number of wrong lines that are reported.
const MOST_WRONG: usize = 1000;

/// The fault of a text that is a table of replicas, a map or XML: all its lines have one cause.
fn other(text: &str) -> Option<TextFault> {
    let head = text.lines().map(str::trim).find(|line| !line.is_empty())?;
    let is_row = |line: &str| line.chars().all(|sign| matches!(sign, '.' | '@' | '#')) && line.len() > 1;
    if is_row(head) || head.starts_with("type octile") {
        let fault = TextFault::of(text, head, "this is a map, expected a scenario with one event a line");
        return Some(fault.help("a map is the property `map` of a `saoms.World`"));
    }
    if head.starts_with(['<', '{']) {
        let what = if head.starts_with('<') { "XML" } else { "JSON" };
        let fault = TextFault::of(text, head, format!("this is {what}, expected a scenario with one event a line"));
        return Some(fault.help("`at 1s luggage (3,1) to (3,10)` is a line of a scenario"));
    }
    head.starts_with("index,").then(|| {
        let fault = TextFault::of(text, head, "this is a table of replicas, expected a scenario with one event a line");
        fault.help("name the table with `saoms:overrides`; `at 1s luggage (3,1) to (3,10)` is a line of a scenario")
    })
}

impl Scenario {
    /// Reads a scenario from its lines, given in any number of texts.
    ///
    /// # Errors
    /// Everything that is wrong with it, as findings about the property `scenario`. Which events classes take is not
    /// known here: a line that has the form of one is taken for one.
    pub fn read<S: AsRef<str>>(texts: &[S]) -> Result<Scenario, Vec<Finding>> {
        let (scenario, findings) = Scenario::read_partly(texts);
        if findings.is_empty() { Ok(scenario) } else { Err(findings) }
    }

    /// The correct lines, and findings about the wrong ones. After [`MOST_WRONG`] wrong lines reading stops.
    pub(crate) fn read_partly<S: AsRef<str>>(texts: &[S]) -> (Scenario, Vec<Finding>) {
        Scenario::read_with("scenario", texts, Vocabulary::ANY)
    }

    /// The same for another property, with the events that are known.
    fn read_with<S: AsRef<str>>(property: &str, texts: &[S], vocabulary: Vocabulary<'_>) -> (Scenario, Vec<Finding>) {
        let (mut lines, mut findings): (Vec<Line>, Vec<Finding>) = (Vec::new(), Vec::new());
        // What `then` counts from. A wrong line counts as one with a last event.
        let mut before = Before::Start;
        for (place, text) in texts.iter().enumerate() {
            if let Some(fault) = other(text.as_ref()).or_else(|| TextFault::of_file_name(text.as_ref())) {
                findings.push(fault.finding(property, place));
                continue;
            }
            // A text of a hundred thousand lines takes no more memory than they need.
            lines.reserve_exact(line::split(text.as_ref()).count());
            for part in line::split(text.as_ref()) {
                let read = line::read(text.as_ref(), part, before, vocabulary);
                let is_endless = read.as_ref().is_ok_and(|line| line.times.is_none() && line.until.is_none());
                before = if is_endless { Before::Endless } else { Before::Event };
                match read {
                    Ok(line) => lines.push(Line { text: u32::try_from(place).unwrap_or(u32::MAX), ..line }),
                    Err(_) if findings.len() == MOST_WRONG => return (Scenario { lines }, findings),
                    Err(fault) => findings.push(fault.finding(property, place)),
                }
            }
        }
        (Scenario { lines }, findings)
    }

    /// The lines, in their order.
    pub fn lines(&self) -> &[Line] {
        &self.lines
    }

    /// True if the scenario draws blocks from the whole area, so that the map is needed.
    pub fn needs_area(&self) -> bool {
        let anywhere = |spot: &Spanned<Spot>| spot.value == Spot::Anywhere;
        self.lines.iter().any(|line| match &line.event {
            EventSpec::Luggage { from, to } => anywhere(from) || anywhere(to),
            EventSpec::Visit { stops, .. } => stops.iter().any(anywhere),
            _ => false,
        })
    }
}
