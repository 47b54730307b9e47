//! Names and what they stand for, text in and text out.

mod broken;
mod expressions;
mod fleets;
mod hover;
mod marked;
mod names;
mod session;
mod shape;
mod sound;
mod topics;
