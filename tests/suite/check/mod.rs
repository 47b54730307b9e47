//! Whole fleets and what is wrong with them.

mod cascades;
mod mistakes;
mod rules;
mod shared;
