//! Derive macros of the SAOMS contract.
