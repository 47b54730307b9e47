//! What the loops of the master that assign luggage find out and decide.

use saoms_api::{Record, Recordable, record};

use crate::grid::Block;
use crate::messages::{FIRST_VISIT, is_visit};

/// Luggage that waits, and robots that are free.
#[derive(Clone, Copy, Debug)]
pub struct Unassigned {
    /// Number of pieces that wait.
    pub pieces: u32,
    /// Number of robots that are free.
    pub robots: u32,
}

/// What is assigned, and taken back.
#[derive(Clone, Copy, Debug)]
pub struct AssignmentDecision {
    /// Number of pieces that are assigned.
    pub assigned: u32,
    /// Number of pieces that are taken back.
    pub withdrawn: u32,
}

/// An assignment, or its withdrawal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Order {
    pub(super) robot: u32,
    pub(super) luggage: u32,
    pub(super) from: Block,
    pub(super) to: Block,
    pub(super) withdrawn: bool,
}

/// What a loop decided.
#[derive(Debug, Default)]
pub(super) struct Orders(pub(super) Vec<Order>);

impl Orders {
    pub(super) fn decision(&self) -> AssignmentDecision {
        let withdrawn = self.0.iter().filter(|order| order.withdrawn).count();
        let count = |number: usize| u32::try_from(number).unwrap_or(u32::MAX);
        AssignmentDecision { assigned: count(self.0.len() - withdrawn), withdrawn: count(withdrawn) }
    }
}

/// An order, as the journal has it.
pub(super) fn order(robot: u32, luggage: u32, withdrawn: bool) -> Record {
    if is_visit(luggage) {
        let visit = luggage - FIRST_VISIT;
        return match withdrawn {
            false => record!(assigns_visit: "assigns visit {visit} to robot {robot}", visit, robot),
            true => record!(withdraws_visit: "takes visit {visit} back from robot {robot}", visit, robot),
        };
    }
    match withdrawn {
        false => record!(assigns_luggage: "assigns luggage {luggage} to robot {robot}", luggage, robot),
        true => record!(withdraws_luggage: "takes luggage {luggage} back from robot {robot}", luggage, robot),
    }
}

impl Recordable for Unassigned {
    fn record(&self) -> Record {
        let Unassigned { pieces, robots } = *self;
        record!(
            luggage_unassigned:
                "{pieces} {pieces:piece waits|pieces wait}, and {robots} {robots:robot is|robots are} free",
            pieces,
            robots
        )
    }
}

impl Recordable for AssignmentDecision {
    fn record(&self) -> Record {
        let AssignmentDecision { assigned, withdrawn } = *self;
        match withdrawn {
            0 => record!(assigns_pieces: "assigns {assigned} {assigned:piece|pieces}", assigned),
            _ => record!(
                assigns_pieces_anew:
                    "assigns {assigned} {assigned:piece|pieces}, and takes {withdrawn} back for other robots",
                assigned,
                withdrawn
            ),
        }
    }
}
