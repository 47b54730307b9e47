//! Options of a check.

use crate::check::Setting;
use crate::check::SeveritySetting;
use crate::check::Variable;
use crate::source::Text;

/// Options of a check.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// Values of composite properties that count in place of those in the files.
    pub settings: Vec<Setting>,
    /// True if the settings are those of several fleets: one of a property that is not there is then a note.
    pub shared_settings: bool,
    /// Environment variables that composite properties can take their values from.
    pub variables: Vec<Variable>,
    /// Severities that count where composites say nothing else.
    pub severities: Vec<SeveritySetting>,
    /// True if what the registry does not know is taken as given: classes, and implementations of other kinds. There is
    /// no assembly then when a component has such a one.
    pub assume_classes: bool,
    /// True if the wiring of the fleet is judged as a whole, too: topics without another end, queues that overflow.
    pub wiring: bool,
    /// True if the code of plugins is left alone: what their constructors would say about values is not known then.
    pub without_plugin_code: bool,
}

impl Options {
    /// With these settings, everything else as usual.
    pub fn with_settings(settings: Vec<Setting>) -> Self {
        Self { settings, ..Self::default() }
    }

    /// The value of an environment variable.
    pub(crate) fn variable(&self, name: &str) -> Option<&Text> {
        self.variables.iter().find(|variable| variable.name == name).map(|variable| &variable.value)
    }
}
