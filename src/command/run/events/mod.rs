//! `saoms run --events`: events from outside, a line each, while the fleet runs.

mod input;
mod journal;

use std::convert::Infallible;
use std::io::{self, BufRead, Read};
use std::path::{self, Path};
use std::sync::Arc;
use std::sync::atomic::AtomicU32;
use std::sync::mpsc::{self, RecvTimeoutError};
use std::thread;
use std::time::Duration;

use saoms_api::event::fault::FaultCall;
use saoms_api::event::{EventCall, Events as EventNames, ORDERS};
use saoms_api::extension::{EventContent, EventLanguage, EventReader, EventSource, LineFault, TimedMessage};
use saoms_api::host::is_invisible;
use saoms_api::rule::nearest;
use saoms_api::{Level, Time};
use saoms_core::schedule::{
    Handle, Hold, InjectError, InjectedContent, Injection, Order, OrderTicket, RaiseError, TimedOrder,
};
use saoms_core::status::FleetPhase;
use saoms_lang::load::wide_encoding;

pub(super) use input::Unreadable;

/// Time between two looks for a signal while lines are read before the start.
const BETWEEN_LOOKS: Duration = Duration::from_millis(50);

/// The most bytes of a line.
const LONGEST: usize = 65_536;

/// Lines of events that are not read yet.
pub(super) struct Events {
    lines: Box<dyn BufRead + Send>,
    languages: Languages,
    /// The number of the line that was read last, from 1.
    number: usize,
    /// The name under which the memory of the fleet has how many lines of a file were taken.
    cursor: Option<String>,
}

/// Time between two looks whether the disk has space again, while lines wait for that.
const BETWEEN_TRIES: Duration = Duration::from_millis(100);

impl Events {
    /// Opens a file, or standard input where the path is `-`.
    ///
    /// # Errors
    /// Why it cannot be read.
    pub(super) fn open(path: &Path, numbers: &Numbers) -> Result<Events, Unreadable> {
        let lines = input::open(path)?;
        let languages = Languages::of(("(outside)", "a line of `--events`"), numbers);
        let cursor = path.is_file().then(|| format!("events {}", path::absolute(path).unwrap_or_default().display()));
        Ok(Events { lines, languages, number: 0, cursor })
    }

    /// Lets events happen in a fleet that has just started. In virtual time all lines are read first, so that the same
    /// lines give the same run, unless a signal ends it before; in real time they are read as they come, and the run
    /// lasts at least to their end.
    pub(super) fn play(mut self, handle: Handle, is_virtual: bool, is_signalled: impl Fn() -> bool) {
        let (hold, fleet): (Option<Hold>, Handle) = ((!is_virtual).then(|| handle.hold()), handle.clone());
        let (reads, is_read) = mpsc::channel::<Infallible>();
        let read = move || {
            self.read_all(&fleet);
            drop((hold, reads));
        };
        if let Err(error) = thread::Builder::new().name("events".to_owned()).spawn(read) {
            return handle.note(Level::Error, format!("no events are read: {error}"));
        }
        while is_virtual && !is_signalled() {
            if is_read.recv_timeout(BETWEEN_LOOKS) == Err(RecvTimeoutError::Disconnected) {
                return;
            }
        }
    }

    fn read_all(&mut self, handle: &Handle) {
        let mut line = Vec::new();
        let cursor = self.cursor.take();
        let taken = cursor.as_ref().map_or(0, |cursor| handle.counter(cursor));
        loop {
            match self.next(&mut line) {
                Ok(false) => return,
                // An earlier program took it.
                Ok(true) if self.number as u64 <= taken => {}
                Ok(true) => {
                    wait_for_space(handle);
                    let together = handle.together();
                    if cursor.is_some() && together.is_too_late() {
                        // The next program takes it.
                        return;
                    }
                    self.take(&line, handle);
                    if let Some(cursor) = &cursor {
                        handle.set_counter(cursor, self.number as u64);
                    }
                }
                Err(error) => {
                    return handle.note(Level::Error, format!("the events cannot be read any more: {error}"));
                }
            }
        }
    }

