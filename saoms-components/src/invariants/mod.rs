//! The invariants of a fleet of robots: what holds in each run, whatever becomes of messages and components.
//!
//! 1. No two robots are in a block. 2. No two robots exchange their blocks. 3. A move is one block, to a free
//!    neighbour. 4. A piece of luggage is where it was put, on exactly one robot, or delivered, which happens
//!    once. 5. No battery is empty away from a charger. 6. No robot with a job stands still for ever. 7. Once
//!    faults are over, each request is finished. 8. The luggage of a broken robot is taken
//!    over. 9, that the same seed has the same trace, is judged by whoever runs a seed twice.

mod bearers;
mod floor;
mod luggage;
mod passage;
mod robots;
mod strain;
mod tide;

use std::collections::{BTreeMap, HashMap};
use std::time::Duration;

use saoms_api::Time;
use saoms_api::event::fault::{FaultCall, FaultKind, is_named};
use saoms_api::extension::{
    ConcernedComponent, Counts, InvariantsRegistration, Measure, RunEnd, RunInvariants, Violation, submit,
};
use saoms_api::host::{SharedMessage, TopicDeclaration};

use crate::messages::{
    AREA, ASSIGNMENT, COLLISION, CRITICAL_SITUATION, DRAIN, EVENT_LUGGAGE, FAULT, HANDLING, OUTAGE, POSITION, REMOVAL,
    ROBOT_LIST, SLOW, TERRITORY, carries,
};
use bearers::Bearers;
use luggage::Pieces;
use passage::{Passage, Passages};
use robots::Robots;
use tide::Tide;

submit! { InvariantsRegistration { new: || Box::new(FleetInvariants::default()) } }

pub(crate) const ONE_IN_A_BLOCK: &str = "1 no two robots in a block";
pub(crate) const NO_SWAP: &str = "2 no two robots exchange their blocks";
pub(crate) const MOVES: &str = "3 a move is one block to a free neighbour";
pub(crate) const ONCE: &str = "4 luggage is delivered exactly once";
pub(crate) const ONE_PLACE: &str = "4 luggage is at its place, on one robot, or delivered";
pub(crate) const BATTERY: &str = "5 no battery is empty away from a charger";
pub(crate) const NO_DEADLOCK: &str = "6 no robot with a job stands still for ever";
pub(crate) const FINISHED: &str = "7 requests are finished once faults are over";
pub(crate) const TAKEN_OVER: &str = "8 the luggage of a broken robot is taken over";

/// The least time after which something that does not happen counts as never happening. Slow robots have 200 of their
/// periods.
const BOUND: Duration = Duration::from_secs(60);
const PERIODS: u32 = 200;
/// Time between two looks at what does not happen.
const LOOK: Duration = Duration::from_secs(1);

/// The content of a topic.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Content {
    Area,
    Territory,
    Position,
    Robot,
    Luggage,
    Collision,
    Handling,
    Fault,
    Removal,
    Critical,
    Assignment,
    Slow,
    Drain,
    Outage,
}

/// The invariants of one run. Each site has robots and luggage of its own.
#[derive(Default)]
struct FleetInvariants {
    topics: HashMap<String, (String, Content)>,
    /// Topics without whose messages robots do not get on.
    passages: Vec<(String, Passage)>,
    sites: BTreeMap<String, Site>,
    /// Of all sites.
    tide: Tide,
    looked: Time,
    /// True if an earlier program began the run: luggage may have been asked for there.
    goes_on: bool,
    found: Vec<Violation>,
    measures: Vec<Measure>,
    /// Hours of robots.
    simulated: Option<Measure>,
}

#[derive(Default)]
struct Site {
    robots: Robots,
    pieces: Pieces,
    bearers: Bearers,
    passages: Passages,
    /// True if its world is of this program, which counts what is delivered then.
    has_world: bool,
    /// True if its world or a zone has crashed or failed for good: without it no robot moves.
    has_stopped: bool,
}

/// Where violations are noted.
pub(crate) struct Finder<'f> {
    pub(crate) site: &'f str,
    pub(crate) at: Time,
    pub(crate) found: &'f mut Vec<Violation>,
}

impl Finder<'_> {
    pub(crate) fn note(&mut self, invariant: &'static str, text: String) {
        let text = if self.site.is_empty() { text } else { format!("{}: {text}", self.site) };
        self.found.push(Violation { invariant, at: self.at, text });
    }
}

