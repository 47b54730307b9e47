//! Fleets in virtual time: what each run has to keep.

mod assignment;
mod changes;
mod composites;
mod dead_ends;
mod divided;
mod energy;
mod environment;
mod expand;
mod failing;
mod invariants;
mod machines;
mod messages;
mod networked;
mod nodes;
mod physics;
mod shifts;
mod slow;
mod visits;
mod waiting;
mod zones;
