//! Pictures of composites in the notation of SCA Assembly: components with services on the left and references on the
//! right, properties on top, wires, promotions, and topics.
//!
//! A [`Diagram`] is what there is to draw; [`svg`], [`mermaid`] and [`dot`] draw it. It is made from the model, not
//! from an assembly: a fleet with mistakes has a picture, too, in which what is missing can be seen.

mod diagram;
mod dot;
mod groups;
mod layout;
mod mermaid;
mod picture;
mod ports;
mod read;
mod svg;
#[cfg(test)]
mod tests;
mod text;
mod topics;
mod wiring;

pub use diagram::{
    Diagram, DiagramComponent, DiagramEnd, DiagramLink, DiagramSetting, DiagramTopic, LinkKind, Port, State,
};
pub use dot::dot;
pub use mermaid::mermaid;
pub use picture::Picture;
pub use svg::svg;
