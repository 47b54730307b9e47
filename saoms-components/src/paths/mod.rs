//! The picture of the robots' paths: `saoms run --paths`.
//!
//! The messages of robots and world are recorded while the fleet runs ([`recording`]), and drawn at its end. A robot's
//! path is a line of its own colour, every pass beside the others. Where robots pass each other too often for that, the
//! passes of one robot share a line; beyond that, blocks are shaded by how often they were entered. Several worlds are
//! recorded apart, and drawn below each other.

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
mod worlds;

use saoms_api::extension::{PictureRegistration, submit};

use worlds::Worlds;

submit! { PictureRegistration { name: "paths", new: || Box::new(Worlds::default()) } }