    /// Reads the next line, at most one byte more than the limit, which shows that it is too long. `false` is the end.
    fn next(&mut self, line: &mut Vec<u8>) -> io::Result<bool> {
        line.clear();
        self.number += 1;
        let count = (&mut self.lines).take(LONGEST as u64 + 1).read_until(b'\n', line)?;
        if line.last() == Some(&b'\n') {
            line.pop();
        } else if count > LONGEST {
            self.lines.skip_until(b'\n')?;
        }
        if self.number == 1 {
            // What comes as it is written is not looked at when it is opened.
            if let Some(encoding) = wide_encoding(line) {
                return Err(io::Error::other(format!("they are in {encoding}, expected UTF-8")));
            }
            if line.starts_with(input::MARK) {
                line.drain(..input::MARK.len());
            }
        }
        Ok(count > 0)
    }

    /// Lets the events of a line happen, or reports its fault.
    fn take(&mut self, line: &[u8], handle: &Handle) {
        let now = handle.progress().time;
        let result = if line.len() > LONGEST {
            Err(format!("found more than {LONGEST} bytes in one line"))
        } else {
            match std::str::from_utf8(line) {
                // A line of a journal: what came from outside happens again, and the rest follows from it.
                Ok(text) if text.starts_with('{') => match journal::event(text) {
                    Ok(event) => event.map_or(Ok(0), |event| self.languages.happen(&event, now, handle)),
                    Err(problem) => Err(problem),
                },
                Ok(text) => self.languages.happen(text.trim_end_matches('\r'), now, handle),
                Err(_) => Err("found bytes that are not UTF-8".to_owned()),
            }
        };
        match result {
            Ok(count) => handle.count("events.taken", count),
            Err(problem) => {
                handle.count("events.ignored", 1);
                handle.note(Level::Error, format!("line {} of the events is ignored: {problem}", self.number));
            }
        }
    }
}

/// Waits as long as no new work is accepted.
fn wait_for_space(handle: &Handle) {
    while handle.refusal_of_work().is_some() && handle.phase() == FleetPhase::Running {
        thread::sleep(BETWEEN_TRIES);
    }
}

/// What the events of all sources of a run number together.
#[derive(Clone, Debug)]
pub(super) struct Numbers {
    seed: u64,
    numbers: Arc<AtomicU32>,
}

impl Numbers {
    pub(super) fn new(seed: u64) -> Numbers {
        Numbers { seed, numbers: Arc::default() }
    }

    /// Has the numbers outlive the program, so that none is given twice.
    pub(super) fn outlive(&self, handle: &Handle) {
        handle.share_counter("numbers of events", &self.numbers);
    }
}

/// The languages of events for one source of lines.
pub(super) struct Languages {
    /// The topic of each language and its reader.
    readers: Vec<(&'static str, Box<dyn EventReader>)>,
}

/// What came of a line of an operator.
pub(super) enum Sent {
    /// The number of its events.
    Events(i64),
    /// It was an order, which takes effect at the next instant, or at a later time.
    Order(OrderTicket, Option<Time>),
}

impl Languages {
    /// The languages for a source of this name, from which its chance follows; the second text is what messages call
    /// one of its lines.
    pub(super) fn of((name, line): (&'static str, &'static str), Numbers { seed, numbers }: &Numbers) -> Languages {
        let source = || EventSource { name, line, seed: *seed, numbers: Arc::clone(numbers) };
        let reader = |one: &EventLanguage| (one.topic.name, (one.new)(source()));
        Languages { readers: EventLanguage::linked().map(reader).collect() }
    }

    /// Lets the events of a line that an operator sent happen, or gives its order.
    ///
    /// # Errors
    /// What is wrong with the line.
    pub(super) fn send(&mut self, line: &str, handle: &Handle) -> Result<Sent, String> {
        let line = line.trim();
        if line.contains(['\n', '\r']) {
            return Err("found several lines, expected one line, with `;` between events".to_owned());
        }
        let now = handle.progress().time;
        let order = Order::read(line);
        let is_work = order
            .as_ref()
            .is_none_or(|order| order.as_ref().is_ok_and(|timed| matches!(timed.order, Order::Publish { .. })));
        if let Some(refusal) = handle.refusal_of_work().filter(|_| is_work) {
            return Err(refusal);
        }
        let _together = handle.together();
        let sent = match order {
            Some(order) => order_given(line, order, handle).map(|(ticket, at)| Sent::Order(ticket, at)),
            None => self.events(line, now, handle).map(Sent::Events),
        };
        let count = if let Ok(Sent::Events(count)) = &sent { *count } else { i64::from(sent.is_ok()) };
        handle.count("events.taken", count);
        sent
    }

