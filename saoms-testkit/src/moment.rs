//! Events of a run, and their order.

use std::fmt;
use std::time::Duration;

use saoms_api::{Cause, Time};

use crate::Run;

/// Maximum number of a component's events that a failure shows.
const SHOWN: usize = 40;

/// Expectations about a component of a run; see [`Run::expect`].
#[derive(Clone, Copy, Debug)]
pub struct Expect<'r> {
    run: &'r Run,
    component: &'r str,
}

/// An event of a component.
#[derive(Clone, Debug)]
pub struct Moment<'r> {
    of: Expect<'r>,
    /// Words or id by which the event was found.
    words: String,
    /// Index among the events of the component.
    place: usize,
    record: LoggedLine,
}

/// A record of the journal, or a line of the log.
#[derive(Clone, Debug)]
struct LoggedLine {
    time: Time,
    /// Number of a record.
    number: Option<Cause>,
    /// Id of a record.
    id: Option<String>,
    text: String,
}

impl LoggedLine {
    /// True if the words are part of its text, or its id.
    fn is(&self, words: &str) -> bool {
        self.text.contains(words) || self.id.as_deref() == Some(words)
    }
}

/// A point in time of a run: a [`Moment`], or the [time](Duration) since the start.
pub trait PointInTime {
    /// Time since the start; records with equal times are distinguished by their numbers.
    fn when(&self) -> (Time, Option<Cause>);
    /// Description for failures.
    fn describe(&self) -> String;
}

impl PointInTime for Duration {
    fn when(&self) -> (Time, Option<Cause>) {
        (Time::START + *self, None)
    }

    fn describe(&self) -> String {
        self.when().0.to_string()
    }
}

impl PointInTime for Moment<'_> {
    fn when(&self) -> (Time, Option<Cause>) {
        (self.record.time, self.record.number)
    }

    fn describe(&self) -> String {
        self.to_string()
    }
}

impl<P: PointInTime> PointInTime for &P {
    fn when(&self) -> (Time, Option<Cause>) {
        (*self).when()
    }

    fn describe(&self) -> String {
        (*self).describe()
    }
}

impl Run {
    /// Expectations about a component, by its path: about the records of its loops in the journal, and about its log.
    /// An event is found by words of its text, or by the id of its record, which stays when the text is reworded.
    ///
    /// ```
    /// use std::time::Duration;
    /// use saoms_testkit::Fleet;
    ///
    /// let run = Fleet::of_file("../composites/hall.composite").run(7, Duration::from_secs(60));
    /// let takes = run.expect("Robot7").to("takes_luggage");
    /// let collects = run.expect("Robot7").to("collects luggage 1").after(&takes);
    /// collects.because("is at (3,1), where luggage 1 waits").before(Duration::from_secs(10));
    /// run.expect("Robot7").never_to("breaks down");
    /// assert_eq!(run.expect("Robot7").count("collects luggage 1"), 1);
    /// ```
    ///
    /// # Panics
    /// When the run has no such component.
    #[track_caller]
    #[expect(clippy::panic, reason = "a test that asks for a component that is not there has failed")]
    pub fn expect<'r>(&'r self, component: &'r str) -> Expect<'r> {
        if self.components.iter().all(|one| one.name != component) {
            let names: Vec<&str> = self.components.iter().map(|one| one.name.as_str()).collect();
            panic!("the run has no component `{component}`; it has {}", names.join(", "));
        }
        Expect { run: self, component }
    }
}

