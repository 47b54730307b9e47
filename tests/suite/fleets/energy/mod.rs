//! Batteries and chargers, and what strains robots.

mod battery;
mod charging;
mod crowded;
mod strain;
mod sustained;
