use std::fmt;

use saoms_api::{Field, Message, Topic};

/// Events that change the number of robots that are needed.
pub const EXCEPTIONAL_EVENT: Topic<ExceptionalEvent> = Topic::event("EETOPIC").optional();

/// Kinds of exceptional events.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Field)]
pub enum ExceptionalKind {
    /// An airplane landed.
    #[default]
    Landing,
    /// An airplane is about to take off.
    Takeoff,
}

/// An event that brings more luggage than usual.
#[derive(Clone, Debug, Default, PartialEq, Eq, Message)]
pub struct ExceptionalEvent {
    /// Landing or take-off.
    pub kind: ExceptionalKind,
    /// Number of pieces of luggage that are expected.
    pub pieces: u32,
}

impl fmt::Display for ExceptionalEvent {
    /// Format of the console in the manual's figures.
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let kind = match self.kind {
            ExceptionalKind::Landing => "LANDING",
            ExceptionalKind::Takeoff => "TAKEOFF",
        };
        write!(formatter, "{kind} with {} expected pieces of luggage", self.pieces)
    }
}
