//! The settings of a session, and what they are for Zenoh.

use serde::Deserialize;
use serde_json::{Value, json};
use zenoh::Config;

use super::Failure;

/// How long a client tries to reach its router before it says that it does not, in milliseconds.
const PATIENCE: u64 = 900;
/// Time without a sign of life after which a link is given up, in milliseconds.
const LEASE: u64 = 1_000;

/// What the program says when it opens a session.
#[derive(Debug, Deserialize)]
pub(super) struct Settings {
    pub(super) url: String,
    #[serde(default)]
    pub(super) listen: bool,
    user: Option<String>,
    password: Option<String>,
    tls: Option<Tls>,
}

/// Paths of files.
#[derive(Debug, Deserialize)]
struct Tls {
    ca: Option<String>,
    certificate: Option<String>,
    key: Option<String>,
}

impl Settings {
    /// The endpoint in the terms of Zenoh.
    fn endpoint(&self) -> String {
        match self.url.split_once("://") {
            Some((scheme, rest)) => format!("{scheme}/{rest}"),
            None => format!("tcp/{}", self.url),
        }
    }

    /// Host and port.
    pub(super) fn address(&self) -> &str {
        self.url.split_once("://").map_or(&self.url, |(_, rest)| rest)
    }

    /// The configuration of the session.
    pub(super) fn config(&self) -> Result<Config, Failure> {
        let mut config = Config::default();
        let mut set = |key: &str, value: Value| {
            config.insert_json5(key, &value.to_string()).map_err(|error| Failure::failed(format!("{key}: {error}")))
        };
        let (mode, here) = if self.listen { ("router", "listen") } else { ("client", "connect") };
        set("mode", json!(mode))?;
        set("listen/endpoints", json!([]))?;
        set(&format!("{here}/endpoints"), json!([self.endpoint()]))?;
        if !self.listen {
            set("connect/timeout_ms", json!(PATIENCE))?;
            set("connect/retry", json!({"period_init_ms": 100, "period_max_ms": 500, "period_increase_factor": 2}))?;
        }
        set("scouting/multicast/enabled", json!(false))?;
        set("scouting/gossip/enabled", json!(false))?;
        set("scouting/delay", json!(0))?;
        set("transport/link/tx/lease", json!(LEASE))?;
        if let (Some(user), Some(password)) = (&self.user, &self.password) {
            set("transport/auth/usrpwd/user", json!(user))?;
            set("transport/auth/usrpwd/password", json!(password))?;
        }
        if let Some(tls) = &self.tls {
            let sides = ["listen", "connect"];
            set("transport/link/tls/enable_mtls", json!(tls.ca.is_some() && tls.certificate.is_some()))?;
            if let Some(ca) = &tls.ca {
                set("transport/link/tls/root_ca_certificate", json!(ca))?;
            }
            for side in sides {
                if let (Some(certificate), Some(key)) = (&tls.certificate, &tls.key) {
                    set(&format!("transport/link/tls/{side}_certificate"), json!(certificate))?;
                    set(&format!("transport/link/tls/{side}_private_key"), json!(key))?;
                }
            }
        }
        Ok(config)
    }
}
