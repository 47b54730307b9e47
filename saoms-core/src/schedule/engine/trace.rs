use saoms_api::host::SharedMessage;

use crate::hash::fold;
use crate::journal::Head;

/// Digest of everything that happens in a run, computed from integers.
///
/// Each effect is folded in as its time, its component and its kind; a message also as its topic's name and its bytes
/// in CDR, a record of the journal as its digest, its loop and its cause. Two runs with the same digest did the same,
/// on any machines.
#[derive(Debug, Default)]
pub(crate) struct Trace {
    hash: u64,
    bytes: Vec<u8>,
}

/// Changes in the life of a component, as the trace counts them.
#[derive(Clone, Copy, Debug)]
pub(crate) enum TraceStep {
    Started = 1,
    Left = 2,
    Failed = 3,
    Voted = 4,
    GaveUp = 5,
    Skipped = 6,
}

impl Trace {
    pub(crate) fn step(&mut self, time: u64, component: u32, step: TraceStep) {
        self.effect(time, component, step as u64);
    }

    pub(crate) fn message(&mut self, time: u64, component: u32, topic: u64, message: &SharedMessage) {
        self.effect(time, component, topic);
        if let Some(to) = message.to() {
            self.hash = fold(self.hash, u64::from(to));
        }
        message.encode_into(&mut self.bytes);
        let (words, rest) = self.bytes.as_chunks::<8>();
        for word in words {
            self.hash = fold(self.hash, u64::from_le_bytes(*word));
        }
        let mut last = [0; 8];
        last[..rest.len()].copy_from_slice(rest);
        self.hash = fold(self.hash, u64::from_le_bytes(last));
        self.hash = fold(self.hash, self.bytes.len() as u64);
    }

    pub(crate) fn record(&mut self, head: &Head) {
        self.effect(head.time, head.component, head.fingerprint);
        self.hash = fold(fold(self.hash, u64::from(head.place)), head.cause.0);
    }

    fn effect(&mut self, time: u64, component: u32, what: u64) {
        self.hash = fold(fold(fold(self.hash, time), u64::from(component)), what);
    }

    /// The digest so far, as 16 hexadecimal digits.
    pub(crate) fn digits(&self) -> String {
        format!("{:016x}", self.hash)
    }
}
