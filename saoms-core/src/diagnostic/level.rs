//! Severities that are set by whoever checks a composite.

use super::Severity;
use crate::source::Location;

/// What a diagnostic can be set to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Level {
    /// It is not told, and kept for the record.
    Allow,
    /// It has this severity.
    Set(Severity),
}

impl Level {
    /// All, from what hides most.
    pub const ALL: [Self; 4] =
        [Self::Allow, Self::Set(Severity::Note), Self::Set(Severity::Warning), Self::Set(Severity::Error)];

    /// As it is written.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Allow => "allow",
            Self::Set(severity) => severity.name(),
        }
    }

    /// The level that is written so.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|level| level.name() == name)
    }
}

/// What set the severity of a diagnostic.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SetBy {
    /// What it was set to.
    pub level: Level,
    /// Where.
    pub at: Location,
    /// Why; `None` on the command line.
    pub reason: Option<String>,
}
