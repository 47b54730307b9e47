//! The boundary to plugins: its layout, and the headers for C.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking, and so do its helpers")]

mod header;
mod layout;
