//! What a composite says of the run of its fleet: where alerts are delivered, what a lost terminal or link
//! leads to, and which node is the default.

use super::HttpAddress;
use crate::source::{Located, Text};

/// What a lost terminal (SIGHUP) or a lost link to other programs leads to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Hangup {
    /// The run ends.
    #[default]
    End,
    /// All that moves is stopped until it is released, and the run goes on.
    Hold,
    /// The run goes on.
    GoOn,
}

impl Hangup {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::End, Self::Hold, Self::GoOn];

    /// As it is written.
    pub const fn name(self) -> &'static str {
        match self {
            Self::End => "end",
            Self::Hold => "hold",
            Self::GoOn => "goOn",
        }
    }

    /// The one that is written so.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|one| one.name() == name)
    }
}

/// The attributes of a composite in the namespace of SAOMS. They count where the composite is an outermost one.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RunSettings {
    /// `alertUrl`
    pub alert_url: Option<Located<HttpAddress>>,
    /// `alertTokenEnv`
    pub alert_token_env: Option<Text>,
    /// `alertCommand`
    pub alert_command: Option<Text>,
    /// `hangup`
    pub hangup: Option<Located<Hangup>>,
    /// `lostLink`
    pub lost_link: Option<Located<Hangup>>,
    /// `defaultNode`
    pub default_node: Option<Text>,
    /// Those that are written, also with a wrong value: the name with its prefix, and the place of the whole attribute.
    pub written: Vec<Text>,
}

impl RunSettings {
    /// The environment variable with the token for the address.
    pub fn token(&self) -> Option<&str> {
        self.alert_token_env.as_ref().map(|name| name.as_str())
    }
}
