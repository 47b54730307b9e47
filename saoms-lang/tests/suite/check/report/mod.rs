//! The documentation of codes and rules, and severities of findings.

mod reference;
mod rules;
mod severities;