impl<'r> Expect<'r> {
    /// The first event with these words.
    ///
    /// # Panics
    /// With what it did instead.
    #[track_caller]
    #[expect(clippy::panic, reason = "a test whose expectation is not met has failed")]
    pub fn to(self, words: &str) -> Moment<'r> {
        let all = self.logged();
        let place = all.iter().position(|logged| logged.is(words));
        let Some(place) = place else { panic!("{} did not do `{words}`; {}", self.component, did(&all)) };
        Moment { of: self, words: words.to_owned(), place, record: all[place].clone() }
    }

    /// Checks that no event has these words.
    ///
    /// # Panics
    /// When it did, and when records of the run were overwritten, so that it is unknown.
    #[track_caller]
    #[expect(clippy::panic, reason = "a test whose expectation is not met has failed")]
    pub fn never_to(self, words: &str) {
        let all = self.logged();
        if let Some(logged) = all.iter().find(|logged| logged.is(words)) {
            panic!("{} did `{words}`: {} {}", self.component, logged.time, logged.text);
        }
        self.all_known();
    }

    /// Number of events with these words.
    ///
    /// # Panics
    /// When records of the run were overwritten, so that their number is unknown.
    #[track_caller]
    pub fn count(self, words: &str) -> usize {
        self.all_known();
        self.logged().iter().filter(|logged| logged.is(words)).count()
    }

    #[track_caller]
    fn all_known(self) {
        let overwritten = self.run.journal().overwritten;
        assert!(overwritten == 0, "{overwritten} records of this run were overwritten: let it be shorter");
    }

    /// All events in order. An event that is both in the journal and in the log is there twice.
    fn logged(self) -> Vec<LoggedLine> {
        let entries = self.run.journal().of(self.component);
        let entries = entries.iter().map(|entry| LoggedLine {
            time: entry.time(),
            number: Some(entry.id()),
            id: Some(entry.record_id().to_owned()),
            text: entry.text(),
        });
        let lines = self.run.log_lines(self.component);
        let lines = lines.map(|(time, text)| LoggedLine { time, number: None, id: None, text });
        let mut all: Vec<LoggedLine> = entries.chain(lines).collect();
        all.sort_by_key(|logged| logged.time);
        all
    }
}

/// Events of a component, as far as they are shown.
fn did(all: &[LoggedLine]) -> String {
    if all.is_empty() {
        return "it did nothing".to_owned();
    }
    let shown: String = all.iter().take(SHOWN).map(|logged| format!("\n  {} {}", logged.time, logged.text)).collect();
    match all.len().checked_sub(SHOWN) {
        None | Some(0) => format!("it did{shown}"),
        Some(more) => format!("it did{shown}\n  and {more} more"),
    }
}

impl<'r> Moment<'r> {
    /// Time since the start of the run.
    pub fn time(&self) -> Duration {
        self.record.time.since(Time::START)
    }

    /// Text of the record or line.
    pub fn text(&self) -> &str {
        &self.record.text
    }

    /// The next event of the component with the same words.
    ///
    /// # Panics
    /// When it did not.
    #[track_caller]
    #[expect(clippy::panic, reason = "a test whose expectation is not met has failed")]
    pub fn again(&self) -> Moment<'r> {
        let all = self.of.logged();
        let next = all.iter().skip(self.place + 1).position(|logged| logged.is(&self.words));
        match next {
            Some(next) => {
                let place = self.place + 1 + next;
                Moment { place, record: all[place].clone(), ..self.clone() }
            }
            None => {
                panic!("{} did not do `{}` again after {}", self.of.component, self.words, self.record.time)
            }
        }
    }

    /// Checks that it was before another event, or before a time of the run.
    ///
    /// # Panics
    /// When it was not.
    #[track_caller]
    pub fn before(self, other: impl PointInTime) -> Self {
        let (this, that) = (self.when(), other.when());
        let is_before =
            this.0 < that.0 || this.0 == that.0 && this.1.zip(that.1).is_some_and(|(this, that)| this < that);
        assert!(is_before, "{self} is not before {}", other.describe());
        self
    }

    /// Checks that it was after another event, or after a time of the run.
    ///
    /// # Panics
    /// When it was not.
    #[track_caller]
    pub fn after(self, other: impl PointInTime) -> Self {
        let (this, that) = (self.when(), other.when());
        let is_after =
            this.0 > that.0 || this.0 == that.0 && this.1.zip(that.1).is_some_and(|(this, that)| this > that);
        assert!(is_after, "{self} is not after {}", other.describe());
        self
    }

    /// Checks that it follows, directly or indirectly, from an event with these words, of any component.
    ///
    /// # Panics
    /// With what it follows from, when it does not; or when it is a line of the log, which follows from nothing that is
    /// known.
    #[track_caller]
    #[expect(clippy::panic, reason = "a test whose expectation is not met has failed")]
    pub fn because(self, words: &str) -> Self {
        let journal = self.of.run.journal();
        let Some(entry) = self.record.number.and_then(|number| journal.entry(number)) else {
            panic!("{self} is a line of the log, of which no reasons are known: ask for a record of the journal");
        };
        let (reasons, lost) = journal.reasons(entry);
        if !reasons.iter().any(|reason| reason.text().contains(words) || reason.record_id() == words) {
            let known: String = reasons.iter().map(|reason| format!("\n  {reason}")).collect();
            let lost = lost.map_or("", |_| "\n  and from what was overwritten");
            panic!("{self} does not follow from `{words}`, but from{known}{lost}");
        }
        self
    }
}

impl fmt::Display for Moment<'_> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "`{} {}` ({})", self.of.component, self.record.text, self.record.time)
    }
}
