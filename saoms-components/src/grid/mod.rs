//! The area of a fleet: blocks, maps, and distances on a grid.

mod block;
mod distances;
mod map;
mod read;
#[cfg(test)]
mod tests;

pub use block::Block;
pub use distances::{Distances, MOVE, UNREACHABLE};
pub use map::Map;
