use crate::Bytes;

/// A message that arrived.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct MessageView {
    /// Its CDR form.
    pub bytes: Bytes,
    /// The time when it was sent, in nanoseconds of the run.
    pub sent: u64,
    /// The record of the journal that it follows from; 0 for none.
    pub cause: u64,
    /// Its key, if `has_key` is 1.
    pub key: u64,
    /// The index of its sender.
    pub sender: u32,
    /// 0 or 1.
    pub has_key: u32,
}

/// The messages that arrived for a subscription since the last execution.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Inbox {
    /// The oldest first.
    pub messages: *const MessageView,
    /// Their number.
    pub count: usize,
}

/// A topic that a component publishes or subscribes to.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct TopicView {
    /// The name before any `topicRename`.
    pub name: Bytes,
    /// The name of the message type.
    pub message: Bytes,
    /// The schema of the message type, as JSON.
    pub schema: Bytes,
    /// 0: state, 1: event.
    pub kind: u32,
}
