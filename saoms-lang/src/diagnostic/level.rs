//! Severities that are set by whoever checks a composite.

use super::Severity;
use crate::source::Location;

/// What a diagnostic can be set to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SeverityLevel {
    /// It is not told, and kept for the record.
    Allow,
    /// It has this severity.
    Set(Severity),
}

impl SeverityLevel {
    /// All, from what hides most.
    pub const ALL: [Self; 4] =
        [Self::Allow, Self::Set(Severity::Note), Self::Set(Severity::Warning), Self::Set(Severity::Error)];

    /// How much it hides: 0 for an error, 3 for what is allowed.
    pub const fn hides(self) -> u8 {
        match self {
            Self::Allow => 3,
            Self::Set(Severity::Note) => 2,
            Self::Set(Severity::Warning) => 1,
            Self::Set(Severity::Error) => 0,
        }
    }

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
    pub level: SeverityLevel,
    /// Where.
    pub at: Location,
    /// Whether on the command line; in a composite otherwise.
    pub is_option: bool,
    /// Why; composites always say it.
    pub reason: Option<String>,
}