fn content(declared: &TopicDeclaration<'_>) -> Option<Content> {
    Some(match declared {
        one if carries(one, &AREA) => Content::Area,
        one if carries(one, &TERRITORY) => Content::Territory,
        one if carries(one, &POSITION) => Content::Position,
        one if carries(one, &ROBOT_LIST) => Content::Robot,
        one if carries(one, &EVENT_LUGGAGE) => Content::Luggage,
        one if carries(one, &COLLISION) => Content::Collision,
        one if carries(one, &HANDLING) => Content::Handling,
        one if carries(one, &FAULT) => Content::Fault,
        one if carries(one, &REMOVAL) => Content::Removal,
        one if carries(one, &CRITICAL_SITUATION) => Content::Critical,
        one if carries(one, &ASSIGNMENT) => Content::Assignment,
        one if carries(one, &SLOW) => Content::Slow,
        one if carries(one, &DRAIN) => Content::Drain,
        one if carries(one, &OUTAGE) => Content::Outage,
        _ => return None,
    })
}

/// The site of a topic.
fn site_of(topic: &str) -> &str {
    topic.rsplit_once('/').map_or("", |(site, _)| site)
}

/// The time after which something does not happen any more, for robots with this period in microseconds.
pub(crate) fn bound(period: u64) -> Duration {
    BOUND.max(Duration::from_micros(period).saturating_mul(PERIODS))
}

impl FleetInvariants {
    /// Looks for what does not happen.
    fn look(&mut self, at: Time) {
        self.looked = at;
        for (site, Site { robots, pieces, has_stopped, .. }) in &mut self.sites {
            let mut finder = Finder { site, at, found: &mut self.found };
            let tide = self.tide.at_site(*has_stopped);
            robots.look(&tide, &mut finder);
            pieces.look(&tide, robots.longest_period(), &mut finder);
        }
    }
}

impl RunInvariants for FleetInvariants {
    fn wants_topic(&mut self, name: &str, declared: &TopicDeclaration<'_>) -> bool {
        self.passages.extend(Passage::of(declared).map(|passage| (name.to_owned(), passage)));
        let Some(content) = content(declared) else { return false };
        self.topics.insert(name.to_owned(), (site_of(name).to_owned(), content));
        true
    }

    fn goes_on(&mut self) {
        self.goes_on = true;
    }

    fn message(&mut self, topic: &str, message: &SharedMessage) {
        let Some((site, content)) = self.topics.get(topic) else { return };
        let at = message.header().sent;
        let state = self.sites.entry(site.clone()).or_default();
        let mut finder = Finder { site, at, found: &mut self.found };
        let Site { robots, pieces, bearers, passages, has_world, has_stopped } = state;
        match content {
            Content::Territory => passages.has_zones = true,
            Content::Area => {
                *has_world = true;
                bearers.begin(message);
                robots.hear_area(message);
            }
            Content::Position => robots.hear_position(message, *has_world, &mut finder),
            Content::Robot => robots.hear_state(message, *has_stopped || passages.are_kept(at), &mut finder),
            Content::Collision => robots::hear_collision(message, &mut finder),
            Content::Handling => bearers.hear(message, &mut finder),
            Content::Luggage => {
                // Luggage of an earlier program may have been put down elsewhere since.
                if !self.goes_on {
                    bearers.hear_request(message);
                }
                robots.hear_luggage(message, at);
                pieces.hear(message, self.goes_on, &mut finder);
            }
            Content::Fault => {
                self.tide.rise(at);
                robots.hear_fault(message);
            }
            Content::Slow => self.tide.rise_until(robots.hear_slow(message)),
            Content::Drain => self.tide.rise_until(robots.hear_drain(message)),
            Content::Outage => self.tide.rise_until(robots.hear_outage(message)),
            Content::Assignment => pieces.hear_assignment(message, at),
            Content::Removal => {
                robots.hear_removal(message);
                pieces.hear_removal(message, at);
            }
            Content::Critical => {
                robots.hear_critical(message);
                pieces.hear_critical(message, at);
            }
        }
        if at.since(self.looked) >= LOOK {
            self.look(at);
        }
    }

