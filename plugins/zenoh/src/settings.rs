//! The settings of a session, and what they are for Zenoh.

use std::fs::File;
use std::io::Write as _;
use std::os::fd::{AsRawFd as _, FromRawFd as _};

use saoms_transport::Failure;
use saoms_transport::tls::Files;
use serde::Deserialize;
use serde_json::{Value, json};
use zenoh::Config;

/// How long a client tries to reach its router before it says that it does not, in milliseconds.
const PATIENCE: u64 = 900;
/// Time without a sign of life after which a link is given up, in milliseconds.
const LEASE: u64 = 1_000;

/// Batches of 64 kB that wait to be sent over a link, at most; more than 16 Zenoh does not allow.
const MOST_BATCHES: usize = 16;

/// What the program says when it opens a session.
#[derive(Deserialize)]
pub(super) struct Settings {
    pub(super) url: String,
    #[serde(default)]
    pub(super) listen: bool,
    /// The name of this program among peers; none: it is reached by nobody, and reaches all.
    peer: Option<String>,
    pub(super) user: Option<String>,
    password: Option<String>,
    #[serde(default)]
    users: Vec<Account>,
    #[serde(default)]
    access: Vec<Access>,
    #[serde(default)]
    pub(super) tls: Files,
}

/// A user that a router accepts.
#[derive(Deserialize)]
struct Account {
    user: String,
    password: String,
}

/// The keys that a user may use.
#[derive(Deserialize)]
struct Access {
    user: String,
    put: Vec<String>,
    subscribe: Vec<String>,
}

/// A configuration, with what it names while a session is opened with it.
pub(super) struct Prepared {
    pub(super) config: Config,
    /// The users that a router accepts: Zenoh reads them from a file, which is in memory alone.
    _users: Option<File>,
}

impl Settings {
    pub(super) fn read(text: &str) -> Result<Settings, Failure> {
        serde_json::from_str(text).map_err(Failure::failed)
    }

    /// The endpoint in the terms of Zenoh.
    pub(super) fn endpoint(&self) -> String {
        match self.url.split_once("://") {
            Some((scheme, rest)) => format!("{scheme}/{rest}"),
            None => format!("tcp/{}", self.url),
        }
    }

    /// Where this program listens and what it connects to, if the url names all programs. Of two programs the later one
    /// connects to the other one: two links between them would be one too many.
    pub(super) fn of_peers(&self) -> Option<(Option<String>, Vec<String>)> {
        let (scheme, list) = self.url.split_once("://")?;
        let scheme = match scheme {
            "peers" => "tcp",
            "peers+tls" => "tls",
            _ => return None,
        };
        let named = list.split(',').filter_map(|peer| peer.split_once('='));
        let named: Vec<(&str, String)> = named.map(|(name, address)| (name, format!("{scheme}/{address}"))).collect();
        let own = named.iter().position(|(name, _)| Some(*name) == self.peer.as_deref());
        let others = named.iter().take(own.unwrap_or(named.len())).map(|(_, endpoint)| endpoint.clone()).collect();
        Some((own.map(|own| named[own].1.clone()), others))
    }

    /// Host and port.
    pub(super) fn address(&self) -> &str {
        self.url.split_once("://").map_or(&self.url, |(_, rest)| rest)
    }

    /// True if the connection is encrypted.
    pub(super) fn is_tls(&self) -> bool {
        self.url.starts_with("tls://") || self.url.starts_with("peers+tls://")
    }

    /// What Zenoh cannot take: the setting and why.
    pub(super) fn unfit(&self) -> Option<(&'static str, String)> {
        if self.of_peers().is_some() && self.user.is_some() {
            return Some(("user", "peers know no users: they recognise each other by certificates".to_owned()));
        }
        let own = self.user.iter().zip(&self.password).map(|(user, password)| ("user", user, password));
        let all = own.chain(self.users.iter().map(|one| ("users", &one.user, &one.password)));
        for (setting, user, password) in all {
            let why = match () {
                () if user.is_empty() || user.trim() != user || user.contains([':', '\n']) => {
                    "a name without `:`, and without blanks at its ends"
                }
                () if password.is_empty() || password.trim() != password || password.contains('\n') => {
                    "a password in one line, not empty, and without blanks at its ends"
                }
                () => continue,
            };
            return Some((setting, format!("user `{}` needs {why}", user.escape_debug())));
        }
        None
    }

