use std::path::PathBuf;

use crate::model::{Hangup, HttpAddress};

/// What the outermost composites say of the run.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct RunPolicy {
    /// The address that changes of alerts are sent to, if the user allows it.
    pub alert_url: Option<AlertUrl>,
    /// The command that is run for changes of alerts, if the user allows it.
    pub alert_command: Option<AlertCommand>,
    /// What a lost terminal leads to.
    pub hangup: Hangup,
    /// What a lost link to the other programs of a network leads to; without it the run goes on.
    pub lost_link: Option<Hangup>,
}

/// An address for alerts.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AlertUrl {
    /// The address.
    pub address: HttpAddress,
    /// The environment variable with the token that it asks for.
    pub token_env: Option<String>,
}

/// A command of the shell for alerts.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AlertCommand {
    /// The command.
    pub line: String,
    /// The folder in which it runs: that of the composite, from the present one on; empty for the present one.
    pub folder: PathBuf,
}
