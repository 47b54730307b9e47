//! How a fault is written.

use std::ops::Range;
use std::time::Duration;

use super::{FAULTS, FaultCall, FaultKind, LASTING, Rate};
use crate::event::Word;
use crate::extension::LineFault;
use crate::rule::nearest;
use crate::time::{meant_duration, parse_duration};

const TIME: &str = "a time such as `300ms` or `2s`";
const RATE: &str = "a part of the messages such as `20 %`";
const COMPONENTS: &str = "a component such as `Robot2`, or several: `Robot*, World`";
/// The most that a clock goes faster or slower, in millionths.
const MOST_DRIFT: u32 = 500_000;

impl FaultCall {
    /// Reads a fault. Places are bytes of the text.
    ///
    /// # Errors
    /// The first word that is wrong.
    pub fn read(text: &str) -> Result<FaultCall, LineFault> {
        let mut words = Words { text, words: words(text), at: 0 };
        let lasting = words.take(LASTING).map(|_| words.lasting()).transpose()?;
        let expected = format!("a fault: `{}`", FAULTS.join("`, `"));
        let first = words.next(&expected)?;
        let word = words.text(&first);
        let wrong = |fault: LineFault| match nearest(word, FAULTS) {
            Some(meant) => fault.instead(meant),
            None => fault,
        };
        let kind = match word {
            "lose" => FaultKind::Lose(words.rate()?),
            "violate" => FaultKind::Violate(words.rate()?),
            "delay" => words.delay()?,
            "jitter" => FaultKind::Jitter(words.time()?),
            "duplicate" => FaultKind::Duplicate(words.rate()?),
            "reorder" => {
                let rate = words.rate()?;
                words.expect("by", "`by` and the time by which they come later at most, as in `by 200ms`")?;
                FaultKind::Reorder(rate, words.time()?)
            }
            "cut" => FaultKind::Cut,
            "part" => FaultKind::Part,
            "stall" => FaultKind::Stall,
            "fail" => FaultKind::Fail,
            "crash" => FaultKind::Crash { restart: None },
            "drift" => FaultKind::Drift(0),
            _ => return Err(wrong(words.wrong(first.clone(), &expected))),
        };
        let mut call = FaultCall { lasting, bytes: first.clone(), ..FaultCall::new(kind) };
        match kind {
            FaultKind::Cut | FaultKind::Part => {
                call.to = words.names()?;
                words.expect("from", "`from` and the components from which they are cut off")?;
                call.from = words.names()?;
                call.topic = words.topic()?;
            }
            FaultKind::Stall | FaultKind::Fail => call.to = words.names()?,
            FaultKind::Crash { .. } => {
                call.to = words.names()?;
                let restart = words.take("restart").map(|_| words.time()).transpose()?;
                call.kind = FaultKind::Crash { restart };
            }
            FaultKind::Drift(_) => {
                call.to = words.names()?;
                call.kind = FaultKind::Drift(words.drift()?);
            }
            _ => {
                call.topic = words.topic()?;
                if words.take("from").is_some() {
                    call.from = words.names()?;
                }
                if words.take("to").is_some() {
                    call.to = words.names()?;
                }
            }
        }
        words.end()?;
        match (kind, lasting) {
            (FaultKind::Stall, None) => {
                let fault = LineFault::new(first, "found `stall` without how long it lasts");
                Err(fault.help(format!("write `{LASTING}` and a time before it, as in `{LASTING} 2s stall ...`")))
            }
            (FaultKind::Fail | FaultKind::Crash { .. }, Some(_)) => {
                let message = format!("found `{LASTING}` before `{word}`, which happens once");
                let start = text.len() - text.trim_start().len();
                let fault = LineFault::new(start..start + LASTING.len(), message);
                Err(fault.help("remove it and its time; `crash` has the time to its `restart` behind it"))
            }
            _ => Ok(call),
        }
    }
}

/// The words of a text with their bytes; a comma is one of them.
fn words(text: &str) -> Vec<Range<usize>> {
    let mut words: Vec<Range<usize>> = Vec::new();
    let mut start = None;
    for (at, sign) in text.char_indices().chain([(text.len(), ' ')]) {
        let is_comma = sign == ',';
        if sign.is_whitespace() || is_comma {
            words.extend(start.take().map(|start| start..at));
            words.extend(is_comma.then_some(at..at + 1));
        } else {
            start.get_or_insert(at);
        }
    }
    words
}

struct Words<'t> {
    text: &'t str,
    words: Vec<Range<usize>>,
    at: usize,
}

