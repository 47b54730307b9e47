//! Components that fail, pause or leave, and how runs end.

mod cut_off;
mod endings;
mod failures;
mod goes_on;
mod gone;
mod pause;
mod replace;
