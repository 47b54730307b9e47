//! Names and what they stand for, text in and text out.

mod broken;
mod hover;
mod names;
mod session;
