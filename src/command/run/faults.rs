//! Faults from a file (`--faults`): lines of a scenario, which are read and judged before anything starts.

use std::fs;
use std::path::{self, Path};

use saoms_api::event::EventCall;
use saoms_api::event::fault::{FaultCall, FaultSubjects};
use saoms_api::extension::{EventContent, EventLanguage, LineFault, TimedMessage};
use saoms_api::host::format_duration;
use saoms_api::{Level, Time};
use saoms_core::schedule::{Handle, Takers};
use saoms_lang::assembly::{Assembly, ComponentSpec, fault_subjects, seen};
use saoms_lang::diagnostic::{Severity, SeverityLevel};
use saoms_lang::load::missing_file_help;

use super::events::{Languages, Numbers, happen, known_site, shown, site_of};
use crate::output::{counted, displayed, eprint};

/// The greatest size of such a file, in bytes.
const LARGEST: u64 = 1 << 20;

/// A file of faults that was read.
#[derive(Clone, Debug)]
pub(in crate::command) struct FaultScript {
    path: String,
    text: String,
}

/// A fault of a script, or another event of it, with its random values drawn.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(in crate::command) struct PlannedEvent {
    message: TimedMessage,
    site: String,
    topic: &'static str,
}

/// What a script does in a run.
#[derive(Clone, Debug)]
pub(in crate::command) struct Planned {
    /// Its events.
    pub(in crate::command) events: Vec<PlannedEvent>,
    /// Warnings about its lines, and what would be wrong with them but for severities that the command line sets; for
    /// people.
    pub(in crate::command) lowered: Vec<String>,
}

/// What the lines of a script can name.
#[derive(Debug)]
pub(in crate::command) struct Known {
    takers: Takers,
    /// By the site; empty for all.
    assembly: Assembly,
    /// Severities of the command line, as `CODE=LEVEL`.
    severities: Vec<String>,
}

impl Known {
    /// What is known of a fleet, and the severities that its command line sets.
    pub(in crate::command) fn of(assembly: &Assembly, severities: &[String]) -> Known {
        Known { takers: Takers::of_assembly(assembly), assembly: assembly.clone(), severities: severities.to_vec() }
    }

    /// The severity that the command line sets for a code.
    fn level(&self, code: &str) -> Option<SeverityLevel> {
        let levels = self.severities.iter().filter_map(|one| one.split_once('=').filter(|(of, _)| *of == code));
        levels.filter_map(|(_, level)| SeverityLevel::from_name(level.split(':').next()?)).next()
    }

    /// The topics of the fleet, by the names that they have after renaming.
    fn topics(&self) -> Vec<String> {
        let of = |spec: &ComponentSpec| -> Vec<String> {
            let declared = spec.class.declaration();
            declared.publishes.iter().chain(&declared.subscribes).map(|one| spec.topic(&one.name).into()).collect()
        };
        let mut topics: Vec<String> = self.assembly.all().flat_map(of).collect();
        topics.sort();
        topics.dedup();
        topics
    }

    fn subjects(&self, site: &str) -> FaultSubjects {
        fault_subjects(self.assembly.all().filter(|spec| site.is_empty() || spec.site == *site))
    }

    /// Judges what a line says of the fleet, whatever is drawn of its ranges.
    fn judge_line(&self, text: &str, first: &PlannedEvent) -> Result<(), LineFault> {
        let mut languages = EventLanguage::linked().filter(|one| first.is_fault() || one.topic.name == first.topic);
        let events = self.takers.events();
        languages.try_for_each(|one| seen(&self.assembly, &first.site, |fleet| (one.judge)(fleet, events, text)))
    }

    /// Judges what one event names.
    fn judge(&self, event: &PlannedEvent) -> Result<(), LineFault> {
        let text = &event.message.text;
        match event.message.content {
            EventContent::Bytes(_) => {
                let (site, topics) = (&event.site, self.topics());
                let whole = 0..text.len();
                known_site(site, event.topic, &topics).map_err(|problem| LineFault::new(whole, problem))
            }
            EventContent::Raised if FaultCall::is_one(text) => {
                self.subjects(&event.site).check(&FaultCall::read(text)?)
            }
            EventContent::Raised => self.takers.messages(&event.site, &EventCall::read(text)?).map(drop),
        }
    }
}

impl FaultScript {
    /// Reads a file. What is wrong with it as a whole is reported.
    pub(in crate::command) fn read(path: &Path) -> Option<FaultScript> {
        let refuse = |why: String, help: Option<String>| {
            let help = help.map(|help| format!("  = help: {help}\n")).unwrap_or_default();
            let path = displayed(path);
            eprint(&format!(
                "error: the faults cannot be read from `{path}`: {why}\n{help}\n1 error: nothing was started\n"
            ));
            None
        };
        let size = match fs::metadata(path) {
            Ok(about) if about.is_file() => about.len(),
            Ok(_) => return refuse("it is no file".to_owned(), None),
            Err(error) => return refuse(error.to_string(), missing_file_help(path)),
        };
        if size > LARGEST {
            return refuse(format!("it has {size} bytes, at most {LARGEST} are read"), None);
        }
        match fs::read_to_string(path) {
            Ok(text) => {
                // A mark of the encoding, as some editors write it.
                let text = text.strip_prefix('\u{feff}').unwrap_or(&text).to_owned();
                Some(FaultScript { path: displayed(path).to_string(), text })
            }
            Err(error) => refuse(error.to_string(), None),
        }
    }

