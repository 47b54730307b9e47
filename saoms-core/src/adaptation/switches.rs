use std::collections::HashMap;

/// Components with events that are remembered at most; of those beyond, the older half of what is over is forgotten.
const MOST: usize = 1 << 18;

/// What an event switched in a component: the entries of its knowledge that are yes or no.
#[derive(Clone, Copy, Debug)]
pub(super) struct Engagement {
    /// How many entries are switched by it and not yet back.
    pub(super) open: u32,
    /// When the first of these was switched, in nanoseconds.
    pub(super) since: u64,
    /// The last record of the event in the component, in nanoseconds.
    pub(super) last: u64,
}

/// All switches of a run.
#[derive(Debug, Default)]
pub(super) struct Switches {
    /// By event and component.
    engagements: HashMap<(u32, u32), Engagement>,
    /// The event that switched an entry last, by component and entry, until that is back.
    holders: HashMap<(u32, u32), u32>,
    /// When an event from outside last used a component: it switched another entry while its first one was on.
    used: HashMap<u32, u64>,
}

/// A switch that went back.
#[derive(Clone, Copy, Debug)]
pub(super) struct Closed {
    /// The event that had switched it.
    pub(super) event: u32,
    /// The engagement, without it.
    pub(super) engagement: Engagement,
}

impl Switches {
    pub(super) fn of(&self, event: u32, component: u32) -> Option<&Engagement> {
        self.engagements.get(&(event, component))
    }

    /// Notes that an entry that somebody had switched is back; `None` where nobody had.
    pub(super) fn close(&mut self, component: u32, entry: u32) -> Option<Closed> {
        let event = self.holders.remove(&(component, entry))?;
        let engagement = self.engagements.get_mut(&(event, component))?;
        engagement.open = engagement.open.saturating_sub(1);
        Some(Closed { event, engagement: *engagement })
    }

    /// Notes that an event switched an entry. `uses` is true if it came from outside.
    pub(super) fn open(&mut self, event: u32, component: u32, entry: u32, now: u64, uses: bool) {
        self.make_room();
        let new = Engagement { open: 0, since: now, last: now };
        let engagement = self.engagements.entry((event, component)).or_insert(new);
        if engagement.open == 0 {
            engagement.since = now;
        } else if uses && now > engagement.since {
            self.used.insert(component, now);
        }
        engagement.open += 1;
        self.holders.insert((component, entry), event);
    }

    /// Notes a record of an event in a component.
    pub(super) fn touch(&mut self, event: u32, component: u32, now: u64) {
        if let Some(engagement) = self.engagements.get_mut(&(event, component)) {
            engagement.last = now;
        }
    }

    /// True if an event from outside used the component after this time.
    pub(super) fn is_used_since(&self, component: u32, since: u64) -> bool {
        self.used.get(&component).is_some_and(|used| *used > since)
    }

    /// The events with entries that are not back.
    pub(super) fn lasting(&self) -> impl Iterator<Item = u32> {
        self.engagements.iter().filter(|(_, one)| one.open > 0).map(|((event, _), _)| *event)
    }

    fn make_room(&mut self) {
        if self.engagements.len() < MOST {
            return;
        }
        let mut times: Vec<u64> = self.engagements.values().map(|one| one.last).collect();
        let middle = times.len() / 2;
        let (_, median, _) = times.select_nth_unstable(middle);
        let median = *median;
        self.engagements.retain(|_, one| one.open > 0 || one.last > median);
    }
}
