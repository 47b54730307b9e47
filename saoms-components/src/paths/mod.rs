//! The picture of the robots' paths: `saoms run --paths`.
//!
//! The messages of robots and world are recorded while the fleet runs ([`recording`]), and drawn at its end. A robot's
//! path is a line of its own colour, every pass beside the others. Where robots pass each other too often for that, the
//! passes of one robot share a line; beyond that, blocks are shaded by how often they were entered.

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
mod svg;

use std::sync::Arc;

use saoms_api::extension::{PictureRegistration, RunPicture, submit};
use saoms_api::host::{SharedMessage, TopicDeclaration};

use recording::Recording;

submit! { PictureRegistration { name: "paths", new: || Box::new(Recording::default()) } }

impl RunPicture for Recording {
    fn wants_topic(&mut self, name: &str, declared: &TopicDeclaration<'_>) -> bool {
        self.record_topic(name, declared)
    }

    fn message(&mut self, topic: &str, component: &Arc<str>, message: &SharedMessage) {
        self.record(topic, component, message);
    }

    fn draw(&self, title: &str, outcome: &str) -> String {
        picture::draw(self, title, outcome)
    }
}
