//! The loader and the checker, from text to text.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking, and so do its helpers")]

mod check;
mod load;
