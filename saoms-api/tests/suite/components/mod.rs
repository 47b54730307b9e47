//! Components under a host: what reaches them, and what leaves them.
mod adaptation;
mod boundary;
mod calls;
mod extends;
mod failures;
mod host;
mod messages;
mod records;
mod short;
