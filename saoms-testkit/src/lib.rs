//! What tests of composites and components use.
