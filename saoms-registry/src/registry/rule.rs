use std::fmt;
use std::path::Path;
use std::sync::Arc;

use saoms_api::host::contain::contained;
use saoms_api::rule::{Code, FleetRule, FleetView};
use saoms_api::{Failure, Finding};

/// A rule over whole fleets; see [`FleetRule`].
#[derive(Clone, Debug)]
pub struct RegisteredRule {
    pub(super) code: &'static Code,
    pub(super) judges_parts: bool,
    pub(super) prevents_start: bool,
    pub(super) provider: Arc<dyn RuleProvider>,
}

impl RegisteredRule {
    /// The code of its findings.
    pub fn code(&self) -> &'static Code {
        self.code
    }

    /// As [`FleetRule::judges_parts`].
    pub fn judges_parts(&self) -> bool {
        self.judges_parts
    }

    /// As [`FleetRule::prevents_start`].
    pub fn prevents_start(&self) -> bool {
        self.prevents_start
    }

    /// Its findings in a fleet.
    ///
    /// # Errors
    /// The rule is at fault: it panicked, or its library cannot be loaded.
    pub fn check(&self, fleet: &FleetView<'_>) -> Result<Vec<Finding>, Failure> {
        self.provider.check(fleet)
    }

    /// The library that it comes from; `None` for one that is linked into the program.
    pub fn origin(&self) -> Option<&Path> {
        self.provider.origin()
    }

    /// True if its library was found and not named: it is known by its declaration alone, and none of its code runs.
    pub fn is_only_read(&self) -> bool {
        self.provider.is_only_read()
    }
}

/// The source of the code of a rule.
pub trait RuleProvider: fmt::Debug + Send + Sync {
    /// As [`RegisteredRule::check`].
    ///
    /// # Errors
    /// As there.
    fn check(&self, fleet: &FleetView<'_>) -> Result<Vec<Finding>, Failure>;

    /// As [`RegisteredRule::origin`].
    fn origin(&self) -> Option<&Path>;

    /// As [`RegisteredRule::is_only_read`].
    fn is_only_read(&self) -> bool {
        false
    }
}

impl RuleProvider for &'static FleetRule {
    fn check(&self, fleet: &FleetView<'_>) -> Result<Vec<Finding>, Failure> {
        contained(|| (self.check)(fleet))
    }

    fn origin(&self) -> Option<&Path> {
        None
    }
}
