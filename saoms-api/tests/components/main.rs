//! Components under a host: what reaches them, and what leaves them.
#![expect(clippy::unwrap_used, reason = "a test may end where it stands")]

mod adaptation;
mod boundary;
mod calls;
mod extends;
mod host;
mod messages;
