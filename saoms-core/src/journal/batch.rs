use saoms_api::host::Phase;
use saoms_api::{Cause, Record, Time, Value};

/// The loop number of records that a component writes outside its loops.
pub(crate) const OUTSIDE: u16 = u16::MAX;

/// A record of the journal without its values, as the engine keeps it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Head {
    pub(crate) id: Cause,
    pub(crate) time: u64,
    pub(crate) cause: Cause,
    /// A digest of phase, id and values.
    pub(crate) fingerprint: u64,
    record_id: &'static str,
    text: &'static str,
    names: &'static str,
    /// Index of its first value among those of the batch.
    values: u32,
    pub(crate) component: u32,
    /// The loop, or [`OUTSIDE`].
    pub(crate) place: u16,
    count: u8,
    pub(crate) phase: Phase,
    /// True if it records a change of an entry of the knowledge.
    pub(crate) change: bool,
    /// For a decision: true if an effect, a message or a call followed in the same execution.
    pub(crate) acted: bool,
}

/// A list of records in memory that is reused.
#[derive(Debug, Default)]
pub(crate) struct Batch {
    heads: Vec<Head>,
    values: Vec<Value>,
}

/// A record to add, with its loop and its cause.
#[derive(Clone, Copy, Debug)]
pub(super) struct Note<'a> {
    pub(super) id: Cause,
    pub(super) time: u64,
    pub(super) cause: Cause,
    pub(super) fingerprint: u64,
    pub(super) component: u32,
    pub(super) place: u16,
    pub(super) phase: Phase,
    pub(super) change: bool,
    pub(super) record: &'a Record,
}

impl Batch {
    #[inline]
    pub(super) fn push(&mut self, note: &Note<'_>) {
        let Note { id, time, cause, fingerprint, component, place, phase, change, record } = *note;
        let values = self.values.len() as u32;
        self.values.extend_from_slice(record.used());
        let count = (self.values.len() as u32 - values) as u8;
        let (record_id, text, names) = (record.id(), record.text(), record.names());
        self.heads.push(Head {
            id,
            time,
            cause,
            fingerprint,
            record_id,
            text,
            names,
            values,
            component,
            place,
            count,
            phase,
            change,
            acted: false,
        });
    }

    /// Copies a record of another batch.
    #[inline]
    pub(super) fn copy(&mut self, head: &Head, other: &Batch) {
        let values = self.values.len() as u32;
        self.values.extend_from_slice(other.values_of(head));
        self.heads.push(Head { values, ..*head });
    }

    pub(super) fn append(&mut self, other: &Batch) {
        for head in &other.heads {
            self.copy(head, other);
        }
    }

    pub(crate) fn heads(&self) -> &[Head] {
        &self.heads
    }

    pub(super) fn head_mut(&mut self, place: u32) -> Option<&mut Head> {
        self.heads.get_mut(place as usize)
    }

    fn values_of(&self, head: &Head) -> &[Value] {
        &self.values[head.values as usize..head.values as usize + usize::from(head.count)]
    }

    /// The record of a head of this batch.
    pub(crate) fn record(&self, head: &Head) -> Record {
        Record::new(head.record_id, head.text, head.names, self.values_of(head))
    }

    pub(crate) fn len(&self) -> usize {
        self.heads.len()
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.heads.is_empty()
    }

    pub(crate) fn clear(&mut self) {
        self.heads.clear();
        self.values.clear();
    }
}

impl Head {
    pub(super) fn time(&self) -> Time {
        Time::from_nanos(self.time)
    }
}
