//! What one execution may send and write: more of it fails the component.

use saoms_api::Failure;

use super::host::ComponentHost;

/// Greatest number of messages in one execution.
const MAX_SENT: usize = 1_000_000;
/// Greatest size of all messages that code of a library sends in one execution, in bytes: four of the longest.
const MAX_SENT_BYTES: usize = 4 * saoms_abi::MAX_BYTES;
/// Greatest number of records, and of lines, in one execution.
const MAX_WRITTEN: u32 = 100_000;

/// What the present execution, reaction or call has written.
#[derive(Debug, Default)]
pub(crate) struct Spent {
    /// Records of the journal, and names of loops.
    records: u32,
    /// Lines of the log and the console, whether anybody wants them or not.
    lines: u32,
    is_too_much: bool,
}

impl Spent {
    /// True if there is room for one more record.
    #[inline]
    pub(super) fn has_record(&mut self) -> bool {
        self.records += 1;
        self.records <= MAX_WRITTEN || self.refuse()
    }

    /// True if there is room for one more line.
    #[inline]
    pub(super) fn has_line(&mut self) -> bool {
        self.lines += 1;
        self.lines <= MAX_WRITTEN || self.refuse()
    }

    #[cold]
    fn refuse(&mut self) -> bool {
        // They stay beyond the bound, and never overflow.
        (self.records, self.lines) = (self.records.min(MAX_WRITTEN + 1), self.lines.min(MAX_WRITTEN + 1));
        self.is_too_much = true;
        false
    }

    /// The failure of whoever wrote more than there is room for.
    #[inline]
    pub(in crate::schedule) fn is_within(&self) -> Result<(), Failure> {
        if self.is_too_much { Err(wrote_too_much()) } else { Ok(()) }
    }
}

#[cold]
fn wrote_too_much() -> Failure {
    Failure::new(format!(
        "writes more in one execution than {MAX_WRITTEN} records of the journal or {MAX_WRITTEN} lines of the log: write \
         changes, or the rest in the next executions"
    ))
}

impl ComponentHost<'_> {
    /// Fails if the state folder takes nothing more.
    pub(super) fn may_keep(&self) -> Result<(), Failure> {
        let refusal = self.shared.store.get().and_then(|queue| queue.refusal());
        refusal.map_or(Ok(()), |refusal| Err(Failure::new(refusal)))
    }

    /// Fails if the component sends more than an execution may.
    #[inline]
    pub(super) fn may_send(&self) -> Result<(), Failure> {
        let (messages, bytes) = (self.part.outbox.len(), self.part.sent_bytes);
        if messages >= MAX_SENT || bytes > MAX_SENT_BYTES { Err(sends_too_much(messages, bytes)) } else { Ok(()) }
    }
}

#[cold]
fn sends_too_much(messages: usize, bytes: usize) -> Failure {
    Failure::new(format!(
        "sends more in one execution than {MAX_SENT} messages or {} MiB: {messages} messages, {} MiB so far; \
         send the rest in the next executions",
        MAX_SENT_BYTES >> 20,
        bytes >> 20
    ))
}
