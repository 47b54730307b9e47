//! Severities of diagnostics that composites set.

use super::Origin;
use super::origin::parts;
use crate::diagnostic::SeverityLevel;
use crate::source::{Located, Location, Text};

/// A `severity`: it sets that of the diagnostics of one code in the element that it stands in.
#[derive(Clone, Debug, PartialEq)]
pub struct SeverityRule {
    /// The origin in its file.
    pub origin: Origin,
    /// `code`, as `S4001`.
    pub code: Text,
    /// `level`.
    pub level: Located<SeverityLevel>,
    /// `reason`.
    pub reason: Text,
    /// True if it is wrong, which is reported: what it is about is not told beside that.
    pub is_wrong: bool,
    /// The element that it stands in; `None` for the composite itself.
    pub within: Option<Location>,
}

parts!(SeverityRule);
