//! In place of loops of the policy `classic`.

mod early;
mod rested;
mod walker;

pub use early::EarlyBattery;
pub use rested::Rested;
pub use walker::ClassicWalker;
