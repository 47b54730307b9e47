//! How a program begins on its networks: none of its components runs in another program that is there, on any of them.
//!
//! Until that is known of all its networks, no other program hears more of it than that it asks. So a program that is
//! refused on one network has taken nobody's place on another one.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::{Duration, Instant};

use saoms_api::host::cdr;

use super::{BEGINS, RUNS, subscribe};
use crate::network::Membership;
use crate::network::exchange::Settings;
use crate::network::exchange::wire::{Begins, LARGEST_NUMBER};
use crate::network::key;
use crate::network::port::{LinkState, Port};
use crate::network::transport::TransportSession;

/// Time in which others say that a component runs there: as long as a message and its answer take on a slow line.
const ANSWERS: Duration = Duration::from_millis(500);
/// The same where others may not be connected yet, which try that every half second.
pub(super) const SETTLES: Duration = Duration::from_millis(1_500);
/// Time after the last question in which it is answered.
const ROUND_TRIP: Duration = Duration::from_millis(100);
/// Time between two looks after which the program was held up, as by SIGSTOP, and has to ask again.
const HELD_UP: Duration = Duration::from_millis(500);
/// Time between two questions.
const AGAIN: Duration = Duration::from_millis(100);
/// Programs that answer, at most: what more say is the same.
const MOST_PROGRAMS: usize = 64;
/// Longest patience of another program that counts: it says how long it is waited for.
const LONGEST_PATIENCE: Duration = Duration::from_secs(60);

/// Whether the components of a program may begin.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Entry {
    /// That is not known yet.
    Open,
    /// They run nowhere else.
    Free,
    /// The link to the network at this place was lost meanwhile, and was not there again for longer than it is waited
    /// for.
    Lost(usize),
}

/// The reason for which components may not begin: one of them runs in another program that is there.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Refused {
    /// The place of the network.
    pub place: usize,
    /// A text for people.
    pub why: String,
}

/// The networks on which a program is about to begin: on all of them, or on none.
///
/// It asks the other programs of each whether components of this one run there. One that was killed, or is about to
/// end, is waited for: until it has said nothing for its patience. The date of this program is in the end later than
/// that of all of which the others know that they have begun with one of its components.
#[derive(Debug, Default)]
pub struct Entrance {
    all: Vec<Entering>,
}

/// A network on which a program may begin.
#[derive(Debug)]
pub struct Entered {
    pub(super) session: TransportSession,
    pub(super) port: Arc<Port>,
    pub(super) settings: Settings,
}

impl Entrance {
    /// Takes in another network, which a transport has joined, and that delivers to the port. All are asked from now
    /// on.
    ///
    /// `is_fresh`: the network was not there a moment ago, or has no router, so that others may not be connected yet.
    /// That is so for a router in any case, and the router says it to others while it has just begun.
    ///
    /// # Errors
    /// The transport refuses a subscription: why.
    pub fn add(
        &mut self,
        session: TransportSession,
        port: &Arc<Port>,
        settings: Settings,
        membership: &Membership,
        is_fresh: bool,
        now: Instant,
    ) -> Result<(), String> {
        subscribe(&session, settings.program, membership)?;
        session.subscribe(&key::begins_of_all(), BEGINS)?;
        if !settings.components.is_empty() {
            session.subscribe(&key::runs(settings.program), RUNS)?;
        }
        self.all.iter_mut().for_each(|one| one.wait_anew(now));
        let wait = if is_fresh || session.is_router() { SETTLES } else { ANSWERS };
        self.all.push(Entering {
            components: settings.components.iter().cloned().collect(),
            entered: Entered { session, port: Arc::clone(port), settings },
            wait,
            begin: now,
            since: now,
            looked: now,
            link: LinkState::default(),
            down_since: now,
            asked: None,
            running: BTreeMap::new(),
        });
        Ok(())
    }

    /// Hears what others say, answers them, and asks again while that is not known of all networks. `longest`: how long
    /// a link that is lost is waited for; `None` is for ever.
    ///
    /// # Errors
    /// A component runs in another program that is there.
    pub fn look(
        &mut self,
        now: Instant,
        longest: Option<Duration>,
        mut tell: impl FnMut(String),
    ) -> Result<Entry, Refused> {
        for (place, one) in self.all.iter_mut().enumerate() {
            one.hear(now, &mut tell).map_err(|why| Refused { place, why })?;
        }
        let is_ready = self.all.iter().all(|one| one.is_ready(now));
        if !is_ready {
            self.all.iter_mut().for_each(|one| one.ask(now));
        }
        let lost = self.all.iter().position(|one| one.is_lost(now, longest));
        let is_free = is_ready && self.all.iter().all(|one| one.is_answered(now));
        Ok(lost.map_or(if is_free { Entry::Free } else { Entry::Open }, Entry::Lost))
    }

    /// The networks, with one date for all: else of two programs each could be the later one on another network.
    pub fn into_all(self) -> Vec<Entered> {
        let mut all: Vec<Entered> = self.all.into_iter().map(|one| one.entered).collect();
        let began = all.iter().map(|one| one.settings.began).max().unwrap_or_default();
        all.iter_mut().for_each(|one| one.settings.began = began);
        all
    }
}

/// A program in which a component runs that is about to begin here.
#[derive(Debug)]
struct Running {
    name: String,
    component: String,
    patience: Duration,
    first: Instant,
    last: Instant,
}

