//! Fleets in virtual time: what each run has to keep.

mod assignment;
mod battery;
mod charging;
mod composites;
mod crowded;
mod dead_ends;
mod divided;
mod endings;
mod environment;
mod expand;
mod failures;
mod goes_on;
mod gone;
mod invariants;
mod messages;
mod pause;
mod physics;
mod replace;
mod shifts;
mod slow;
mod strain;
mod sustained;
mod visits;
mod waiting;
mod zones;
