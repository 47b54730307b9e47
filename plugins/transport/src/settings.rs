//! The settings of a session at a broker of others.

use std::net::IpAddr;

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
    pub(crate) listen: bool,
    /// The user as which the program joins.
    pub user: Option<String>,
    /// The password of this user.
    pub password: Option<String>,
    pub(crate) access: Option<IgnoredAny>,
    pub(crate) users: Option<IgnoredAny>,
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

    /// True if the broker is on this machine.
    fn is_here(&self) -> bool {
        let host = self.host();
        host.eq_ignore_ascii_case("localhost") || host.parse::<IpAddr>().is_ok_and(|address| address.is_loopback())
    }

    /// True if what is said leaves this machine, and is not encrypted.
    pub fn is_unprotected<L: Language>(&self) -> bool {
        !self.is_tls::<L>() && !self.is_here()
    }

    /// True if the connection is encrypted.
    pub(crate) fn is_tls<L: Language>(&self) -> bool {
        self.url.strip_prefix(L::WITH_TLS).is_some_and(|rest| rest.starts_with("://"))
    }

    /// What cannot be used of the url: the setting and why. No file is read.
    pub fn judge_url<L: Language>(&self) -> Vec<(&'static str, String)> {
        let (plain, with_tls, url) = (L::NAME.to_ascii_lowercase(), L::WITH_TLS, &self.url);
        let scheme = url.split_once("://").map(|(scheme, _)| scheme);
        if !scheme.is_some_and(|scheme| scheme == plain || scheme == with_tls) {
            let expected = format!("`{plain}://host:port`, or `{with_tls}://host:port` with TLS");
            return vec![("url", format!("found `{}`, expected {expected}", url.escape_debug()))];
        }
        // That of a fleet is judged, with its severity, where its composite is checked.
        if !self.is_of_fleet && self.password.is_some() && self.is_unprotected::<L>() {
            let text = format!(
                "a password is for `{url}`, which has no TLS: write `{with_tls}://host:port`, or whoever is on the way \
                 reads it"
            );
            return vec![("password", text)];
        }
        Vec::new()
    }

    /// What cannot be used: the setting and why.
    pub(crate) fn judge<L: Language>(&self) -> Vec<(&'static str, String)> {
        if self.listen || self.users.is_some() || self.access.is_some() {
            // The rest is about a place where it will not stand.
            return vec![("listen", L::NO_ROUTER.to_owned())];
        }
        let mut faults = self.judge_url::<L>();
        if !faults.is_empty() {
            return faults;
        }
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mqtt::Mqtt;
    use crate::stomp::Stomp;

    /// What else has a scheme was taken for one without TLS, and the password left as it is.
    #[test]
    fn a_url_has_a_scheme_of_its_language() {
        let account = || Some(("fleet".to_owned(), "sesame".to_owned()));
        let settings = |url: &str| Settings::new(url.to_owned(), account(), Files::default());
        for url in ["ssl://b:8883", "MQTTS://b:8883", "tls://b:8883", "stomp://b:1883", "b:1883", "mqtts:b", ""] {
            let faults = settings(url).judge::<Mqtt>();
            assert!(faults[0].1.contains("expected `mqtt://host:port`, or `mqtts://"), "{url}: {faults:?}");
        }
        assert_eq!(settings("stomp+ssl://b:61612").judge_url::<Stomp>(), []);
        for (url, expected) in [
            ("mqtts://b:8883", None),
            ("mqtt://localhost:1883", None),
            ("mqtt://127.0.0.2:1883", None),
            ("mqtt://[::1]:1883", None),
            ("mqtt://10.0.0.5:1883", Some("password")),
        ] {
            assert_eq!(settings(url).judge_url::<Mqtt>().first().map(|fault| fault.0), expected, "{url}");
            assert_eq!(settings(url).is_unprotected::<Mqtt>(), expected.is_some(), "{url}");
        }
        let of_fleet = Settings { is_of_fleet: true, ..settings("mqtt://10.0.0.5:1883") };
        assert_eq!(of_fleet.judge::<Mqtt>(), []);
    }
}
