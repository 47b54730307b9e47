//! Targets, wires, promotions and topics.

mod fleet;
mod promotions;
mod slips_of_wires;
mod topics;
mod wires;