    /// Lets the events of a line happen, or its order, and counts them.
    fn happen(&mut self, line: &str, now: Time, handle: &Handle) -> Result<i64, String> {
        match Order::read(line) {
            Some(order) => order_given(line, order, handle).map(|_| 1),
            None => self.events(line, now, handle),
        }
    }

    /// Lets the events of a line happen, and counts them. A site may stand before the event: `North: at 3s ...`.
    fn events(&mut self, line: &str, now: Time, handle: &Handle) -> Result<i64, String> {
        let (site, event) = site_of(line);
        let before = line.len() - event.len();
        let takers = handle.takers();
        let read = self.read(event, now, takers.events());
        let (topic, messages) = read.map_err(|fault| shown(line, &or_order(line, fault.moved(before))))?;
        let count = i64::try_from(messages.len()).unwrap_or(i64::MAX);
        for message in messages {
            happen(message, (site, topic), handle)?;
        }
        Ok(count)
    }

    /// The events of a line without a site, and the topic of its language.
    pub(super) fn read(
        &mut self,
        event: &str,
        now: Time,
        known: &EventNames,
    ) -> Result<(&'static str, Vec<TimedMessage>), LineFault> {
        let mut problem = None;
        for (topic, reader) in &mut self.readers {
            match reader.read(event, now, known) {
                Ok(messages) => return Ok((*topic, messages)),
                Err(fault) => problem = problem.or(Some(fault)),
            }
        }
        Err(problem.unwrap_or_else(|| LineFault::new(0..event.len(), "no class of this program takes events")))
    }
}

/// Gives an order.
fn order_given(
    line: &str,
    order: Result<TimedOrder, LineFault>,
    handle: &Handle,
) -> Result<(OrderTicket, Option<Time>), String> {
    let TimedOrder { at, order } = order.map_err(|fault| shown(line, &fault))?;
    let ticket = handle.order(order, at).map_err(|error| error.to_string())?;
    Ok((ticket, at))
}

/// A fault of a word that is nearly one of an order.
fn or_order(line: &str, fault: LineFault) -> LineFault {
    let word = line.get(fault.bytes.clone()).unwrap_or_default();
    match nearest(word, ORDERS) {
        Some(order) if fault.instead.is_none() && !word.is_empty() => fault.instead(order),
        _ => fault,
    }
}

/// The site before an event, and the rest of the line.
pub(super) fn site_of(line: &str) -> (&str, &str) {
    // A colon may be part of a value, too.
    match line.split_once(':') {
        Some((site, event)) if !site.contains(['=', '"']) => (site.trim(), event),
        _ => ("", line),
    }
}

/// Lets one event happen.
pub(super) fn happen(message: TimedMessage, (site, language): (&str, &str), handle: &Handle) -> Result<(), String> {
    let TimedMessage { at, content, text } = message;
    let line = if site.is_empty() { text.clone() } else { format!("{site}: {text}") };
    match content {
        EventContent::Bytes(bytes) => {
            let topic = topic_of(site, language);
            let injection = Injection { topic, content: InjectedContent::Bytes(bytes), at, text: line };
            handle.inject(injection).map_err(|error| refused(site, language, &error))
        }
        EventContent::Raised if FaultCall::is_one(&text) => {
            let call = FaultCall::read(&text).map_err(RaiseError::Wrong);
            let begun = call.and_then(|call| handle.disturb(site, &call, at, line));
            begun.map_err(|error| raise_error(&text, error))
        }
        EventContent::Raised => {
            let raised = EventCall::read(&text).map_err(RaiseError::Wrong);
            let raised = raised.and_then(|call| handle.raise(site, &call, at, line));
            raised.map_err(|error| raise_error(&text, error))
        }
    }
}

fn raise_error(text: &str, error: RaiseError) -> String {
    match error {
        RaiseError::Wrong(fault) => shown(text, &fault),
        RaiseError::Ending => error.to_string(),
    }
}

/// Checks that components take the events of a language in this site; the topics are those of the fleet.
///
/// # Errors
/// The reason why they do not, with the sites that there are.
pub(super) fn known_site(site: &str, language: &str, topics: &[String]) -> Result<(), String> {
    let topic = topic_of(site, language);
    if topics.contains(&topic) { Ok(()) } else { Err(unknown_site(site, language, topics)) }
}

/// The topic of the events of a language in a site.
fn topic_of(site: &str, language: &str) -> String {
    if site.is_empty() { language.to_owned() } else { format!("{site}/{language}") }
}

/// The reason why an event for a site, or for a fleet without sites, does not happen.
fn refused(site: &str, topic: &str, error: &InjectError) -> String {
    match error {
        InjectError::UnknownTopic { known, .. } => unknown_site(site, topic, known),
        _ => error.to_string(),
    }
}

/// The reason why nobody takes the events of a language in a site.
fn unknown_site(site: &str, language: &str, topics: &[String]) -> String {
    let of_site = |name: &String| name.strip_suffix(language)?.strip_suffix('/').map(str::to_owned);
    let sites: Vec<String> = topics.iter().filter_map(of_site).collect();
    // Who writes it behind the time means the word before the colon.
    let (before, site) = site.rsplit_once(char::is_whitespace).unwrap_or(("", site));
    let meant = sites.iter().find(|name| *name == site).map(String::as_str);
    let meant = meant.or_else(|| nearest(site, sites.iter().map(String::as_str)));
    match (site, sites.first()) {
        (_, Some(_))
            if !before.is_empty()
                && let Some(meant) = meant =>
        {
            format!("the site comes first: write `{meant}: {before} ...`")
        }
        ("", None) => format!("no component of the fleet takes such events: none reads topic `{language}`"),
        (site, None) => format!("this fleet has no sites: write the event without `{site}:`"),
        ("", Some(first)) => {
            let sites = sites.join(", ");
            format!(
                "this fleet has sites: write the site before the event, as in `{first}: at 3s ...`; the sites are \
                {sites}"
            )
        }
        (site, Some(_)) if let Some(meant) = meant => {
            format!("the fleet has no site `{site}`; did you mean `{meant}`?")
        }
        (site, Some(_)) => format!("the fleet has no site `{site}`; its sites are {}", sites.join(", ")),
    }
}

/// A fault with an excerpt of its line.
pub(super) fn shown(line: &str, fault: &LineFault) -> String {
    // What comes from outside must not steer the terminal, and stands above its mark.
    let plain = |text: &str| text.replace(is_invisible, " ");
    let (start, end) = (fault.bytes.start.min(line.len()), fault.bytes.end.min(line.len()));
    let before = line.get(..start).map_or(0, |text| text.chars().count());
    let marked = line.get(start..end).map_or(1, |text| text.chars().count().max(1));
    let mut text = plain(&fault.message);
    if let Some(instead) = &fault.instead {
        text.push_str(&format!("; did you mean `{}`?", plain(instead)));
    }
    text.push_str(&format!("\n    {}\n    {}{}", plain(line), " ".repeat(before), "^".repeat(marked)));
    if let Some(help) = &fault.help {
        text.push_str(&format!("\n    = help: {help}"));
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fault_is_shown_at_its_word_and_control_characters_are_not() {
        let line = "at 6s lugäge\u{1b}[2J (3,1)";
        let fault = LineFault {
            bytes: 6..13,
            message: "found `lugäge`".to_owned(),
            instead: Some("luggage".to_owned()),
            help: Some("look".to_owned()),
            code: None,
        };
        let expected =
            "found `lugäge`; did you mean `luggage`?\n    at 6s lugäge [2J (3,1)\n          ^^^^^^\n    = help: look";
        assert_eq!(shown(line, &fault), expected);
    }

    #[test]
    fn lines_that_are_too_long_are_read_to_their_end() {
        let text = format!("one\n{}\nthree", "x".repeat(3 * LONGEST));
        let lines = Box::new(io::Cursor::new(text));
        let mut events = Events {
            lines,
            languages: Languages::of(("(outside)", "a line of `--events`"), &Numbers::new(0)),
            number: 0,
            cursor: None,
        };
        let (mut line, mut lengths) = (Vec::new(), Vec::new());
        while events.next(&mut line).unwrap() {
            lengths.push(line.len());
        }
        assert_eq!(lengths, [3, LONGEST + 1, 5]);
    }
}
