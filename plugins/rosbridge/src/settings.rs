//! The settings of a session.

use saoms_transport::Failure;
use serde::Deserialize;
use serde::de::IgnoredAny;

/// What the program says when it opens a session.
#[derive(Debug, Deserialize)]
pub(crate) struct Settings {
    url: String,
    #[serde(default)]
    pub(crate) listen: bool,
    /// What rosbridge does not have: it lets everybody in, and encrypts nothing.
    user: Option<IgnoredAny>,
    users: Option<IgnoredAny>,
    access: Option<IgnoredAny>,
    tls: Option<IgnoredAny>,
}

/// Why a setting is refused.
const UNSERVED: &str =
    "rosbridge has neither users nor TLS here: leave it out, and let it listen on this machine alone";

impl Settings {
    pub(crate) fn read(text: &str) -> Result<Settings, Failure> {
        serde_json::from_str(text).map_err(Failure::failed)
    }

    /// Host and port.
    pub(crate) fn address(&self) -> &str {
        self.url.split_once("://").map_or(&self.url, |(_, rest)| rest)
    }

    /// What cannot be used: the setting and why.
    pub(crate) fn judge(&self) -> Vec<(&'static str, String)> {
        let asked = [("user", &self.user), ("users", &self.users), ("access", &self.access), ("ca", &self.tls)];
        let asked = asked.into_iter().filter(|(_, given)| given.is_some());
        asked.map(|(name, _)| (name, UNSERVED.to_owned())).collect()
    }
}
