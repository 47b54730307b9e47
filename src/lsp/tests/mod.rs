//! Names and what they stand for, text in and text out.

mod hover;
mod names;
