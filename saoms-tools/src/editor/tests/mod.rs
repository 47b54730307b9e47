//! Names and their symbols, text in and text out.

mod broken;
mod expressions;
mod fleets;
mod folding;
mod hover;
mod marked;
mod names;
mod sound;
mod topics;
