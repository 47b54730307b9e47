//! What people and editors ask of composites beside a check and a run: pictures, one layout, XML schemas.

pub mod editor;
pub mod format;
pub mod graph;
pub mod xsd;
