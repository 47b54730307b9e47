use std::time::Duration;

use saoms_api::event::fault::{FAULTS, FaultCall};
use saoms_api::host::{meant_duration, parse_duration};
use saoms_api::rule::nearest;

use super::random::RandomRange;
use super::tokenizer::Tokenizer;
use super::vocabulary::Vocabulary;
use super::{Before, Line, event, meant};
use crate::text::TextFault;

pub(super) const STARTS: [&str; 3] = ["at", "from", "then"];
pub(super) const UNITS: [&str; 6] = ["ns", "us", "ms", "s", "min", "h"];
const TIME: &str = "a time such as `6s` or `500ms`";
/// Maximum number of events of a line with `times`.
const MOST: u64 = 1_000_000;
/// Minimum time between two events of a line: a line must not flood the fleet.
const LEAST: Duration = Duration::from_millis(1);

/// Events that a line can repeat.
const REPEATED: &str =
    "as in `from 10s every 5s until 60s luggage (3,1) to (3,10)`, or `from 10s every 5s 100 times landing 2`";

/// The non-empty lines of a text, without comments. Lines end at a line end or `;`.
pub(in crate::environment) fn split(text: &str) -> impl Iterator<Item = &str> {
    text.lines().map(without_comment).flat_map(parts).filter(|line| !line.trim().is_empty())
}

/// The line up to `#`, which may stand in quotes.
fn without_comment(line: &str) -> &str {
    let mut is_quoted = false;
    let start = line.find(|sign: char| {
        is_quoted ^= sign == '"';
        sign == '#' && !is_quoted
    });
    &line[..start.unwrap_or(line.len())]
}

/// The parts of a text between `;`. One between the numbers of a block is a slip, and ends nothing; nor does one in
/// quotes.
fn parts(line: &str) -> impl Iterator<Item = &str> {
    let (mut open, mut is_quoted) = (false, false);
    line.split(move |sign: char| {
        is_quoted ^= sign == '"';
        match sign {
            _ if is_quoted => return false,
            '(' => open = true,
            ';' if open => return false,
            sign if !sign.is_ascii_digit() && sign != ' ' => open = false,
            _ => {}
        }
        sign == ';'
    })
}

/// Reads a line that may start with its event: the event happens now then, and the flag is true.
pub(in crate::environment) fn read_outside(
    line: &str,
    before: Before,
    vocabulary: Vocabulary<'_>,
) -> Result<(Line, bool), TextFault> {
    let mut words = Tokenizer::of(line, line);
    let first = words.peek().unwrap_or_default();
    if STARTS.contains(&first) {
        return read_line(line, line, before, vocabulary).map(|line| (line, false));
    }
    if !FaultCall::is_one(first) && vocabulary.names().all(|name| name != first) {
        let near = nearest(first, vocabulary.names().chain(STARTS).chain(FAULTS));
        let expected = "an event, `at`, `from` or `then` at the start of a line";
        return Err(words.wrong(first, expected).instead(near));
    }
    let bytes = words.bytes(first);
    let event = event::read(&mut words, vocabulary)?;
    let (time, every) = (RandomRange::fixed(Duration::ZERO), RandomRange::fixed(Duration::ZERO));
    let line = Line { text: 0, time, follows: false, every, times: Some(1), until: None, event, bytes };
    Ok((line, true))
}

/// Reads a line of the text of a scenario.
pub(super) fn read(text: &str, line: &str, before: Before, vocabulary: Vocabulary<'_>) -> Result<Line, TextFault> {
    read_line(text, line, before, vocabulary).map_err(|fault| {
        let Some(site) = site(line) else {
            let fault = meant::proposed(text, line, (before, vocabulary), fault);
            return match fault.instead.is_none() && fault.help.is_none() {
                true => fault.help(event::example(line)),
                false => fault,
            };
        };
        let message = format!("found the site `{site}`, which is allowed only before events from outside (`--events`)");
        let fault = Tokenizer::of(text, line).fault(site, message);
        fault.help("remove it: the events of a scenario are for the site of its environment")
    })
}

