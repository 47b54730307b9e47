use std::time::Duration;

use saoms_api::host::parse_duration;
use saoms_api::rule::nearest;

use super::draw::Drawn;
use super::words::Words;
use super::{Line, event};
use crate::text::TextFault;

pub(super) const STARTS: [&str; 3] = ["at", "from", "then"];
pub(super) const UNITS: [&str; 6] = ["ns", "us", "ms", "s", "min", "h"];
const TIME: &str = "a time such as `6s` or `500ms`";
/// The most events of a line that says how many.
const MOST: u64 = 1_000_000;
/// The least time from one event to the next: a line must not flood the fleet.
const LEAST: Duration = Duration::from_millis(1);

/// What happens again and again.
const REPEATED: &str =
    "as in `from 10s every 5s until 60s luggage (3,1) to (3,10)`, or `from 10s every 5s 100 times landing 2`";

/// The lines of a text with something in them: they end with the text's lines or `;`, comments are left out.
pub(in crate::environment) fn split(text: &str) -> impl Iterator<Item = &str> {
    let lines = text.lines().map(|line| line.split('#').next().unwrap_or_default());
    lines.flat_map(|line| line.split(';')).filter(|line| !line.trim().is_empty())
}

/// Reads a line that may begin with its event: then it happens now, and the flag says so.
pub(in crate::environment) fn read_outside(line: &str, endless: bool) -> Result<(Line, bool), TextFault> {
    let mut words = Words::of(line, line);
    let first = words.peek().unwrap_or_default();
    if STARTS.contains(&first) {
        return read(line, line, endless).map(|line| (line, false));
    }
    if !event::KINDS.contains(&first) {
        let near = nearest(first, event::KINDS.into_iter().chain(STARTS));
        let expected = "an event, `at`, `from` or `then` at the start of a line";
        return Err(words.wrong(first, expected).instead(near));
    }
    let bytes = words.bytes(first);
    let happening = event::read(&mut words)?;
    if let Some(more) = words.peek() {
        return Err(words.wrong(more, "the end of the line, or `;` before the next event"));
    }
    let (time, every) = (Drawn::fixed(Duration::ZERO), Drawn::fixed(Duration::ZERO));
    let line = Line { text: 0, time, follows: false, every, times: Some(1), until: None, happening, bytes };
    Ok((line, true))
}

/// Reads a line of the text. `endless` says that the line before has no last event.
pub(super) fn read(text: &str, line: &str, endless: bool) -> Result<Line, TextFault> {
    let mut words = Words::of(text, line);
    let start = words.next("`at`, `from` or `then`")?;
    if !STARTS.contains(&start) {
        let near = nearest(start, STARTS);
        let fault = words.wrong(start, "`at`, `from` or `then` at the start of a line").instead(near);
        return Err(fault.help("a line is such as `at 6s luggage (3,1) to (3,10)` or `then 500ms landing 4`"));
    }
    if start == "then" && endless {
        let message = "the line before never ends, so nothing comes after it";
        return Err(words.fault(start, message).help("end it: `100 times`, or `until 60s`"));
    }
    let time = drawn(&mut words, time)?;
    let every = words.take("every").then(|| every(&mut words)).transpose()?;
    if every.is_none() && start == "from" {
        let is_repeated = line.split_whitespace().any(|word| word == "every");
        if let Some(next) = words.peek().filter(|next| is_repeated || *next == "until") {
            let message = match is_repeated {
                true => format!("found `{next}` before `every`, which comes right behind the first time"),
                false => "found `until` without `every`: nothing says how often this happens".to_owned(),
            };
            return Err(words.fault(next, message).help(REPEATED));
        }
        let message = "found no `every` after `from` and its time: what happens once happens `at` a time";
        return Err(words.fault(start, message).instead(Some("at")));
    }
    if every.is_some() && start == "at" {
        let message = "found `every` after `at`: what happens again and again happens `from` a time on";
        return Err(words.fault(start, message).instead(Some("from")));
    }
    let given = if words.peek_second() == Some("times") { Some(times(&mut words)?) } else { None };
    let until =
        if words.take("until") { Some(until(&mut words, every.is_some(), start, time)?) } else { None };
    let bytes = words.bytes(words.peek().unwrap_or_default());
    let happening = event::read(&mut words)?;
    if let Some(more) = words.peek() {
        return Err(words.wrong(more, "the end of the line, or `;` before the next event"));
    }
    let times = if every.is_none() { Some(given.unwrap_or(1)) } else { given };
    let every = every.unwrap_or(Drawn::fixed(Duration::ZERO));
    Ok(Line { text: 0, time, follows: start == "then", every, times, until, happening, bytes })
}