    /// The configuration of the session.
    pub(super) fn prepare(&self) -> Result<Prepared, Failure> {
        if let Some((_, why)) = self.unfit() {
            return Err(Failure::failed(why));
        }
        let mut config = Config::default();
        let mut set = |key: &str, value: Value| {
            config.insert_json5(key, &value.to_string()).map_err(|error| Failure::failed(format!("{key}: {error}")))
        };
        let peers = self.of_peers();
        let (mode, here) = match () {
            () if peers.is_some() => ("peer", "listen"),
            () if self.listen => ("router", "listen"),
            () => ("client", "connect"),
        };
        set("mode", json!(mode))?;
        set("listen/endpoints", json!([]))?;
        if let Some((own, others)) = &peers {
            set("listen/endpoints", json!(own.iter().collect::<Vec<_>>()))?;
            set("connect/endpoints", json!(others))?;
            // They may start later.
            set("connect/timeout_ms", json!(-1))?;
            set("connect/exit_on_failure", json!(false))?;
        } else {
            set(&format!("{here}/endpoints"), json!([self.endpoint()]))?;
        }
        if peers.is_none() && !self.listen {
            set("connect/timeout_ms", json!(PATIENCE))?;
        }
        if peers.is_some() || !self.listen {
            set("connect/retry", json!({"period_init_ms": 100, "period_max_ms": 500, "period_increase_factor": 2}))?;
        }
        set("scouting/multicast/enabled", json!(false))?;
        set("scouting/gossip/enabled", json!(false))?;
        set("scouting/delay", json!(0))?;
        set("transport/link/tx/lease", json!(LEASE))?;
        // Room for a burst. What finds none waits for 1 ms, and is dropped then: without that wait, a program that
        // sends as much as the machine carries would lose most of it.
        set("transport/link/tx/queue/size/data", json!(MOST_BATCHES))?;
        let mut users = None;
        if let (Some(user), Some(password)) = (&self.user, &self.password) {
            set("transport/auth/usrpwd/user", json!(user))?;
            set("transport/auth/usrpwd/password", json!(password))?;
        }
        if !self.users.is_empty() {
            let file = self.users_in_memory().map_err(Failure::failed)?;
            let path = format!("/proc/self/fd/{}", file.as_raw_fd());
            set("transport/auth/usrpwd/dictionary_file", json!(path))?;
            users = Some(file);
        }
        if !self.access.is_empty() {
            set("access_control", self.access_control())?;
        }
        if self.is_tls() {
            let Files { ca, certificate, key } = &self.tls;
            // A router asks for certificates, a client shows its own, and a peer does both.
            let is_mutual = if self.listen { ca.is_some() } else { certificate.is_some() };
            set("transport/link/tls/enable_mtls", json!(is_mutual))?;
            if let Some(ca) = ca {
                set("transport/link/tls/root_ca_certificate", json!(ca))?;
            }
            if let (Some(certificate), Some(key)) = (certificate, key) {
                let both = ["listen", "connect"].into_iter().filter(|side| peers.is_some() || *side == here);
                for side in both {
                    set(&format!("transport/link/tls/{side}_certificate"), json!(certificate))?;
                    set(&format!("transport/link/tls/{side}_private_key"), json!(key))?;
                }
            }
        }
        Ok(Prepared { config, _users: users })
    }

    /// A file in memory with the users, a line `user:password` each.
    fn users_in_memory(&self) -> std::io::Result<File> {
        // SAFETY: the name is a text with a zero at its end.
        let descriptor = unsafe { libc::memfd_create(c"users".as_ptr(), libc::MFD_CLOEXEC) };
        if descriptor < 0 {
            return Err(std::io::Error::last_os_error());
        }
        // SAFETY: the descriptor is new, and nobody else's.
        let mut file = unsafe { File::from_raw_fd(descriptor) };
        for Account { user, password } in &self.users {
            writeln!(file, "{user}:{password}")?;
        }
        Ok(file)
    }

    /// What the users may do, in the terms of Zenoh: what nobody allows is denied.
    fn access_control(&self) -> Value {
        let mut rules = Vec::new();
        let (mut subjects, mut policies) = (Vec::new(), Vec::new());
        for (number, Access { user, put, subscribe }) in self.access.iter().enumerate() {
            let mut allow = |what: &str, message: &str, flow: &str, keys: &[String]| {
                let id = format!("{number} {what}");
                rules.push(json!({
                    "id": id, "messages": [message], "flows": [flow], "permission": "allow", "key_exprs": keys,
                }));
                id
            };
            let ids = [
                allow("sends", "put", "ingress", put),
                // A client sends nothing that nobody has asked for.
                allow("hears who reads", "declare_subscriber", "egress", put),
                allow("reads", "declare_subscriber", "ingress", subscribe),
                allow("receives", "put", "egress", subscribe),
            ];
            let subject = number.to_string();
            subjects.push(json!({"id": subject, "usernames": [user]}));
            policies.push(json!({"rules": ids, "subjects": [subject]}));
        }
        json!({
            "enabled": true, "default_permission": "deny",
            "rules": rules, "subjects": subjects, "policies": policies,
        })
    }
}
