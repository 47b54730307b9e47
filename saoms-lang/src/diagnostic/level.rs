//! Severities that are set by whoever checks a composite.

use super::Severity;
use crate::source::Location;

/// The level that a diagnostic can be set to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SeverityLevel {
    /// It is not shown, and kept for the record.
    Allow,
    /// It has this severity.
    Set(Severity),
}

impl SeverityLevel {
    /// All, from what hides most.
    pub const ALL: [Self; 4] =
        [Self::Allow, Self::Set(Severity::Note), Self::Set(Severity::Warning), Self::Set(Severity::Error)];

    /// The rank in hiding: 0 for an error, 3 for allowed.
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

/// The setting that changed the severity of a diagnostic.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SetBy {
    /// The new level.
    pub level: SeverityLevel,
    /// The place of the setting.
    pub at: Location,
    /// True if on the command line; in a composite otherwise.
    pub is_option: bool,
    /// The reason; composites always give one.
    pub reason: Option<String>,
}
