use std::sync::Arc;
use std::sync::atomic::AtomicU64;

/// What could not be written to the files of a run.
#[derive(Clone, Debug, Default)]
pub struct LossCounts {
    /// Lines of the log.
    pub log_lines: Arc<AtomicU64>,
    /// Rows of the history.
    pub history_rows: Arc<AtomicU64>,
    /// Messages of the recording, with records of the journal and lines of the log.
    pub recorded: Arc<AtomicU64>,
}

/// What the server counts of its clients.
#[derive(Debug, Default)]
pub(crate) struct ClientCounts {
    /// Connections at present.
    pub(crate) open: AtomicU64,
    /// Connections that were refused because there were too many.
    pub(crate) refused: AtomicU64,
    /// Requests without the token, or from another site.
    pub(crate) denied: AtomicU64,
    /// Clients that were dropped because they took nothing of their answer.
    pub(crate) dropped: AtomicU64,
    /// Lines and messages that clients missed because they were too slow.
    pub(crate) lost: AtomicU64,
}