/// The site that a line names, with its colon, as events from outside do.
fn site(line: &str) -> Option<&str> {
    let before = &line[..line.find(':')?];
    let name = before.split_whitespace().last().filter(|name| name.starts_with(char::is_alphabetic))?;
    let is_word = STARTS.iter().chain(&event::KINDS).chain(&["every", "until", "times"]).any(|word| *word == name);
    let start = before.trim_end().len() - name.len();
    (!is_word).then(|| &line[start..=before.len()])
}

pub(super) fn read_line(text: &str, line: &str, before: Before, vocabulary: Vocabulary<'_>) -> Result<Line, TextFault> {
    let mut words = Tokenizer::of(text, line);
    let start = words.next("`at`, `from` or `then`")?;
    if !STARTS.contains(&start) {
        let time = start.strip_prefix('@').unwrap_or(start);
        let near = match start {
            "on" | "in" | "after" | "when" => Some("at".to_owned()),
            _ if parse_duration(time).is_ok() => Some(format!("at {time}")),
            _ => nearest(start, STARTS).map(str::to_owned),
        };
        let fault = words.wrong(start, "`at`, `from` or `then` at the start of a line").instead(near);
        if FaultCall::is_one(start) || vocabulary.names().any(|name| name == start) {
            return Err(fault.help(format!("write the time first, as in `at 6s {start} ...`")));
        }
        return Err(fault.help("write a line such as `at 6s luggage (3,1) to (3,10)` or `then 500ms landing 4`"));
    }
    if start == "then" && before == Before::Start {
        let message = "found `then` in the first line: there is no event before it to count from";
        let is_repeated = line.split_whitespace().any(|word| word == "every");
        return Err(words.fault(start, message).instead(Some(if is_repeated { "from" } else { "at" })));
    }
    if start == "then" && before == Before::Endless {
        let message = "the line before never ends, so no event can follow it";
        return Err(words.fault(start, message).help("add an end: `100 times`, or `until 60s`"));
    }
    if let (Some("every"), Some(often), "at") = (words.peek(), words.peek_second(), start) {
        let fault = words.wrong(line[..words.end_of_next()].trim(), "a time after `at`");
        return Err(fault.instead(Some(format!("from {often} every"))).help(REPEATED));
    }
    let time = drawn(&mut words, time)?;
    let every = words.take("every").then(|| every(&mut words)).transpose()?;
    if every.is_none() && start == "from" {
        let is_repeated = line.split_whitespace().any(|word| word == "every");
        if let Some(next) = words.peek().filter(|next| is_repeated || matches!(*next, "until" | "till" | "to")) {
            let message = match is_repeated {
                true => format!("found `{next}` before `every`; `every` comes directly after the first time"),
                false => format!("found `{next}` without `every`, which says how often this happens"),
            };
            return Err(words.fault(next, message).help(REPEATED));
        }
        let message = "expected `every` after `from` and its time; an event that happens once starts with `at`";
        return Err(words.fault(start, message).instead(Some("at")));
    }
    if every.is_some() && start == "at" {
        let message = "found `every` after `at`; an event that is repeated starts with `from`";
        return Err(words.fault(start, message).instead(Some("from")));
    }
    let given = if words.peek_second() == Some("times") { Some(times(&mut words)?) } else { None };
    let until = if words.take("until") { Some(until(&mut words, every.is_some(), start, time)?) } else { None };
    let first = words.peek().unwrap_or_default();
    if words.peek_second() == Some("luggage") && first.parse::<u64>().is_ok() {
        let message = format!("found `{first}` before `luggage`, expected a number of times, such as `{first} times`");
        return Err(words.fault(first, message).instead(Some(format!("{first} times"))));
    }
    if let Some(other) =
        words.peek_second().filter(|other| matches!(*other, "time" | "x") && first.parse::<u64>().is_ok())
    {
        return Err(words.wrong(other, "`times` after the number of times").instead(Some("times")));
    }
    let bytes = words.bytes(first);
    let event = event::read(&mut words, vocabulary)?;
    let times = if every.is_none() { Some(given.unwrap_or(1)) } else { given };
    let every = every.unwrap_or(RandomRange::fixed(Duration::ZERO));
    Ok(Line { text: 0, time, follows: start == "then", every, times, until, event, bytes })
}

