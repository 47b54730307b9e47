//! How components tell of messages that they do not take in.

use std::fmt;

use saoms_api::{Context, Header, Level};

/// Reports what was sent and cannot be, with its sender.
pub(crate) fn ignore(context: &mut Context<'_>, header: Header, reason: impl fmt::Display) {
    let sender = match context.sender_name(header) {
        Some(name) => format!("`{name}`"),
        None => format!("component {}", header.sender),
    };
    context.log(Level::Error, format_args!("ignores what {sender} sent: {reason}"));
}
