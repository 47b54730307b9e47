//! Scenario lines from outside a running fleet (`saoms run --events`).

use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};

use saoms_api::event::Events;
use saoms_api::extension::{EventContent, EventLanguage, EventReader, EventSource, LineFault, TimedMessage, submit};
use saoms_api::host::cdr;
use saoms_api::rule::FleetView;
use saoms_api::{Chance, Time};

use super::player::draw;
use super::scenario::line::{read_outside, split};
use super::scenario::{Before, Vocabulary};
use super::{EventSpec, Line, ScenarioEvent, Spot};
use crate::messages::{ENVIRONMENT, EnvironmentEvent, EventLuggage, ExceptionalKind, Fault};
use crate::rules::masters::judge_end;
use crate::rules::peers::judge_disturbance;
use crate::rules::scenario::{judge_luggage, judge_outage, judge_robot, no_work};
use crate::rules::worlds::judge_crash;
use crate::text::{TextFault, bytes};

submit! {
    EventLanguage {
        topic: ENVIRONMENT.declaration(),
        settles: &[no_work::RULE.code.id],
        judge,
        new: |source| Box::new(Reader::new(source)),
    }
}

/// The number of the first piece of luggage from outside: those of a scenario begin with 1.
const FIRST_LUGGAGE: u32 = 1_000_001;
/// The most events of one line.
const MOST: usize = 100_000;
/// The word before the number of a piece of luggage.
const NUMBER: &str = "number";

/// A reader of scenario lines, without knowledge of the area.
pub(super) struct Reader {
    chance: Chance,
    /// What messages call a line.
    called: &'static str,
    /// Number of pieces of luggage that came from outside.
    luggage: Arc<AtomicU32>,
    /// The time of the last event of the line before.
    last: Time,
    before: Before,
}

impl Reader {
    pub(super) fn new(source: EventSource) -> Reader {
        let chance = Chance::for_component(source.seed, source.name);
        Reader { chance, called: source.line, luggage: source.numbers, last: Time::START, before: Before::Start }
    }

    /// Reads one event of the line.
    fn part(&mut self, text: &str, now: Time, events: &Events) -> Result<Vec<TimedMessage>, TextFault> {
        let (event, number) = numbered(text)?;
        let (line, is_now) = read_outside(event, self.before, Vocabulary::with(events))?;
        self.before = Before::Event;
        place_is_known(&line)?;
        if line.times.is_none() && line.until.is_none() {
            let fault = TextFault::new(line.bytes, format!("this line never ends, but {} has to end", self.called));
            return Err(fault.help("add an end: `100 times`, or `until 60s`"));
        }
        if matches!(line.event, EventSpec::Visit { .. }) {
            let message = "found `visit`, which is not possible from outside: expected another event";
            return Err(TextFault::new(line.bytes, message).help("write visits into the scenario of a composite"));
        }
        if number.is_some() && !(matches!(line.event, EventSpec::Luggage { .. }) && line.times == Some(1)) {
            let message = format!("found `{NUMBER}`, which is allowed only after a single piece of luggage");
            return Err(TextFault::new(event.len()..text.len(), message));
        }
        // Each line draws for itself, so that one more or less changes nothing in the others.
        let mut chance = Chance::new(self.chance.next_u64());
        let mut messages = Vec::new();
        let start = if line.follows { self.last } else { Time::START };
        let mut at = if is_now { now } else { start + line.time.draw(&mut chance) };
        let until = line.until.map(|until| Time::START + until);
        while until.is_none_or(|until| at <= until) {
            if messages.len() == MOST {
                let message = format!("found more than {MOST} events in {}", self.called);
                return Err(TextFault::new(line.bytes, message));
            }
            let event = draw(&line.event, &mut chance, None).ok_or_else(|| {
                TextFault::new(line.bytes.clone(), "found no two free blocks for the luggage of this line")
            })?;
            let (content, text) = self.message(event, number);
            messages.push(TimedMessage { at: (!is_now).then_some(at), content, text });
            self.last = at;
            if line.times.is_some_and(|times| messages.len() as u64 >= times) {
                break;
            }
            at = at + line.every.draw(&mut chance);
        }
        Ok(messages)
    }

