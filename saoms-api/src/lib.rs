//! The contract that authors of SAOMS components compile against.
