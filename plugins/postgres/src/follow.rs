//! Bringing a history once, or on and on.

use std::io::Write;
use std::time::{Duration, Instant};

use crate::address::Address;
use crate::arguments::Arguments;
use crate::copier::{Copier, IsThrough};
use crate::problem::{Outcome, Problem};
use crate::source::Source;
use crate::stop::Stop;
use crate::totals::Totals;
use crate::{Exit, complain};

/// Time between two looks at a file that is followed.
const LOOK: Duration = Duration::from_secs(1);

/// Time between two lines about what was brought.
const NEWS: Duration = Duration::from_secs(60);

/// The longest time between two attempts to reach a server.
const LONGEST_PAUSE: Duration = Duration::from_secs(60);

/// The number of parts of the time that is kept after which records are removed.
const STEPS: u32 = 100;

/// A history that is brought to a server.
pub(crate) struct Task<'a> {
    arguments: &'a Arguments,
    source: &'a Source,
    address: &'a Address,
    stop: &'a Stop,
    totals: Totals,
    /// True once the server was there.
    was_there: bool,
    /// The time to the next attempt, while the server is away.
    pause: Option<Duration>,
    last_news: Instant,
    last_forgotten: Option<Instant>,
}

impl<'a> Task<'a> {
    pub(crate) fn new(arguments: &'a Arguments, source: &'a Source, address: &'a Address, stop: &'a Stop) -> Task<'a> {
        let (totals, last_news) = (Totals::default(), Instant::now());
        Task {
            arguments,
            source,
            address,
            stop,
            totals,
            was_there: false,
            pause: None,
            last_news,
            last_forgotten: None,
        }
    }

    /// Brings what is there and, if that is asked for, what comes, until it is to stop.
    pub(crate) fn execute(mut self) -> Exit {
        let exit = loop {
            match self.bring() {
                Ok(IsThrough(false)) => break self.stopped(),
                Ok(IsThrough(true)) => {
                    break if self.totals.has_refused() && !self.arguments.follow { Exit::Failed } else { Exit::Done };
                }
                Err(Problem::Overtaken) => self.stop.wait(LOOK),
                Err(problem) => {
                    if let Some(exit) = self.judge(problem) {
                        break exit;
                    }
                }
            }
            if self.stop.is_asked() {
                break self.stopped();
            }
        };
        if exit == Exit::Done || !self.totals.is_empty() {
            say(&self.totals.to_string());
        }
        exit
    }

    /// The end before all was brought, as somebody wished. It is the usual one of a file that is followed.
    fn stopped(&self) -> Exit {
        if self.arguments.follow {
            return Exit::Done;
        }
        complain("stopped before all was brought: start it again to bring the rest");
        Exit::Failed
    }

    /// What becomes of a problem: the end, or a pause.
    fn judge(&mut self, problem: Problem) -> Option<Exit> {
        let (text, exit) = match problem {
            Problem::Wrong(text) => (text, Exit::WrongInput),
            Problem::Away(text) => (text, Exit::Failed),
            Problem::Overtaken => return None,
        };
        if !self.arguments.follow || exit == Exit::WrongInput {
            complain(&text);
            return Some(exit);
        }
        let pause = match self.pause {
            None => {
                complain(&format!("{text}; waiting until that is over: the history stays in the file meanwhile"));
                LOOK
            }
            Some(pause) => (pause * 2).min(LONGEST_PAUSE),
        };
        self.pause = Some(pause);
        self.stop.wait(pause);
        None
    }

    /// Connects, and prepares the server for the tables of the file.
    fn begin(&mut self) -> Outcome<Copier<'a>> {
        let copier = Copier::begin(self.source, self.address, &self.arguments.schema).map_err(|problem| {
            // A server that was right before is about to be that again.
            match problem {
                Problem::Wrong(text) if self.was_there && self.source.is_still_there().is_ok() => Problem::Away(text),
                other => other,
            }
        })?;
        self.was_there = true;
        Ok(copier)
    }

    /// Connects, and brings what there is. Ends without a problem if nothing is left to do, or if it is to stop.
    fn bring(&mut self) -> Outcome<IsThrough> {
        let mut copier = self.begin()?;
        let mut seen = None;
        loop {
            let version = self.source.data_version()?;
            if seen != Some(version) || copier.is_due() {
                if copier.pass(self.stop, &mut self.totals)? == IsThrough(false) {
                    return Ok(IsThrough(false));
                }
                seen = Some(version);
            }
            if self.pause.take().is_some() {
                complain_no_more(self.address);
            }
            self.forget(&mut copier)?;
            if !self.arguments.follow || self.stop.is_asked() {
                return Ok(IsThrough(true));
            }
            self.tell();
            self.stop.wait(LOOK);
            if self.stop.is_asked() {
                return Ok(IsThrough(true));
            }
            self.source.is_still_there()?;
            if copier.is_outdated()? {
                copier = self.begin()?;
                seen = None;
            }
        }
    }

    /// Removes old records from the server, if that is asked for and some time has passed.
    fn forget(&mut self, copier: &mut Copier<'_>) -> Outcome<()> {
        let Some(keep) = self.arguments.keep else { return Ok(()) };
        let step = (keep / STEPS).max(LOOK);
        if self.last_forgotten.is_none_or(|last| last.elapsed() >= step) {
            self.totals.removed += copier.server().forget(keep)?;
            self.last_forgotten = Some(Instant::now());
        }
        Ok(())
    }

    fn tell(&mut self) {
        if self.last_news.elapsed() >= NEWS {
            self.last_news = Instant::now();
            if let Some(news) = self.totals.news() {
                say(&news);
            }
        }
    }
}

fn complain_no_more(address: &Address) {
    say(&format!("{} is there again", address.shown));
}

/// Writes a line to standard output. Who does not read it goes without.
fn say(text: &str) {
    let _ = writeln!(std::io::stdout(), "{text}");
}