    /// The message of an event, and the line that says it again, without its time.
    fn message(&mut self, event: ScenarioEvent, number: Option<u32>) -> (EventContent, String) {
        let (message, text): (EnvironmentEvent, String) = match event {
            ScenarioEvent::Luggage { from, to } => {
                let number = self.luggage_number(number);
                (EventLuggage::request(number, from, to).into(), format!("luggage {from} to {to} {NUMBER} {number}"))
            }
            // It was refused before.
            ScenarioEvent::Visit { .. } => (EnvironmentEvent::default(), "end".to_owned()),
            ScenarioEvent::Exceptional(event) => {
                let kind = match event.kind {
                    ExceptionalKind::Landing => "landing",
                    ExceptionalKind::Takeoff => "takeoff",
                };
                let text = format!("{kind} {}", event.pieces);
                (event.into(), text)
            }
            ScenarioEvent::Breakdown(robot) => (Fault::breakdown(robot).into(), format!("breakdown {robot}")),
            ScenarioEvent::Gone(robot) => (Fault::gone(robot).into(), format!("gone {robot}")),
            ScenarioEvent::End => (EnvironmentEvent::default(), "end".to_owned()),
            ScenarioEvent::Raised(event) => return (EventContent::Raised, event),
        };
        (EventContent::Bytes(cdr::encode(&message)), text)
    }

    /// The number that a line gives, or the next one.
    fn luggage_number(&self, given: Option<u32>) -> u32 {
        match given {
            Some(number) => {
                // The next one of its own is beyond all that were given.
                self.luggage.fetch_max(number - FIRST_LUGGAGE + 1, Ordering::Relaxed);
                number
            }
            None => FIRST_LUGGAGE.saturating_add(self.luggage.fetch_add(1, Ordering::Relaxed)),
        }
    }
}

/// The event of a text, and the number that follows it: `luggage (3,1) to (3,10) number 1000001`. The journal has it,
/// so that luggage has the same number when its events are played again.
fn numbered(text: &str) -> Result<(&str, Option<u32>), TextFault> {
    let words: Vec<&str> = text.split_whitespace().rev().take(2).collect();
    let [number, NUMBER] = words[..] else { return Ok((text, None)) };
    let word = &text[bytes(text, words[1])];
    match number.parse() {
        Ok(given @ FIRST_LUGGAGE..=u32::MAX) => Ok((&text[..bytes(text, word).start], Some(given))),
        _ => {
            let message =
                format!("found `{number}`, expected a luggage number for events from outside: {FIRST_LUGGAGE} or more");
            Err(TextFault::of(text, number, message))
        }
    }
}

/// Refuses `random`, for which the area has to be known.
fn place_is_known(line: &Line) -> Result<(), TextFault> {
    let EventSpec::Luggage { from, to } = &line.event else { return Ok(()) };
    match [from, to].into_iter().find(|spot| spot.value == Spot::Anywhere) {
        None => Ok(()),
        Some(spot) => {
            let expected = "a block such as `(3,1)`, or two corners such as `(1,0)..(10,10)`";
            let fault = TextFault::new(spot.bytes.clone(), format!("found `random`, expected {expected}"));
            Err(fault.help("write a block or two corners: only a scenario in a composite knows the area"))
        }
    }
}

/// Judges the events of a line that was read without a fault.
fn judge(fleet: &FleetView<'_>, events: &Events, line: &str) -> Result<(), LineFault> {
    // A warning hides no error.
    let mut warned = Ok(());
    for part in split(line) {
        let Ok((read, _)) = read_outside(part, Before::Event, Vocabulary::with(events)) else { continue };
        let offset = bytes(line, part).start;
        judge_outage(fleet, &read.event).map_err(|fault| fault.moved(offset + read.bytes.start))?;
        let judged = judge_robot(fleet, &read, part)
            .and_then(|()| judge_luggage(fleet, &read.event))
            .and_then(|()| judge_disturbance(fleet, &read.event, read.bytes.clone()));
        judged.map_err(|fault| fault.moved(offset))?;
        let crash = judge_crash(fleet, &read.event, read.bytes.clone())
            .and_then(|()| judge_end(fleet, &read.event, read.bytes.clone()));
        warned = warned.and(crash.map_err(|fault| fault.moved(offset)));
    }
    warned
}