fn every(words: &mut Words<'_>) -> Result<Drawn<Duration>, TextFault> {
    let first = words.peek().unwrap_or_default();
    let every = drawn(words, time)?;
    if every.least < LEAST {
        let span = words.span(first, words.last());
        return Err(words.fault(span, format!("found `{span}` after `every`, expected at least 1ms")));
    }
    Ok(every)
}

fn times(words: &mut Words<'_>) -> Result<u64, TextFault> {
    let number = words.next("a number")?;
    words.take("times");
    match number.parse() {
        Ok(times @ 1..=MOST) => Ok(times),
        _ => Err(words.wrong(number, &format!("how often it happens: a whole number from 1 to {MOST}"))),
    }
}

fn until(
    words: &mut Words<'_>,
    repeats: bool,
    start: &str,
    first: Drawn<Duration>,
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

/// A time; a unit may stand apart from its number.
fn time(words: &mut Words<'_>) -> Result<Duration, TextFault> {
    let first = words.next(TIME)?;
    if words.peek().is_some_and(|unit| UNITS.contains(&unit)) {
        words.next(TIME)?;
    }
    let span = words.span(first, words.last());
    if !span.starts_with(|sign: char| sign.is_ascii_digit() || matches!(sign, '-' | '+' | '.')) {
        return Err(words.wrong(first, TIME));
    }
    if let Some(positive) = span.strip_prefix('-').filter(|span| parse_duration(span).is_ok()) {
        let message =
            format!("found `{span}`, which is before the start of the scenario: expected a time from 0s on");
        return Err(words.fault(span, message).instead(Some(positive.trim())));
    }
    parse_duration(span).map_err(|message| words.fault(span, message).instead(short(span)))
}

/// A time whose unit is written out.
fn short(span: &str) -> Option<String> {
    let number = span.trim_end_matches(|letter: char| letter.is_ascii_alphabetic());
    let unit = match &span[number.len()..] {
        "msec" | "msecs" | "millis" | "millisecond" | "milliseconds" => "ms",
        "sec" | "secs" | "second" | "seconds" => "s",
        "mins" | "minute" | "minutes" => "min",
        "hr" | "hrs" | "hour" | "hours" => "h",
        _ => return None,
    };
    let short = format!("{}{unit}", number.trim());
    parse_duration(&short).is_ok().then_some(short)
}

/// One value, or two with `..` between them, from which one is drawn.
pub(super) fn drawn<'a, T: Copy + PartialOrd>(
    words: &mut Words<'a>,
    one: impl Fn(&mut Words<'a>) -> Result<T, TextFault>,
) -> Result<Drawn<T>, TextFault> {
    let start = words.peek().unwrap_or_default();
    let least = one(words)?;
    let first = words.span(start, words.last());
    if !words.take(super::words::DOTS) {
        return Ok(Drawn::fixed(least));
    }
    let start = words.peek().unwrap_or_default();
    let most = one(words)?;
    let second = words.span(start, words.last());
    if most < least {
        let span = words.span(first, second);
        let message = format!("found `{span}`, expected the lesser one first");
        return Err(words.fault(span, message).instead(Some(format!("{second}..{first}"))));
    }
    Ok(Drawn { least, most })
}
