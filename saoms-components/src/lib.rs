//! The components that ship with SAOMS: robots, masters, environment, world and message broker.
