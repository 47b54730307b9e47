//! Whole fleets and what is wrong with them.

mod beside;
mod cascades;
mod crowds;
mod first_fleets;
mod hints;
mod missing_loops;
mod mistakes;
mod rules;
mod shared;
mod sites;
mod zones;
