//! `saoms run --paths`: a picture of where the robots went.
//!
//! What robots and world say on their topics is taken in while the fleet runs ([`recording`]), and drawn at its end. A robot's path is a line
//! of its own colour, every pass beside the others; where robots pass each other too often for that, first the passes of one robot share a
//! line, and beyond that blocks are shaded by how often they were entered.

mod density;
mod frame;
mod glyphs;
mod lanes;
mod legend;
mod lines;
mod marks;
mod meaning;
mod palette;
mod path;
mod picture;
mod recording;

use std::sync::{Mutex, MutexGuard, PoisonError};

use saoms_api::TopicDeclaration;
use saoms_core::observe::Sent;

use recording::Recording;

/// Keeps what the picture of a run shows.
#[derive(Debug, Default)]
pub(crate) struct Paths(Mutex<Recording>);

impl Paths {
    /// Whether a topic's messages are drawn.
    pub(crate) fn wants_topic(&self, name: &str, declared: &TopicDeclaration<'_>) -> bool {
        self.lock().wants(name, declared)
    }

    /// Takes in a message of such a topic.
    pub(crate) fn message(&self, sent: &Sent) {
        self.lock().hear(&sent.topic, &sent.component, &sent.message);
    }

    /// The picture as an SVG document, under a title and a line on how the run ended.
    pub(crate) fn picture(&self, title: &str, outcome: &str) -> String {
        picture::draw(&self.lock(), title, outcome)
    }

    fn lock(&self) -> MutexGuard<'_, Recording> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
