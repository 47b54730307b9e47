use std::fmt;
use std::time::Duration;

use saoms_api::parse_duration;

use crate::grid::Block;
use crate::messages::{ExceptionalEvent, ExceptionalKind};

/// Something that happens.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Event {
    /// Luggage waits to be brought somewhere.
    Luggage {
        /// Where it is.
        from: Block,
        /// Where it has to go.
        to: Block,
    },
    /// A landing or a take-off.
    Exceptional(ExceptionalEvent),
}

/// What happens, and when.
///
/// ```
/// use std::time::Duration;
/// use saoms_components::environment::Scenario;
///
/// let scenario = Scenario::read(["at 6s luggage (3,1) to (3,10)", "then 1s landing 4"]).unwrap();
/// assert_eq!(scenario.events()[1].0, Duration::from_secs(7));
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Scenario {
    events: Vec<(Duration, Event)>,
}

/// Why a text is no scenario.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ScenarioError {
    /// The line, from 1; lines of all values are counted on, those that end with `;` too.
    pub line: usize,
    /// What was found, and what was expected.
    pub message: String,
}

impl fmt::Display for ScenarioError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "line {}: {}", self.line, self.message)
    }
}

impl std::error::Error for ScenarioError {}

impl Scenario {
    /// Reads a scenario from its lines, given in any number of texts.
    ///
    /// # Errors
    /// The first line that is no event.
    pub fn read<'a>(texts: impl IntoIterator<Item = &'a str>) -> Result<Scenario, ScenarioError> {
        let mut events = Vec::new();
        let mut last = Duration::ZERO;
        let lines = texts.into_iter().flat_map(|text| text.split(['\n', ';']));
        for (place, line) in lines.enumerate() {
            let line = line.split('#').next().unwrap_or_default().trim();
            if line.is_empty() {
                continue;
            }
            let error = |message| ScenarioError { line: place + 1, message };
            let (at, event) = read_event(line, last).map_err(error)?;
            last = at;
            events.push((at, event));
        }
        events.sort_by_key(|(at, _)| *at);
        Ok(Scenario { events })
    }

    /// The events and their times, in order.
    pub fn events(&self) -> &[(Duration, Event)] {
        &self.events
    }
}

const KINDS: [&str; 3] = ["luggage", "landing", "takeoff"];

fn read_event(line: &str, last: Duration) -> Result<(Duration, Event), String> {
    let expected = "expected a line such as `at 6s luggage (3,1) to (3,10)` or `then 500ms landing 4`";
    let found = || format!("found `{line}`, {expected}");
    let (when, rest) = line.split_once(char::is_whitespace).ok_or_else(found)?;
    let start = match when {
        "at" => Duration::ZERO,
        "then" => last,
        _ => return Err(format!("found `{when}` at its start, {expected}")),
    };
    let kinds = KINDS.iter().filter_map(|kind| Some((word(rest, kind)?, *kind)));
    let Some((place, kind)) = kinds.min() else {
        return Err(format!("found no event in `{line}`, expected one of {}", KINDS.join(", ")));
    };
    let (time, rest) = (rest[..place].trim(), rest[place + kind.len()..].trim());
    if time.is_empty() {
        return Err(format!("found no time after `{when}`, expected one such as `6s` or `500ms`"));
    }
    let at = start.checked_add(parse_duration(time)?).ok_or_else(|| format!("`{time}` is too long"))?;
    let event = match kind {
        "luggage" => read_luggage(rest)?,
        "landing" => read_exceptional(rest, ExceptionalKind::Landing)?,
        _ => read_exceptional(rest, ExceptionalKind::Takeoff)?,
    };
    Ok((at, event))
}

/// Where a word stands by itself.
fn word(text: &str, word: &str) -> Option<usize> {
    let bounded = |place: &usize| {
        let (before, after) = (&text[..*place], &text[place + word.len()..]);
        let before = before.chars().next_back().is_none_or(char::is_whitespace);
        before && after.chars().next().is_none_or(|sign| sign.is_whitespace() || sign == '(')
    };
    text.match_indices(word).map(|(place, _)| place).find(bounded)
}

fn read_luggage(text: &str) -> Result<Event, String> {
    let Some((from, to)) = text.split_once("to") else {
        return Err(format!("found `{text}` after `luggage`, expected two blocks such as `(3,1) to (3,10)`"));
    };
    Ok(Event::Luggage { from: from.parse()?, to: to.parse()? })
}

fn read_exceptional(text: &str, kind: ExceptionalKind) -> Result<Event, String> {
    let expected = || format!("found `{text}`, expected the number of expected pieces of luggage, such as 4");
    Ok(Event::Exceptional(ExceptionalEvent { kind, pieces: text.parse().map_err(|_| expected())? }))
}
