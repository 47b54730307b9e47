use crate::{Context, Host, SharedMessage};

use super::host::FUNCTIONS;
use super::{Bytes, HostHandle, Inbox, MessageView};

/// What [`HostHandle`] needs to lend the messages of a period: used again and again, so that nothing is allocated once it has grown.
#[derive(Debug, Default)]
pub(super) struct Lent {
    messages: Vec<MessageView>,
    inboxes: Vec<Inbox>,
}

// SAFETY: between two calls of `with_handle` the lists are empty, so no pointer goes from thread to thread.
unsafe impl Send for Lent {}

/// Lends a context to code on the other side.
pub(super) fn with_handle<T>(
    context: &mut Context<'_>,
    lent: &mut Lent,
    code: impl FnOnce(&HostHandle) -> T,
) -> T {
    let (host, inboxes) = context.parts();
    if inboxes.iter().any(|inbox| !inbox.is_empty()) {
        lend(inboxes, lent);
    }
    let mut host: &mut dyn Host = host;
    let handle = HostHandle {
        state: (&raw mut host).cast(),
        functions: &FUNCTIONS,
        inboxes: lent.inboxes.as_ptr(),
        inbox_count: lent.inboxes.len(),
    };
    let result = code(&handle);
    lent.inboxes.clear();
    lent.messages.clear();
    result
}

fn lend(inboxes: &[Vec<SharedMessage>], lent: &mut Lent) {
    for message in inboxes.iter().flatten() {
        let header = message.header();
        lent.messages.push(MessageView {
            bytes: Bytes::lend(message.bytes()),
            sent: header.sent.as_nanos(),
            cause: header.cause.0,
            key: message.key().unwrap_or(0),
            sender: header.sender,
            has_key: u32::from(message.key().is_some()),
        });
    }
    let mut rest = &lent.messages[..];
    for inbox in inboxes {
        let (own, others) = rest.split_at(inbox.len());
        lent.inboxes.push(Inbox { messages: own.as_ptr(), count: own.len() });
        rest = others;
    }
}