impl EventReader for Reader {
    fn read(&mut self, line: &str, now: Time, events: &Events) -> Result<Vec<TimedMessage>, LineFault> {
        let mut messages = Vec::new();
        for part in split(line) {
            let offset = bytes(line, part).start;
            messages.extend(self.part(part, now, events).map_err(|TextFault { bytes, message, instead, help }| {
                LineFault { bytes, message, instead, help, code: None }.moved(offset)
            })?);
        }
        Ok(messages)
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;

    fn reader(seed: u64) -> Reader {
        Reader::new(EventSource { name: "(outside)", line: "a line of `--events`", seed, numbers: Arc::default() })
    }

    /// The events of lines that come one after the other at 7 s, or what is wrong with a line.
    fn events(lines: &[&str]) -> Vec<String> {
        let mut reader = reader(1);
        let mut shown = Vec::new();
        for line in lines {
            match reader.read(line, Time::START + Duration::from_secs(7), &Events::default()) {
                Ok(messages) => shown.extend(messages.into_iter().map(|TimedMessage { at, text, .. }| {
                    at.map_or_else(|| format!("now {text}"), |at| format!("{at} {text}"))
                })),
                Err(LineFault { bytes, message, instead, .. }) => {
                    shown.push(format!("`{}`: {message}, {instead:?}", &line[bytes]));
                }
            }
        }
        shown
    }

    #[test]
    fn lines_become_messages_at_their_times() {
        assert_eq!(
            events(&[
                "luggage (3,1) to (3,10) # soon",
                "at 9s landing 4; then 500ms takeoff 2",
                "",
                "then 1s every 2s 2 times breakdown Robot002",
                "from 1s every 1s until 3s luggage (1,5) to (10,5)",
                "at 20s gone Robot002; gone 3",
                "end",
            ]),
            [
                "now luggage (3,1) to (3,10) number 1000001",
                "9.000 s landing 4",
                "9.500 s takeoff 2",
                "10.500 s breakdown 2",
                "12.500 s breakdown 2",
                "1.000 s luggage (1,5) to (10,5) number 1000002",
                "2.000 s luggage (1,5) to (10,5) number 1000003",
                "3.000 s luggage (1,5) to (10,5) number 1000004",
                "20.000 s gone 2",
                "now gone 3",
                "now end",
            ]
        );
    }

    #[test]
    fn luggage_has_numbers_of_its_own_and_chance_follows_from_the_seed() {
        let line = "at 1s 2 times luggage (1,0)..(10,10) to (1,0)..(10,10)";
        let read = |seed| reader(seed).read(line, Time::START, &Events::default()).unwrap();
        let event = |place: usize| -> EnvironmentEvent {
            let EventContent::Bytes(bytes) = &read(1)[place].content else { panic!("it is of the language") };
            cdr::decode(bytes).unwrap()
        };
        let (first, second) = (event(0), event(1));
        assert_eq!((first.luggage[0].luggage, second.luggage[0].luggage), (1_000_001, 1_000_002));
        assert_eq!(read(1), read(1));
        assert_ne!(read(1), read(2));
    }

    #[test]
    fn luggage_keeps_the_number_that_a_line_gives_and_others_go_on_behind_it() {
        assert_eq!(
            events(&[
                "at 3s luggage (3,1) to (3,10) number 1000007",
                "luggage (3,1) to (3,10)",
                "luggage (3,1) to (3,10) number 7",
                "landing 3 number 1000009",
                "at 1s 2 times luggage (3,1) to (3,10) number 1000009",
            ]),
            [
                "3.000 s luggage (3,1) to (3,10) number 1000007",
                "now luggage (3,1) to (3,10) number 1000008",
                "`7`: found `7`, expected a luggage number for events from outside: 1000001 or more, None",
                "`number 1000009`: found `number`, which is allowed only after a single piece of luggage, None",
                "`number 1000009`: found `number`, which is allowed only after a single piece of luggage, None",
            ]
        );
    }

    #[test]
    fn wrong_lines_are_refused_at_the_very_word() {
        assert_eq!(
            events(&[
                "at 6s lugage (3,1) to (3,10)",
                "landin 4",
                "att 4s landing 4",
                "hello",
                "luggage random to (1,1)",
                "at 1s landing 1; from 1s every 1s landing 2",
                "from 1s every 1ms until 10h landing 2",
                "luggage (3,1) to (3,1)..(3,1)",
                "luggage (3,1) to (3,10) quickly",
                "ü",
                "gone robot 2",
                "gon 2",
            ]),
            [
                "`lugage`: found `lugage`, expected `luggage`, `visit`, `landing`, `takeoff`, `breakdown`, `gone`, `end`, `lose`, `violate`, `delay`, `jitter`, `duplicate`, `reorder`, `cut`, `part`, `stall`, `fail`, `crash` or `drift`, Some(\"luggage\")",
                "`landin`: found `landin`, expected an event, `at`, `from` or `then` at the start of a line, Some(\"landing\")",
                "`att`: found `att`, expected an event, `at`, `from` or `then` at the start of a line, Some(\"at\")",
                "`hello`: found `hello`, expected an event, `at`, `from` or `then` at the start of a line, None",
                "`random`: found `random`, expected a block such as `(3,1)`, or two corners such as `(1,0)..(10,10)`, None",
                "`landing`: this line never ends, but a line of `--events` has to end, None",
                "`landing`: found more than 100000 events in a line of `--events`, None",
                "`(3,1)..(3,1)`: found (3,1), where the luggage starts: expected another block, None",
                "`quickly`: found `quickly`, expected the end of the line, or `;` before the next event, None",
                "`ü`: found `ü`, expected an event, `at`, `from` or `then` at the start of a line, None",
                "`robot 2`: found `robot 2`, expected a robot such as `Robot002` or `2`, or numbers such as `1..10` to draw one of, Some(\"2\")",
                "`gon`: found `gon`, expected an event, `at`, `from` or `then` at the start of a line, Some(\"gone\")",
            ]
        );
    }
}