/// A network on which a program asks.
#[derive(Debug)]
struct Entering {
    entered: Entered,
    components: Vec<String>,
    /// Time from `since` on in which others answer.
    wait: Duration,
    begin: Instant,
    since: Instant,
    looked: Instant,
    link: LinkState,
    down_since: Instant,
    asked: Option<Instant>,
    running: BTreeMap<u64, Running>,
}

impl Entering {
    /// True if others had the time to answer, and none of those that are there runs a component.
    fn is_ready(&self, now: Instant) -> bool {
        let is_over = self.components.is_empty() || now - self.since >= self.wait && self.running.is_empty();
        is_over && !self.link.is_down
    }

    /// True if the last question had the time to be answered.
    fn is_answered(&self, now: Instant) -> bool {
        self.components.is_empty() || self.asked.is_some_and(|asked| now - asked >= ROUND_TRIP)
    }

    fn is_lost(&self, now: Instant, longest: Option<Duration>) -> bool {
        self.link.is_down && longest.is_some_and(|longest| now - self.down_since >= longest)
    }

    /// What others said before may be long ago.
    fn wait_anew(&mut self, now: Instant) {
        (self.since, self.wait) = (now, self.wait.min(SETTLES));
    }

    fn ask(&mut self, now: Instant) {
        if self.components.is_empty() || self.asked.is_some_and(|asked| now - asked < AGAIN) {
            return;
        }
        self.asked = Some(now);
        // What there is no room for is asked again.
        let Entered { session, settings, .. } = &self.entered;
        let begins = Begins { components: self.components.clone(), ..settings.begins() };
        let _ = session.put(&key::begins(settings.program), &cdr::encode(&begins), &[], true);
    }

    fn hear(&mut self, now: Instant, tell: &mut impl FnMut(String)) -> Result<(), String> {
        if now - std::mem::replace(&mut self.looked, now) > HELD_UP {
            self.wait_anew(now);
        }
        self.watch_link(now, tell);
        for frame in self.entered.port.take_frames() {
            if frame.token != RUNS && frame.token != BEGINS {
                // Signs of life and what is missing come again; commands are given again by who has no answer.
                continue;
            }
            let Ok(said) = cdr::decode::<Begins>(&frame.message) else { continue };
            if frame.token == RUNS {
                self.hear_of_running(said, now, tell);
            } else {
                self.answer(&said, now);
            }
        }
        if let Some(one) = self.running.values().find(|one| one.last - one.first > one.patience) {
            return Err(format!(
                "component `{}` runs in program `{}`, which is there, and a component runs once in a fleet: end that \
                 program first, or give the component another name",
                one.component, one.name
            ));
        }
        self.running.retain(|_, one| now - one.last <= one.patience);
        Ok(())
    }

    /// Nobody answers over a link that is lost: others are asked anew once it is there again.
    fn watch_link(&mut self, now: Instant, tell: &mut impl FnMut(String)) {
        let before = std::mem::replace(&mut self.link, self.entered.port.link_state());
        if self.link.is_down && (!before.is_down || self.link.losses > before.losses) {
            self.down_since = now;
        }
        if self.link.is_down && !before.is_down {
            tell("the link to the network is lost: the components begin when it is there again".to_owned());
        }
        if self.link.losses > before.losses || before.is_down {
            (self.since, self.wait) = (now, SETTLES);
        }
    }

    /// Another program says which of the components run there.
    fn hear_of_running(&mut self, said: Begins, now: Instant, tell: &mut impl FnMut(String)) {
        let settings = &mut self.entered.settings;
        // The date of who answers without one of the components does not matter.
        let began = if said.components.is_empty() { 0 } else { said.began };
        let later = said.latest.max(began).saturating_add(1);
        settings.began = settings.began.max(later.min(LARGEST_NUMBER));
        self.wait = self.wait.max(now - self.since + Duration::from_millis(said.settles).min(SETTLES));
        if self.running.len() >= MOST_PROGRAMS && !self.running.contains_key(&said.program) {
            return;
        }
        let Some(component) = said.components.iter().find(|one| settings.components.contains(*one)) else { return };
        let one = self.running.entry(said.program).or_insert_with(|| {
            let patience = Duration::from_millis(said.patience).min(LONGEST_PATIENCE);
            let (name, component) = (said.name.clone(), component.clone());
            tell(format!("component `{component}` runs in program `{name}` still: waits for the end of that"));
            Running { name, component, patience, first: now, last: now }
        });
        one.last = now;
    }

    /// Another program asks: of two that begin at once, one does.
    fn answer(&self, said: &Begins, now: Instant) {
        let Entered { session, settings, .. } = &self.entered;
        let is_both = |one: &&String| settings.program < said.program && settings.components.contains(*one);
        let components = said.components.iter().filter(is_both).cloned().collect();
        let settles = if session.is_router() { SETTLES.saturating_sub(now - self.begin) } else { Duration::ZERO };
        let runs = Begins { components, settles: in_milliseconds(settles), ..settings.begins() };
        if !runs.components.is_empty() || runs.settles > 0 {
            answer(session, said.program, &runs);
        }
    }
}

/// A time as programs say it.
pub(super) fn in_milliseconds(time: Duration) -> u64 {
    u64::try_from(time.as_millis()).unwrap_or(u64::MAX)
}

/// Says to a program that is about to begin which of its components run in this one.
pub(super) fn answer(session: &TransportSession, program: u64, runs: &Begins) {
    // It asks again.
    let _ = session.put(&key::runs(program), &cdr::encode(runs), &[], true);
}
