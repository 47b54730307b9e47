//! The loader over real files, broken files, and beside another XML parser.
//!
//! These tests are about single steps of a project (reading, loading, finding named files), and call each step alone:
//! what the checker says would hide what the step does.

pub(crate) mod collection;
mod corpus;
mod definitions;
mod exchange;
mod files;
mod folders;
mod imports;
mod named;
mod oracle;
mod places;
mod support;
mod wellformed;
