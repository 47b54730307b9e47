//! Elements that name intents, policy sets and operations (SCA Policy 1.1, 4.2 and 4.3; SCA 1.0 for operations).

use super::elements::known;
use super::{Holds, Kind};

/// Intents, in an element of their own.
pub static INTENTS: Kind = Kind {
    name: "requires",
    doc: "Intents of policies. SAOMS does not look at them.",
    attributes: &[known("intents", Holds::Names, "The intents that apply.")],
    children: &[],
};

/// A policy set, in an element of its own.
pub static POLICY_SET: Kind = Kind {
    name: "policySetAttachment",
    doc: "A set of policies. SAOMS does not look at it.",
    attributes: &[known("name", Holds::Names, "The policy set that applies.")],
    children: &[],
};

/// Policies of an operation.
pub static OPERATION: Kind = Kind {
    name: "operation",
    doc: "Policies of an operation. SAOMS does not look at them.",
    attributes: &[],
    children: &[],
};

/// What others add.
pub static EXTENSIONS: Kind = Kind {
    name: "extensions",
    doc: "Elements of other namespaces, which SAOMS does not look at.",
    attributes: &[],
    children: &[],
};
