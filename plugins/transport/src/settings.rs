//! The settings of a session at a broker of others.

use serde::Deserialize;
use serde::de::IgnoredAny;

use crate::tls::{self, Files};
use crate::{Failure, Language};

/// What the program says when it opens a session.
#[derive(Deserialize)]
pub struct Settings {
    /// Where the broker is.
    pub url: String,
    #[serde(default)]
    listen: bool,
    /// The user as which the program joins.
    pub user: Option<String>,
    /// The password of this user.
    pub password: Option<String>,
    access: Option<IgnoredAny>,
    users: Option<IgnoredAny>,
    #[serde(default)]
    pub(crate) tls: Files,
    /// True if it is a network of a fleet, which takes the right to send and read all that begins with `saoms`.
    #[serde(skip, default = "is_of_fleet")]
    pub(crate) is_of_fleet: bool,
}

fn is_of_fleet() -> bool {
    true
}

impl Settings {
    /// Those of a program that joins a broker at a url for something else than a network of a fleet.
    pub fn new(url: String, account: Option<(String, String)>, tls: Files) -> Settings {
        let (user, password) = account.unzip();
        Settings { url, listen: false, user, password, access: None, users: None, tls, is_of_fleet: false }
    }

    pub(crate) fn read(text: &str) -> Result<Settings, Failure> {
        serde_json::from_str(text).map_err(Failure::failed)
    }

    /// Host and port.
    pub fn address(&self) -> &str {
        self.url.split_once("://").map_or(&self.url, |(_, rest)| rest)
    }

    /// The host.
    pub fn host(&self) -> &str {
        let host = self.address().rsplit_once(':').map_or(self.address(), |(host, _)| host);
        host.trim_start_matches('[').trim_end_matches(']')
    }

    /// True if the connection is encrypted.
    pub(crate) fn is_tls<L: Language>(&self) -> bool {
        self.url.strip_prefix(L::WITH_TLS).is_some_and(|rest| rest.starts_with("://"))
    }

    /// What cannot be used: the setting and why.
    pub(crate) fn judge<L: Language>(&self) -> Vec<(&'static str, String)> {
        if self.listen || self.users.is_some() || self.access.is_some() {
            // The rest is about a place where it will not stand.
            return vec![("listen", L::NO_ROUTER.to_owned())];
        }
        let mut faults = Vec::new();
        let lines = |text: &Option<String>| text.as_ref().is_some_and(|text| text.contains(['\n', '\r', '\0']));
        let user = self.user.as_deref().unwrap_or("no name");
        if user.is_empty() || lines(&self.user) || lines(&self.password) {
            let user = user.escape_debug();
            faults.push(("user", format!("user `{user}` needs a name and a password in one line each, not empty")));
        }
        let is_tls = self.is_tls::<L>();
        let instead = format!("{}://host:port", L::WITH_TLS);
        faults.extend(tls::judge(&self.tls, is_tls, &instead));
        if is_tls && self.tls.ca.is_none() {
            let text = "nobody says who vouches for the certificate of the broker: give `tlsCa`";
            faults.push(("ca", text.to_owned()));
        }
        faults
    }
}
