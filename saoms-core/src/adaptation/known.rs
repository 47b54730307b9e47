use saoms_api::Cause;
use saoms_api::host::Phase;

/// Records that are remembered: the newest, by their numbers. Causes are seldom older than some seconds.
const CAPACITY: usize = 1 << 17;

/// What a record belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Origin {
    /// To no event: a measured value, for example.
    Nothing,
    /// To an event that is not known any more, or is not measured.
    Unknown,
    /// To the tree of the event at this place.
    Event(u32),
}

/// A record, as far as those that follow from it need it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Known {
    pub(super) id: Cause,
    pub(super) origin: Origin,
    /// True if it comes after the adaptation: what its component does then is no part of it.
    pub(super) is_beyond: bool,
    pub(super) component: u32,
    pub(super) loop_name: Option<u32>,
    pub(super) phase: Phase,
    /// In nanoseconds.
    pub(super) time: u64,
}

/// The newest records, each at the place that follows from its number.
#[derive(Debug, Default)]
pub(super) struct KnownRecords {
    all: Vec<Option<Known>>,
}

impl KnownRecords {
    pub(super) fn put(&mut self, known: Known) {
        let place = place(known.id);
        // It grows with the run up to its bound.
        if self.all.len() <= place {
            self.all.resize(place + 1, None);
        }
        self.all[place] = Some(known);
    }

    /// The record with this number, unless newer ones have taken its place.
    pub(super) fn get(&self, id: Cause) -> Option<Known> {
        self.all.get(place(id)).copied().flatten().filter(|known| known.id == id)
    }
}

fn place(id: Cause) -> usize {
    (id.0 % CAPACITY as u64) as usize
}