fn every(words: &mut Tokenizer<'_>) -> Result<RandomRange<Duration>, TextFault> {
    let first = words.peek().unwrap_or_default();
    let every = drawn(words, time)?;
    if every.least < LEAST {
        let span = words.span(first, words.last());
        return Err(words.fault(span, format!("found `{span}` after `every`, expected at least 1ms")));
    }
    Ok(every)
}

fn times(words: &mut Tokenizer<'_>) -> Result<u64, TextFault> {
    let number = words.next("a number")?;
    words.take("times");
    match number.parse() {
        Ok(times @ 1..=MOST) => Ok(times),
        _ => Err(words.wrong(number, &format!("the number of times: a whole number from 1 to {MOST}"))),
    }
}

fn until(
    words: &mut Tokenizer<'_>,
    repeats: bool,
    start: &str,
    first: RandomRange<Duration>,
) -> Result<Duration, TextFault> {
    let until = words.last();
    if !repeats {
        return Err(words.fault(until, "found `until` without `every`: this happens once").help(REPEATED));
    }
    let at = words.peek().unwrap_or_default();
    let end = time(words)?;
    if start == "from" && end < first.least {
        let span = words.span(at, words.last());
        return Err(words.fault(span, format!("found `until {span}`, which is before the first event")));
    }
    Ok(end)
}

/// Reads a time; a blank may separate the number from its unit.
fn time(words: &mut Tokenizer<'_>) -> Result<Duration, TextFault> {
    let first = words.next(TIME)?;
    if words.peek().is_some_and(|unit| UNITS.contains(&unit)) {
        words.next(TIME)?;
    }
    if let Some(unit) = words.peek().filter(|unit| unit.starts_with(char::is_alphabetic)) {
        let span = words.span(first, unit);
        if let Some(meant) = meant_duration(span).filter(|_| parse_duration(first).is_ok()) {
            return Err(words.wrong(span, TIME).instead(Some(meant)));
        }
    }
    let span = words.span(first, words.last());
    if !span.starts_with(|sign: char| sign.is_ascii_digit() || matches!(sign, '-' | '+' | '.')) {
        return Err(words.wrong(first, TIME));
    }
    if let Some(positive) = span.strip_prefix('-').filter(|span| parse_duration(span).is_ok()) {
        let message = format!("found `{span}`, which is before the start of the scenario: expected a time from 0s on");
        return Err(words.fault(span, message).instead(Some(positive.trim())));
    }
    parse_duration(span).map_err(|message| words.fault(span, message).instead(meant_time(span)))
}

/// The time that is meant by one that is none. Of an event, `m` is for minutes.
fn meant_time(span: &str) -> Option<String> {
    let minutes = span.strip_suffix('m').map(|number| format!("{}min", number.trim()));
    minutes.filter(|minutes| parse_duration(minutes).is_ok()).or_else(|| meant_duration(span))
}

/// Reads one value, or two with `..` between them.
pub(super) fn drawn<'a, T: Copy + PartialOrd>(
    words: &mut Tokenizer<'a>,
    one: impl Fn(&mut Tokenizer<'a>) -> Result<T, TextFault>,
) -> Result<RandomRange<T>, TextFault> {
    let start = words.peek().unwrap_or_default();
    let least = one(words)?;
    let first = words.span(start, words.last());
    if !words.take_dots()? {
        return Ok(RandomRange::fixed(least));
    }
    let start = words.peek().unwrap_or_default();
    let most = one(words)?;
    let second = words.span(start, words.last());
    if most < least {
        let span = words.span(first, second);
        let message = format!("found `{span}`, expected the smaller value first");
        return Err(words.fault(span, message).instead(Some(format!("{second}..{first}"))));
    }
    Ok(RandomRange { least, most })
}
