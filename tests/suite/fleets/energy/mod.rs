//! Batteries and chargers, and what strains robots.

mod battery;
mod charging;
mod crowded;
mod drawn;
mod handling;
mod relief;
mod strain;
mod sustained;
