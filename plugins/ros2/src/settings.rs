//! The settings of a session.

use std::env;

use saoms_transport::Failure;
use serde::Deserialize;
use serde::de::IgnoredAny;
use serde_json::{Value, json};
use zenoh::Config;

/// The variable with the domain, as for all programs of ROS 2.
const DOMAIN: &str = "ROS_DOMAIN_ID";
/// The largest domain of ROS 2.
const MOST: u32 = 232;
/// Longest time for Zenoh to connect, in milliseconds.
const PATIENCE: u32 = 800;
/// Time without a sign of life after which the other end gives a link up, in milliseconds.
const LEASE: u32 = 2_000;

/// What the program says when it opens a session.
#[derive(Debug, Deserialize)]
pub(crate) struct Settings {
    url: String,
    #[serde(default)]
    pub(crate) listen: bool,
    /// What networks of ROS 2 do not have here.
    user: Option<IgnoredAny>,
    users: Option<IgnoredAny>,
    access: Option<IgnoredAny>,
    tls: Option<IgnoredAny>,
}

/// Why a setting is refused.
const UNSERVED: &str = "networks of ROS 2 have neither users nor TLS here: leave it out, and stay on this machine";

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
        let asked = asked.map(|(name, _)| (name, UNSERVED.to_owned()));
        let domain = domain(env::var(DOMAIN).ok().as_deref()).err().map(|text| ("url", text));
        asked.chain(domain).collect()
    }

    /// The domain: that of the environment.
    pub(crate) fn domain() -> Result<u32, Failure> {
        domain(env::var(DOMAIN).ok().as_deref()).map_err(Failure::failed)
    }

    /// The configuration of the session.
    pub(crate) fn config(&self) -> Result<Config, Failure> {
        let mut config = Config::default();
        let mut set = |key: &str, value: Value| {
            config.insert_json5(key, &value.to_string()).map_err(|error| Failure::failed(format!("{key}: {error}")))
        };
        let endpoint = json!([format!("tcp/{}", self.address())]);
        let (mode, here) = if self.listen { ("router", "listen") } else { ("client", "connect") };
        set("mode", json!(mode))?;
        set("listen/endpoints", json!([]))?;
        set(&format!("{here}/endpoints"), endpoint)?;
        if !self.listen {
            set("connect/timeout_ms", json!(PATIENCE))?;
            set("connect/retry", json!({"period_init_ms": 100, "period_max_ms": 500, "period_increase_factor": 2}))?;
        }
        set("scouting/multicast/enabled", json!(false))?;
        // Nodes are peers, which find each other through the router.
        set("scouting/gossip/enabled", json!(self.listen))?;
        set("scouting/delay", json!(0))?;
        set("transport/link/tx/lease", json!(LEASE))?;
        Ok(config)
    }
}

/// The domain that a text names; 0 without one.
pub(crate) fn domain(text: Option<&str>) -> Result<u32, String> {
    let Some(text) = text.map(str::trim).filter(|text| !text.is_empty()) else { return Ok(0) };
    let found = text.parse().ok().filter(|found| *found <= MOST);
    found.ok_or_else(|| format!("`{DOMAIN}` is `{}`, expected a number from 0 to {MOST}", text.escape_debug()))
}
