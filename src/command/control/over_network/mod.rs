//! Commands that reach all programs of a network at once, with `--url`.

mod asking;
mod collected;
mod following;
mod inbox;

use std::collections::BTreeMap;
use std::hash::{BuildHasher, RandomState};
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

use clap::Args;
use saoms_api::host::one_line;
use saoms_core::network::key;
use saoms_core::network::rights::Granted;
use saoms_core::network::transport::{Account, Opened, SessionSettings, TlsFiles, Transport, TransportSession};
use serde_json::Value;

use super::fleet::RunningFleetArguments;
use crate::Exit;
use crate::command::run::read_private;
use crate::output::displayed;
pub(super) use following::Followed;
use inbox::Inbox;

/// The variable of the environment with the password.
const PASSWORD: &str = "SAOMS_PASSWORD";

/// Tokens of subscriptions.
const ALIVE: u64 = 1;
const ANSWERS: u64 = 2;
const ACCESS: u64 = 3;

/// Options of commands that reach the programs of a network.
#[derive(Clone, Debug, Args)]
pub(crate) struct UrlArguments {
    /// Reach all programs on the network at this url, as the components name it; the answer names each program
    #[arg(long, value_name = "URL", conflicts_with_all = ["name", "token_file"])]
    pub(super) url: Option<String>,

    /// With `--url`: only this program, by its node or the name of its composite
    #[arg(long, value_name = "NAME", requires = "url")]
    pub(super) program: Option<String>,

    /// The user as which to join the network. The password is in the environment variable `SAOMS_PASSWORD`, or in
    /// `--password-file`
    #[arg(long, value_name = "USER", requires = "url")]
    user: Option<String>,

    /// The file with the password, which no other user may be able to read
    #[arg(long, value_name = "FILE", requires = "user")]
    password_file: Option<PathBuf>,

    /// The file (PEM) with the certificates of those who vouch for the broker
    #[arg(long, value_name = "FILE", requires = "url")]
    tls_ca: Option<PathBuf>,

    /// The file (PEM) with the own certificate, for a broker that asks for one
    #[arg(long, value_name = "FILE", requires = "tls_key")]
    tls_certificate: Option<PathBuf>,

    /// The file (PEM) with the key of this certificate
    #[arg(long, value_name = "FILE", requires = "tls_certificate")]
    tls_key: Option<PathBuf>,

    /// The library of the transport, or a folder with it; without it, libraries beside the command
    #[arg(long = "plugin", value_name = "PATH", requires = "url")]
    plugins: Vec<PathBuf>,
}

/// A program that was heard.
#[derive(Clone, Debug)]
struct Known {
    name: String,
    heard: Instant,
    /// Time after which it is missed, in milliseconds.
    patience: u64,
}

/// The programs of a network.
pub(super) struct Programs<'a> {
    fleet: &'a RunningFleetArguments,
    url: &'a str,
    /// The only one that is asked.
    only: Option<&'a str>,
    user: Option<&'a str>,
    session: TransportSession,
    inbox: Arc<Inbox>,
    /// A number that nobody else has.
    own: u64,
    /// The number of the last request.
    asked: u64,
    known: BTreeMap<u64, Known>,
    /// What the broker lets users do, if it has said so.
    granted: Option<Granted>,
}

/// The answer of a program.
#[derive(Clone, Debug)]
pub(super) struct Answered {
    /// The name of the program.
    pub(super) name: String,
    id: u64,
    /// The answer, or why it refuses.
    pub(super) result: Result<Value, String>,
}

/// Where two programs have one name, it does not say which is meant.
fn heading(name: &str) -> String {
    format!("program `{}`", one_line(name))
}

impl UrlArguments {
    /// The programs of the network that is named; `None` where none is. What hinders it is reported.
    pub(super) fn open<'a>(&'a self, fleet: &'a RunningFleetArguments) -> Option<Result<Programs<'a>, Exit>> {
        self.url.as_deref().map(|url| self.opened(url, fleet).map_err(|why| fleet.refuse(&why, Exit::WrongInput)))
    }

    fn opened<'a>(&'a self, url: &'a str, fleet: &'a RunningFleetArguments) -> Result<Programs<'a>, String> {
        let shown = one_line(url).into_owned();
        let transport = Transport::find(url, &self.plugins)
            .map_err(|error| format!("the network `{shown}` cannot be joined: {error}"))?;
        let settings = self.settings(url)?;
        if let Some(fault) = transport.judge(&settings).first() {
            let help = "docs/security.md says how a network is protected";
            return Err(format!("the network `{shown}`: {}\n  = help: {help}", fault.text));
        }
        let inbox = Arc::<Inbox>::default();
        let session = match TransportSession::open(transport, &settings, Arc::clone(&inbox) as Arc<_>) {
            Ok(Opened::Session(session)) => session,
            Ok(Opened::Unreachable(why)) => {
                let help = "start the message broker of this network, or correct the url";
                return Err(format!("no message broker is at `{shown}`: {why}\n  = help: {help}"));
            }
            Err(why) => return Err(format!("the network `{shown}` cannot be joined: {why}")),
        };
        let own = RandomState::new().hash_one(std::process::id());
        for (keys, token) in [(key::alive_of_all(), ALIVE), (key::controlled(own), ANSWERS), (key::access(), ACCESS)] {
            session.subscribe(&keys, token).map_err(|why| format!("the network `{shown}`: {why}"))?;
        }
        let (only, user) = (self.program.as_deref(), self.user.as_deref());
        let (known, granted) = (BTreeMap::new(), None);
        Ok(Programs { fleet, url, only, user, session, inbox, own, asked: 0, known, granted })
    }

    fn settings(&self, url: &str) -> Result<SessionSettings, String> {
        let account = self.user.as_ref().map(|user| {
            let password = match &self.password_file {
                Some(file) => read_private(file).map(|text| text.trim_end_matches(['\n', '\r']).to_owned()),
                None => std::env::var(PASSWORD).map_err(|_| {
                    format!(
                        "there is no password for user `{}`: set `{PASSWORD}`, or name a file with `--password-file`",
                        one_line(user)
                    )
                }),
            };
            password.map(|password| Account { user: user.clone(), password })
        });
        let path = |path: &Option<PathBuf>| path.as_ref().map(|path| displayed(path));
        let tls =
            TlsFiles { ca: path(&self.tls_ca), certificate: path(&self.tls_certificate), key: path(&self.tls_key) };
        let (users, access) = (Vec::new(), Vec::new());
        let tls = (tls != TlsFiles::default()).then_some(tls);
        let (url, account) = (url.to_owned(), account.transpose()?);
        Ok(SessionSettings { url, listen: false, peer: None, account, users, access, tls })
    }
}
