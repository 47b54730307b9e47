//! How a program begins on a network: none of its components runs in another program that is there.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::thread::sleep;
use std::time::{Duration, Instant};

use saoms_api::host::cdr;

use super::{BEGINS, RUNS};
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
/// Time between two questions, and between two looks at what was answered.
const AGAIN: Duration = Duration::from_millis(100);
const LOOK: Duration = Duration::from_millis(5);
/// Programs that answer, at most: what more say is the same.
const MOST_PROGRAMS: usize = 64;
/// Longest patience of another program that counts: it says how long it is waited for.
const LONGEST_PATIENCE: Duration = Duration::from_secs(60);

/// Whether the components of a program may begin.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Entry {
    /// They run nowhere else.
    Free,
    /// The end was asked for before that was known.
    Over,
    /// The link to the network was lost meanwhile, and was not there again for longer than it is waited for.
    Lost,
}

/// A program in which a component runs that is about to begin here.
struct Running {
    name: String,
    component: String,
    patience: Duration,
    first: Instant,
    last: Instant,
}

/// Asks the other programs of a network whether components of this one run there, before these begin. One that was
/// killed, or is about to end, is waited for: until it has said nothing for its patience. The date of this program is
/// then later than that of all of which the others know that they have begun with one of its components.
///
/// # Errors
/// A component runs in another program that is there: a text for people. Or the transport refuses a subscription.
///
/// `is_fresh`: the network was not there a moment ago, or has no router, so that others may not be connected yet. That
/// is so for a router in any case, and the router says it to others while it has just begun.
///
/// `longest`: how long a link that is lost is waited for; `None` is for ever.
pub fn enter(
    session: &TransportSession,
    port: &Arc<Port>,
    settings: &mut Settings,
    is_fresh: bool,
    mut tell: impl FnMut(String),
    longest: Option<Duration>,
    is_over: impl Fn() -> bool,
) -> Result<Entry, String> {
    session.subscribe(&key::begins_of_all(), BEGINS)?;
    if settings.components.is_empty() {
        return Ok(Entry::Free);
    }
    session.subscribe(&key::runs(settings.program), RUNS)?;
    let components: Vec<String> = settings.components.iter().cloned().collect();
    let mut wait = if is_fresh || session.is_router() { SETTLES } else { ANSWERS };
    let begin = Instant::now();
    let (mut since, mut looked) = (begin, begin);
    let mut link = LinkState::default();
    let mut down_since = begin;
    let mut asked: Option<Instant> = None;
    let mut running: BTreeMap<u64, Running> = BTreeMap::new();
    loop {
        if std::mem::replace(&mut looked, Instant::now()).elapsed() > HELD_UP {
            since = Instant::now();
        }
        let before = std::mem::replace(&mut link, port.link_state());
        if link.is_down && (!before.is_down || link.losses > before.losses) {
            down_since = Instant::now();
        }
        if link.is_down && !before.is_down {
            tell("the link to the network is lost: the components begin when it is there again".to_owned());
        }
        if link.losses > before.losses || before.is_down {
            (since, wait) = (Instant::now(), SETTLES);
        }
        let is_over_time = since.elapsed() >= wait && running.is_empty();
        if !is_over_time && asked.is_none_or(|asked| asked.elapsed() >= AGAIN) {
            asked = Some(Instant::now());
            // What there is no room for is asked again.
            let begins = Begins { components: components.clone(), ..settings.begins() };
            let _ = session.put(&key::begins(settings.program), &cdr::encode(&begins), &[], true);
        }
        for frame in port.take_frames() {
            let Ok(said) = cdr::decode::<Begins>(&frame.message) else { continue };
            if frame.token == RUNS {
                // The date of who answers without one of the components does not matter.
                let began = if said.components.is_empty() { 0 } else { said.began };
                let later = said.latest.max(began).saturating_add(1);
                settings.began = settings.began.max(later.min(LARGEST_NUMBER));
                wait = wait.max(since.elapsed() + Duration::from_millis(said.settles).min(SETTLES));
            }
            match frame.token {
                RUNS if running.len() < MOST_PROGRAMS || running.contains_key(&said.program) => {
                    let Some(component) = said.components.iter().find(|one| settings.components.contains(*one)) else {
                        continue;
                    };
                    let now = Instant::now();
                    let one = running.entry(said.program).or_insert_with(|| {
                        let patience = Duration::from_millis(said.patience).min(LONGEST_PATIENCE);
                        let (name, component) = (said.name.clone(), component.clone());
                        tell(format!(
                            "component `{component}` runs in program `{name}` still: waits for the end of that"
                        ));
                        Running { name, component, patience, first: now, last: now }
                    });
                    one.last = now;
                }
                // Of two that begin at once, one does.
                BEGINS => {
                    let is_both = |one: &&String| settings.program < said.program && settings.components.contains(*one);
                    let components = said.components.iter().filter(is_both).cloned().collect();
                    let settles =
                        if session.is_router() { SETTLES.saturating_sub(begin.elapsed()) } else { Duration::ZERO };
                    let settles = in_milliseconds(settles);
                    let runs = Begins { components, settles, ..settings.begins() };
                    if !runs.components.is_empty() || settles > 0 {
                        answer(session, said.program, &runs);
                    }
                }
                _ => {}
            }
        }
        if let Some(one) = running.values().find(|one| one.last - one.first > one.patience) {
            return Err(format!(
                "component `{}` runs in program `{}`, which is there, and a component runs once in a fleet: end that \
                 program first, or give the component another name",
                one.component, one.name
            ));
        }
        running.retain(|_, one| one.last.elapsed() <= one.patience);
        let is_answered = asked.is_some_and(|asked| asked.elapsed() >= ROUND_TRIP);
        if running.is_empty() && since.elapsed() >= wait && is_answered && !link.is_down {
            return Ok(Entry::Free);
        }
        if is_over() {
            return Ok(Entry::Over);
        }
        if link.is_down && longest.is_some_and(|longest| down_since.elapsed() >= longest) {
            return Ok(Entry::Lost);
        }
        sleep(LOOK);
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