    fn fault(&mut self, at: Time, call: &FaultCall, concerned: &[ConcernedComponent]) {
        self.tide.begin(at, call);
        if call.kind.is_of_messages() {
            let is_meant = |topic: &str| call.topic.as_ref().is_none_or(|word| is_named(&word.text, topic));
            for (topic, passage) in self.passages.iter().filter(|(topic, _)| is_meant(topic)) {
                let site = self.sites.entry(site_of(topic).to_owned()).or_default();
                site.passages.begin(*passage, at, call);
            }
        }
        for topic in concerned.iter().flat_map(|one| &one.publishes).filter(|topic| passage::needs(&topic.message)) {
            let site = self.sites.entry(site_of(&topic.name).to_owned()).or_default();
            site.passages.begin_of_component(at, call);
        }
        let ends = |one: &&ConcernedComponent| match call.kind {
            FaultKind::Crash { restart } => restart.is_none(),
            FaultKind::Fail => !one.restarts,
            _ => false,
        };
        let indispensable = [AREA.declaration().message, TERRITORY.declaration().message];
        let topics = concerned.iter().filter(ends).flat_map(|one| &one.publishes);
        for topic in topics.filter(|topic| indispensable.contains(&&*topic.message)) {
            self.sites.entry(site_of(&topic.name).to_owned()).or_default().has_stopped = true;
        }
    }

    fn end(&mut self, at: Time, end: RunEnd, counts: &Counts<'_>) {
        if end == RunEnd::Standstill {
            self.tide.note_standstill();
        }
        self.look(at);
        let is_cut_off = end == RunEnd::CutOff;
        let (mut delivered, mut reported, mut requested, mut waits) = (0, 0, 0, Vec::new());
        for (site, Site { robots, pieces, has_world, has_stopped, .. }) in &mut self.sites {
            let mut finder = Finder { site, at, found: &mut self.found };
            pieces.end(is_cut_off, &self.tide.at_site(*has_stopped), robots.longest_period(), &mut finder);
            delivered += pieces.delivered();
            // A world of another program counts there.
            reported += if *has_world { pieces.delivered() } else { 0 };
            requested += pieces.requested();
            waits.extend(pieces.waits());
        }
        let counted = usize::try_from(counts("luggage.delivered")).unwrap_or_default();
        if reported > counted {
            let text =
                format!("robots said of {reported} pieces that they were delivered, the world counted {counted}");
            Finder { site: "", at, found: &mut self.found }.note(ONCE, text);
        }
        // What no master heard of is not delivered either. One that forgot what it knew may count a piece twice.
        let put_down = counts("scenario.luggage") - (counts("luggage.ignored") - counts("scenario.known"));
        let requested = requested.max(usize::try_from(put_down).unwrap_or_default());
        let seconds = at.since(Time::START).as_secs_f64();
        let figure = |name, value| Measure { name, value, of: None };
        let of_robots: f64 = self.sites.values().map(|site| site.robots.seconds(at)).sum();
        self.simulated = (of_robots > 0.0).then(|| figure("robot-hours", of_robots / 3600.0));
        let (errands, done) = (counts("errands.requested"), counts("errands.finished"));
        self.measures = Vec::new();
        if requested > 0 || errands == 0 {
            let pieces = Measure { name: "pieces delivered", value: delivered as f64, of: Some(requested as f64) };
            let hourly = if seconds > 0.0 { delivered as f64 * 3600.0 / seconds } else { 0.0 };
            self.measures.extend([pieces, figure("pieces in an hour", hourly)]);
        }
        if errands > 0 {
            self.measures.push(Measure { name: "errands finished", value: done as f64, of: Some(errands as f64) });
        }
        // Where nothing was brought, nobody knows how long it waits.
        if let Some(longest) = waits.iter().copied().reduce(f64::max) {
            let mean = waits.iter().sum::<f64>() / waits.len() as f64;
            self.measures.push(figure("mean wait of a piece, s", mean));
            self.measures.push(figure("longest wait of a piece, s", longest));
        }
    }

    fn violations(&mut self) -> Vec<Violation> {
        std::mem::take(&mut self.found)
    }

    fn measures(&self) -> Vec<Measure> {
        self.measures.clone()
    }

    fn simulated(&self) -> Option<Measure> {
        self.simulated.clone()
    }
}
