//! Whole fleets and what is wrong with them.

mod mistakes;
mod rules;
