//! What is documented of codes and rules, and how severe a finding is.

mod reference;
mod rules;
mod severities;
