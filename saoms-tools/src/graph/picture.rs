//! Pictures as texts that are written as they are made.

use std::fmt::{self, Write};

use super::diagram::Diagram;

/// A picture of a diagram as a text. It is made while it is written, so that a large one need not be in memory.
#[derive(Clone, Copy, Debug)]
pub struct Picture<'d> {
    pub(super) diagram: &'d Diagram,
    pub(super) draw: fn(&Diagram, &mut Sink<'_>),
}

impl fmt::Display for Picture<'_> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut sink = Sink { to: formatter, result: Ok(()) };
        (self.draw)(self.diagram, &mut sink);
        sink.result
    }
}

/// The output of a picture. After a fault it takes nothing more, and the fault is reported at the end.
pub(super) struct Sink<'a> {
    to: &'a mut dyn Write,
    result: fmt::Result,
}

impl Sink<'_> {
    pub(super) fn push_str(&mut self, text: &str) {
        let _ = self.write_str(text);
    }
}

impl Write for Sink<'_> {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        if self.result.is_ok() {
            self.result = self.to.write_str(text);
        }
        self.result
    }
}
