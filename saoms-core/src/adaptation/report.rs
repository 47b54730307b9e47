use std::collections::{BTreeMap, HashSet};

use serde::{Deserialize, Serialize, Serializer};

use super::event::Event;
use super::switches::Switches;
use super::{Adaptations, Samples, Spread, Throughput};
use crate::journal::in_lines;

/// Events that a report lists at most; its table has all.
const MOST_LISTED: usize = 10_000;

/// What came of the events of a run, by kind.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct AdaptationReport {
    /// The kinds of events: first what came from outside the fleet or from components without loops, then what loops
    /// began by themselves; each by name.
    pub kinds: Vec<KindReport>,
    /// Events beyond the 100,000 that are measured.
    pub unmeasured: u64,
    /// Records that belong to no event because their cause was lost, or is too old.
    pub detached: u64,
    /// The first 10,000 events that are measured, in their order; empty in a short report.
    #[serde(serialize_with = "as_lines")]
    pub events: Vec<MeasuredEvent>,
}

/// What came of the events of one kind. Times are in seconds from the event.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct KindReport {
    /// The id of the record; of an event from outside the first word of its line, such as `breakdown`.
    pub kind: String,
    /// True if a loop began by itself; then its record is what detects it.
    pub own: bool,
    /// How many there were; without those that loops began and that had no effect.
    pub count: usize,
    /// First symptom that follows from it; `None` of a loop's own event, or if no event has any.
    pub detect_s: Option<Spread>,
    /// First decision.
    pub decide_s: Option<Spread>,
    /// First effect.
    pub effect_s: Option<Spread>,
    /// Last effect, of the events that no other event overtook.
    pub settle_s: Option<Spread>,
    /// Events of which another event took over what they had switched.
    pub overtaken: usize,
    /// Events of which something is still switched at the end.
    pub lasting: usize,
    /// Components that adapted needlessly.
    pub needless: u64,
    /// The throughput before and after; `None` of a loop's own events, if no component counts work, or if no event has
    /// time on both sides.
    #[serde(default)]
    pub throughput: Option<Throughput>,
}

/// One event. Times are in seconds from the event.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MeasuredEvent {
    /// The number of its record in the journal.
    pub id: u64,
    /// When it happened, in seconds of the run.
    pub time_s: f64,
    /// As [`KindReport::kind`].
    pub kind: String,
    /// As [`KindReport::own`].
    pub own: bool,
    /// First symptom.
    pub detect_s: Option<f64>,
    /// First decision.
    pub decide_s: Option<f64>,
    /// First effect.
    pub effect_s: Option<f64>,
    /// Last effect; `None` if another event overtook it.
    pub settle_s: Option<f64>,
    /// Components that adapted needlessly.
    pub needless: u32,
}

fn as_lines<S: Serializer>(events: &[MeasuredEvent], serializer: S) -> Result<S::Ok, S::Error> {
    in_lines(events)?.serialize(serializer)
}

impl AdaptationReport {
    /// The same without the list of events.
    #[must_use]
    pub fn without_events(&self) -> AdaptationReport {
        let AdaptationReport { ref kinds, unmeasured, detached, .. } = *self;
        AdaptationReport { kinds: kinds.clone(), unmeasured, detached, events: Vec::new() }
    }
}

/// The tables of all events.
pub(super) fn tables(all: &Adaptations, switches: &Switches, samples: &Samples) -> AdaptationReport {
    let lasting: HashSet<u32> = switches.lasting().collect();
    let kind = |event: &Event| all.kinds.get(event.kind as usize).map_or("", String::as_str);
    // Loops begin at much that leads to nothing.
    let counts = |event: &Event| !event.is_own || event.acted.is_some();
    let counted = (0_u32..).zip(&all.events).filter(|(_, event)| counts(event));
    let mut groups: BTreeMap<(bool, &str), Vec<(u32, &Event)>> = BTreeMap::new();
    for (place, event) in counted.clone() {
        groups.entry((event.is_own, kind(event))).or_default().push((place, event));
    }
    let kinds = groups.into_iter().map(|((own, kind), events)| {
        let spread = |figure: fn(&Event) -> Option<f64>| {
            Spread::of(events.iter().filter_map(|(_, event)| figure(event)).collect())
        };
        let number =
            |is: &dyn Fn(u32, &Event) -> bool| events.iter().filter(|(place, event)| is(*place, event)).count();
        KindReport {
            kind: kind.to_owned(),
            own,
            count: events.len(),
            detect_s: spread(|event| event.after(event.detected).filter(|_| !event.is_own)),
            decide_s: spread(|event| event.after(event.decided)),
            effect_s: spread(|event| event.after(event.acted)),
            settle_s: spread(Event::settle),
            overtaken: number(&|_, event| event.is_overtaken),
            lasting: number(&|place, _| lasting.contains(&place)),
            needless: events.iter().map(|(_, event)| u64::from(event.needless)).sum(),
            throughput: Throughput::of(events.iter().filter(|_| !own).map(|(_, event)| event.at), samples),
        }
    });
    let events = counted.take(MOST_LISTED).map(|(_, event)| MeasuredEvent {
        id: event.id,
        time_s: event.at as f64 / 1e9,
        kind: kind(event).to_owned(),
        own: event.is_own,
        detect_s: event.after(event.detected).filter(|_| !event.is_own),
        decide_s: event.after(event.decided),
        effect_s: event.after(event.acted),
        settle_s: event.settle(),
        needless: event.needless,
    });
    AdaptationReport {
        kinds: kinds.collect(),
        unmeasured: all.unmeasured,
        detached: all.detached,
        events: events.collect(),
    }
}
