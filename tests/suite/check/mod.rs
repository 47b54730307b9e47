//! Whole fleets and what is wrong with them.

mod cascades;
mod hints;
mod mistakes;
mod rules;
mod shared;
mod sites;