    /// The events of a run with this seed.
    ///
    /// # Errors
    /// What is wrong with each line, for people.
    pub(in crate::command) fn events(&self, known: &Known, seed: u64) -> Result<Planned, Vec<String>> {
        let mut languages = Languages::of(("(faults)", "a line of `--faults`"), &Numbers::new(seed));
        let (mut all, mut lowered, mut wrong) = (Vec::new(), Vec::new(), Vec::new());
        for (number, line) in (1..).zip(self.text.lines()) {
            let (site, text) = site_of(line);
            let before = line.len() - text.len();
            let read = languages.read(text, Time::START, known.takers.events());
            let planned = read.map_err(|fault| fault.moved(before)).and_then(|(topic, messages)| {
                let planned = messages.into_iter().map(|message| PlannedEvent {
                    message: TimedMessage { at: Some(message.at.unwrap_or(Time::START)), ..message },
                    site: site.to_owned(),
                    topic,
                });
                let planned: Vec<PlannedEvent> = planned.collect();
                // The others differ in their random values alone.
                let judged = planned.first().map_or(Ok(()), |first| known.judge(first));
                judged.map_err(|fault| placed(line, &planned, fault))?;
                let judged = planned.first().map_or(Ok(()), |first| known.judge_line(text, first));
                Ok((planned, judged.map_err(|fault| fault.moved(before))))
            });
            let (planned, fault) = match planned {
                Ok((planned, judged)) => (planned, judged.err()),
                Err(fault) => (Vec::new(), Some(fault)),
            };
            all.extend(planned);
            let Some(fault) = fault else { continue };
            let usual = SeverityLevel::Set(fault.code.map_or(Severity::Error, |code| code.severity));
            let level = fault.code.and_then(|code| known.level(code.id)).unwrap_or(usual);
            let text = self.said(number, line, level, &fault);
            match level {
                SeverityLevel::Set(Severity::Error) => wrong.push(text),
                SeverityLevel::Set(_) => lowered.push(text),
                SeverityLevel::Allow => {}
            }
        }
        if wrong.is_empty() { Ok(Planned { events: all, lowered }) } else { Err(wrong) }
    }

    /// A fault of a line, as people read it.
    fn said(&self, number: usize, line: &str, level: SeverityLevel, fault: &LineFault) -> String {
        let column = line.get(..fault.bytes.start).map_or(1, |before| before.chars().count() + 1);
        let place = format!("{}:{number}:{column}", self.path);
        let Some(code) = fault.code.map(|code| code.id) else {
            return format!("{}: {place}: {}\n", level.name(), shown(line, fault));
        };
        let anyway = match level {
            SeverityLevel::Set(Severity::Error) => {
                format!("    = help: to run it in spite of that, add `--severity {code}=warning`\n")
            }
            _ => String::new(),
        };
        format!("{}[{code}]: {place}: {}\n{anyway}", level.name(), shown(line, fault))
    }
}

/// The fault of an event at its words in the line.
fn placed(line: &str, planned: &[PlannedEvent], fault: LineFault) -> LineFault {
    let Some(first) = planned.first() else { return fault };
    let word = first.message.text.get(fault.bytes.clone()).unwrap_or_default();
    // Behind the word of the event, so that a name is not found in a time.
    let event = first.message.text.split_whitespace().find(|word| !word.is_empty()).unwrap_or_default();
    let start = line.find(event).unwrap_or_default();
    let is_end =
        |sign: Option<char>| sign.is_none_or(|sign| sign.is_whitespace() || matches!(sign, ',' | '=' | ';' | '#'));
    let place = line[start..]
        .match_indices(word)
        .map(|(at, _)| start + at)
        .find(|at| is_end(line[..*at].chars().next_back()) && is_end(line[*at + word.len()..].chars().next()));
    match place.filter(|_| !word.is_empty()) {
        Some(place) => fault.at(place..place + word.len()),
        None => fault.at(start..line.trim_end().len()),
    }
}

/// Puts the events of a file into a fleet that has just started. One that goes on from a state folder has those that
/// are no faults in its memory: they are not played again. Faults begin again, but for those whose time has passed.
pub(super) fn play_all(path: &Path, events: Vec<PlannedEvent>, handle: &Handle) {
    let recalled = handle.recalled();
    let counter = format!("faults {}", path::absolute(path).unwrap_or_default().display());
    let taken = handle.counter(&counter);
    let mut number = 0;
    let together = handle.together();
    if together.is_too_late() {
        // The next program plays them.
        return;
    }
    for event in events {
        let is_known = !event.is_fault() && {
            number += 1;
            number <= taken
        };
        if is_known || recalled.is_some_and(|recalled| event.at() <= recalled) {
            continue;
        }
        if let Err(why) = event.play(handle) {
            handle.note(Level::Error, why);
        }
    }
    handle.set_counter(&counter, number.max(taken));
}

/// Reports what is wrong with a script.
pub(in crate::command) fn report_wrong(wrong: &[String]) {
    for one in wrong {
        eprint(one);
    }
    eprint(&format!("\n{}: nothing was started\n", counted(wrong.len(), "error")));
}

impl PlannedEvent {
    /// True if it is a fault, which ends with the program.
    fn is_fault(&self) -> bool {
        self.message.content == EventContent::Raised && FaultCall::is_one(&self.message.text)
    }

    /// Its time.
    fn at(&self) -> Time {
        self.message.at.unwrap_or(Time::START)
    }

    /// Puts it into a fleet that has just started.
    ///
    /// # Errors
    /// Why it does not happen.
    pub(in crate::command) fn play(self, handle: &Handle) -> Result<(), String> {
        happen(self.message, (&self.site, self.topic), handle)
    }

    /// The line that says it, with its time.
    pub(in crate::command) fn line(&self) -> String {
        let at = self.message.at.unwrap_or(Time::START).since(Time::START);
        let site = if self.site.is_empty() { String::new() } else { format!("{}: ", self.site) };
        format!("{site}at {} {}", format_duration(at), self.message.text)
    }
}
