//! Completion of scenarios in editors.

use std::ops::Range;

use saoms_api::event::Event;
use saoms_api::extension::{Completion, CompletionKind, DURATION_UNITS, PropertyText};

use super::event::KINDS;
use super::{Continuation, continuations};

/// Class of the components that can break down, and be gone.
const ROBOT: &str = "saoms.Robot";

/// Completions for the cursor in a scenario.
pub(super) fn complete(scenario: &PropertyText<'_>) -> Vec<Completion> {
    let PropertyText { text, at, plays, events, components } = *scenario;
    let line = text[..at].rfind(['\n', '\r', ';']).map_or(0, |found| found + 1);
    let before = &text[line..at];
    if before.contains('#') {
        return Vec::new();
    }
    let start = word_start(before);
    let is_number = |text: &str| text.parse::<f64>().is_ok();
    let typed = before[start..].trim_end_matches(|c: char| c.is_ascii_alphabetic());
    let rest = &text[at..];
    let end = at + rest.find(|c: char| c.is_whitespace() || ";.)<".contains(c)).unwrap_or(rest.len());
    let end = end + usize::from(before[start..].starts_with('(') && text[end..].starts_with(')'));
    let word = line + start..end;
    let value = |label: &str| Completion::new(label, CompletionKind::Value, &word);
    let is_event = |word: &str| before[..start].split_whitespace().any(|one| one == word);
    if let Some(event) = events.iter().find(|event| is_event(&event.name)) {
        return of_event(event, &before[..start], (&before[start..], word), components);
    }
    let mut all = Vec::new();
    let next = continuations(&before[..start]);
    if KINDS.iter().any(|kind| next.contains(&Continuation::Word(kind))) {
        // Behind those of the language.
        let event = |one: &Event| Completion::new(&one.name, CompletionKind::Keyword, &word).detail(&one.doc).rank(7);
        all.extend(events.iter().map(event));
    }
    let is_played = |one: &Continuation| match one {
        Continuation::Word(name) => !KINDS.contains(name) || plays.iter().any(|one| one == name),
        _ => true,
    };
    for (one, rank) in next.into_iter().filter(is_played).zip(0..) {
        match one {
            Continuation::Word(name) => {
                let one = Completion::new(name, CompletionKind::Keyword, &word);
                all.push(one.detail(meaning(name)).rank(rank));
            }
            Continuation::Time | Continuation::Duration if is_number(typed) => {
                let units = DURATION_UNITS.iter().zip(1..);
                all.extend(units.map(|((unit, name), rank)| value(&format!("{typed}{unit}")).detail(*name).rank(rank)));
            }
            Continuation::Time => all.push(value("1s").detail("a time: `500ms`, `6s`, or a range `2s..8s`")),
            Continuation::Times => {
                let number = if is_number(typed) { typed } else { "3" };
                all.push(value(&format!("{number} times")).detail("how often").rank(6));
            }
            Continuation::Pieces => all.push(value("4").detail("how many pieces of luggage, or a range `2..8`")),
            Continuation::Place => {
                let block = value("(0,0)").snippet("(${1:0},${2:0})");
                all.push(block.detail("column and row of a block, or a range `(0,0)..(9,9)`"));
                all.push(value("random").detail("any block of the area"));
            }
            Continuation::Duration => all.push(value("1s").detail("a time: `500ms`, `6s`")),
            Continuation::Rate => {
                let number = if is_number(typed) { typed } else { "10" };
                all.push(value(&format!("{number} %")).detail("a part, from `0 %` to `100 %`"));
            }
            Continuation::Component => {
                let component = |name| Completion::new(name, CompletionKind::Component, &word);
                all.extend(components("").into_iter().map(component));
            }
            // Which there are, the text alone does not say.
            Continuation::Topic => {}
            Continuation::Robot => {
                let robot = |name| Completion::new(name, CompletionKind::Component, &word);
                all.extend(components(ROBOT).into_iter().map(robot));
            }
        }
    }
    all
}