impl<'t> Words<'t> {
    fn text(&self, bytes: &Range<usize>) -> &'t str {
        &self.text[bytes.clone()]
    }

    fn peek(&self) -> &'t str {
        self.words.get(self.at).map_or("", |bytes| self.text(bytes))
    }

    fn next(&mut self, expected: &str) -> Result<Range<usize>, LineFault> {
        let end = self.text.trim_end().len();
        let missing = || LineFault::new(end..end, format!("found the end of the line, expected {expected}"));
        let word = self.words.get(self.at).cloned().ok_or_else(missing)?;
        self.at += 1;
        Ok(word)
    }

    fn take(&mut self, word: &str) -> Option<Range<usize>> {
        let found = self.words.get(self.at).cloned().filter(|bytes| self.text(bytes) == word)?;
        self.at += 1;
        Some(found)
    }

    fn wrong(&self, bytes: Range<usize>, expected: &str) -> LineFault {
        let found = self.text(&bytes).to_owned();
        LineFault::new(bytes, format!("found `{found}`, expected {expected}"))
    }

    fn expect(&mut self, word: &str, expected: &str) -> Result<(), LineFault> {
        let found = self.next(expected)?;
        if self.text(&found) == word { Ok(()) } else { Err(self.wrong(found, expected)) }
    }

    fn end(&mut self) -> Result<(), LineFault> {
        let Some(more) = self.words.get(self.at).cloned() else { return Ok(()) };
        let fault = self.wrong(more.clone(), "the end of the line");
        let links = ["on", "from", "to", "restart", "by"];
        Err(match self.text(&more) {
            word if links.contains(&word) => {
                fault.help("the order is `on TOPIC from COMPONENTS to COMPONENTS`, each once")
            }
            word => nearest(word, links).map_or(fault.clone(), |meant| fault.instead(meant)),
        })
    }

    fn time(&mut self) -> Result<Duration, LineFault> {
        let first = self.next(TIME)?;
        // A blank may separate the number from its unit.
        let is_unit = ["ns", "us", "ms", "s", "min", "h"].contains(&self.peek());
        let last = if is_unit { self.next(TIME)? } else { first.clone() };
        let bytes = first.start..last.end;
        let written = self.text(&bytes);
        if !written.starts_with(|sign: char| sign.is_ascii_digit() || sign == '.') {
            return Err(self.wrong(bytes, TIME));
        }
        parse_duration(written).map_err(|message| {
            let fault = LineFault::new(bytes, message);
            meant_duration(written).map_or(fault.clone(), |meant| fault.instead(meant))
        })
    }

    /// How long a fault lasts, behind `for`.
    fn lasting(&mut self) -> Result<Duration, LineFault> {
        let first = self.at;
        let lasting = self.time()?;
        if lasting.is_zero() {
            let bytes = self.words[first].start..self.words[self.at - 1].end;
            let fault = self.wrong(bytes, "a time above 0: a fault that lasts no time does nothing");
            return Err(fault.help(format!("write a time such as `{LASTING} 2s`")));
        }
        Ok(lasting)
    }

    fn delay(&mut self) -> Result<FaultKind, LineFault> {
        let least = self.time()?;
        let is_range = self.peek() == "to"
            && self
                .words
                .get(self.at + 1)
                .is_some_and(|next| self.text(next).starts_with(|one: char| one.is_ascii_digit()));
        if !is_range {
            return Ok(FaultKind::Delay(least, least));
        }
        self.at += 1;
        let start = self.words[self.at].start;
        let most = self.time()?;
        if most < least {
            let bytes = start..self.words[self.at - 1].end;
            return Err(self.wrong(bytes, "the greater time second, as in `delay 50ms to 300ms`"));
        }
        Ok(FaultKind::Delay(least, most))
    }

    /// A number, which may have `%` behind it, with its bytes.
    fn number(&mut self, expected: &str) -> Result<(Option<Rate>, Range<usize>), LineFault> {
        let first = self.next(expected)?;
        let written = self.text(&first);
        let (number, mut is_percent) = match written.strip_suffix('%') {
            Some(number) => (number, true),
            None => (written, false),
        };
        let mut bytes = first;
        if !is_percent && let Some(sign) = self.take("%") {
            (is_percent, bytes.end) = (true, sign.end);
        }
        Ok((Rate::read(number, is_percent), bytes))
    }

    fn rate(&mut self) -> Result<Rate, LineFault> {
        let (rate, bytes) = self.number(RATE)?;
        match rate {
            Some(rate) if rate <= Rate::ALL => Ok(rate),
            Some(rate) => {
                let fault = self.wrong(bytes.clone(), "a part from 0 % to 100 %, or from 0 to 1");
                let is_plain = !self.text(&bytes).ends_with('%') && rate.per_million() <= 100 * Rate::ALL.per_million();
                let meant = format!("{} %", self.text(&bytes));
                Err(if is_plain { fault.instead(meant) } else { fault })
            }
            None => Err(self.wrong(bytes, &format!("{RATE}, from 0 % to 100 %"))),
        }
    }

    fn drift(&mut self) -> Result<i32, LineFault> {
        const DRIFT: &str = "by how much its clock is too fast, such as `2 %`, or too slow, such as `-2 %`";
        let start = self.at;
        let (_, bytes) = self.number(DRIFT)?;
        let written = self.text(&bytes);
        let (sign, number) = match written.strip_prefix('-') {
            Some(number) => (-1, number),
            None => (1, written.trim_start_matches('+')),
        };
        let is_percent = number.ends_with('%');
        let rate = Rate::read(number.trim_end_matches('%').trim_end(), is_percent);
        match rate.map(Rate::per_million).filter(|millionths| *millionths <= MOST_DRIFT) {
            Some(millionths) => Ok(sign * i32::try_from(millionths).unwrap_or_default()),
            None => {
                let most = Rate::of_millionths(MOST_DRIFT);
                let bytes = self.words[start].start..bytes.end;
                Err(self.wrong(bytes, &format!("{DRIFT}, at most {most}")))
            }
        }
    }

    fn topic(&mut self) -> Result<Option<Word>, LineFault> {
        if self.take("on").is_none() {
            return Ok(None);
        }
        let bytes = self.next("a topic after `on`")?;
        Ok(Some(Word { text: self.text(&bytes).to_owned(), bytes }))
    }

    fn names(&mut self) -> Result<Vec<Word>, LineFault> {
        let mut names = Vec::new();
        loop {
            let bytes = self.next(COMPONENTS)?;
            if self.text(&bytes) == "," {
                return Err(self.wrong(bytes, COMPONENTS));
            }
            names.push(Word { text: self.text(&bytes).to_owned(), bytes });
            if self.take(",").is_none() {
                return Ok(names);
            }
        }
    }
}
