//! Sessions, and the protocol's side of answers.

#[path = "../../../saoms-tools/src/editor/testing/composite.rs"]
mod composite;
mod session;

use composite::composite;
