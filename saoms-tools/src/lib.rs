//! Tools for composites beside a check and a run: pictures, timelines of runs, one layout, the composite with all
//! resolved, XML schemas, answers for editors.

pub mod diagnostics;
pub mod editor;
mod element;
pub mod expand;
pub mod format;
pub mod graph;
pub mod timeline;
pub mod xsd;
