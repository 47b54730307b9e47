//! Tools for composites beside a check and a run: pictures, one layout, XML schemas, answers for editors.

pub mod editor;
pub mod format;
pub mod graph;
pub mod xsd;
