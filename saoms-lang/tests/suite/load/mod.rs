//! The loader over real files, broken files, and beside another XML parser.

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