/// Completions behind the name of an event that classes take; `typed` is the present word, with its bytes.
fn of_event(
    event: &Event,
    before: &str,
    (typed, word): (&str, Range<usize>),
    components: &dyn Fn(&str) -> Vec<String>,
) -> Vec<Completion> {
    let given = before.split_whitespace().skip_while(|one| *one != event.name).skip(1);
    let fields = || event.fields.iter();
    if let Some((name, _)) = typed.split_once('=') {
        let choices = fields().filter(|field| field.name == name).flat_map(|field| field.of.choices());
        let range = word.start + name.len() + 1..word.end;
        return choices.map(|one| Completion::new(one, CompletionKind::Value, &range)).collect();
    }
    if given.clone().any(|one| one == "to") {
        if given.last() != Some("to") {
            return Vec::new();
        }
        let names = event.classes.iter().flat_map(|class| components(class));
        return names.map(|name| Completion::new(name, CompletionKind::Component, &word)).collect();
    }
    let is_given = |name: &str| given.clone().any(|one| one.split('=').next() == Some(name));
    let left = fields().filter(|field| !is_given(&field.name));
    let mut all: Vec<Completion> = left
        .map(|field| {
            let one = Completion::new(format!("{}={}", field.name, field.of.sample()), CompletionKind::Value, &word);
            one.detail(field.of.expected()).rank(if field.of.is_optional() { 6 } else { 4 })
        })
        .collect();
    all.push(Completion::new("to", CompletionKind::Keyword, &word).detail("the only component that takes it").rank(7));
    all
}

/// Byte position at which the last word of a line begins.
fn word_start(line: &str) -> usize {
    // A block is one word, even if it contains blanks.
    match (line.rfind('('), line.rfind(')')) {
        (Some(open), close) if close.is_none_or(|close| close < open) => open,
        _ => {
            let blank = line.trim_end_matches(|c: char| !c.is_whitespace()).len();
            line.rfind("..").map_or(0, |dots| dots + 2).max(blank)
        }
    }
}

pub(super) fn meaning(word: &str) -> &'static str {
    match word {
        "at" => "once, at a time from the start",
        "from" => "repeatedly, from this time on",
        "then" => "after the event of the line before; or the next block of a `visit`",
        "by" => "the only robot that may do it",
        "every" => "the time from one event to the next",
        "until" => "the time after which the event is not repeated",
        "luggage" => "luggage waits at a block to be brought `to` another one",
        "visit" => "a robot goes to these blocks, in this order",
        "landing" => "an airplane lands with this number of pieces of luggage",
        "takeoff" => "an airplane takes off with this number of pieces of luggage",
        "breakdown" => "a robot breaks down where it is",
        "gone" => "an operator removes a robot from the floor: its block is free, and its luggage waits again",
        "for" => "how long a fault lasts",
        "lose" => "messages are lost on their way: those of state topics for good, events until they are sent again",
        "violate" => "messages are lost for good, events too",
        "delay" => "messages take a time, or one between two times",
        "jitter" => "messages take longer by a time up to this one",
        "duplicate" => "messages come twice",
        "reorder" => "messages are overtaken by others",
        "cut" => "components hear nothing `from` others",
        "part" => "two groups of components hear nothing of each other",
        "stall" => "the next execution of a component takes as long as the fault lasts",
        "fail" => "the next execution of a component fails, which its `restart` handles",
        "crash" => "a component ends without a shutdown, and starts again after `restart`, or never",
        "drift" => "the clock of a component is too fast by this part, or too slow",
        "on" => "the only topic whose messages a fault concerns",
        "to" => {
            "the other end: the destination of luggage, the readers of a fault's messages, the greater time of `delay`"
        }
        "restart" => "the time after which a component that crashed starts again",
        "end" => "nothing happens; the run does not end before this time",
        _ => "",
    }
}
