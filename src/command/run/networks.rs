//! The networks of a run: where the composites have a `url` or a message broker.

use std::collections::{BTreeMap, BTreeSet};
use std::hash::{BuildHasher, RandomState};
use std::sync::Arc;
use std::thread::sleep;
use std::time::{Duration, Instant};

use saoms_api::Level;
use saoms_api::extension::RouterClass;
use saoms_api::host::format_duration;
use saoms_core::network::exchange::Settings;
use saoms_core::network::transport::{Opened, SessionSettings, Transport, TransportError, TransportSession};
use saoms_core::network::{Client, Port};
use saoms_core::schedule::{Handle, StartError};
use saoms_lang::assembly::{Assembly, ComponentSpec};

use super::{RunArguments, title};
use crate::Exit;
use crate::output::eprint;

/// Pause before a network is tried again that is not there yet.
const PAUSE: Duration = Duration::from_millis(200);
/// Time without a sign of life after which a program is missed: three of its longest periods, between these.
const LEAST_PATIENCE: Duration = Duration::from_secs(1);
const LONGEST_PATIENCE: Duration = Duration::from_secs(10);
/// Bytes of events that are kept for programs that have not received them, at most.
const LIMIT: usize = 256 << 20;

/// The networks that a run takes part in.
#[derive(Debug)]
pub(super) struct Networks {
    all: Vec<Network>,
    name: String,
    /// Time without a sign of life after which others miss this program.
    patience: Duration,
    /// Time for which a network is waited for that is not there yet; `None` is for ever.
    wait: Option<Duration>,
    /// What has to be said once the run has a log.
    notes: Vec<String>,
}

#[derive(Debug)]
struct Network {
    transport: Transport,
    /// The components on it.
    components: BTreeSet<String>,
    /// The other nodes of the fleet that are on it.
    others: BTreeSet<String>,
    settings: SessionSettings,
}

impl Networks {
    /// The networks of an assembly, each with its transport.
    ///
    /// # Errors
    /// There is no transport for a url: it was reported.
    pub(super) fn of(arguments: &RunArguments, assembly: &Assembly) -> Result<Networks, Exit> {
        let mut networks = Networks {
            all: Vec::new(),
            name: arguments.node.clone().unwrap_or_else(|| title(arguments)),
            patience: LEAST_PATIENCE,
            wait: arguments.limit,
            notes: Vec::new(),
        };
        if arguments.virtual_time {
            return Ok(networks);
        }
        let periods = assembly.components.iter().filter_map(|spec| spec.task.as_ref()).map(|task| task.period);
        networks.patience =
            periods.max().map_or(LEAST_PATIENCE, |period| (3 * period).clamp(LEAST_PATIENCE, LONGEST_PATIENCE));
        let routers = routers(assembly);
        let mut urls: BTreeMap<&str, (Option<&str>, Option<&str>)> =
            routers.iter().map(|url| (url.as_str(), (None, None))).collect();
        for task in assembly.components.iter().filter_map(|spec| spec.task.as_ref()) {
            if let Some(url) = &task.url {
                let known = urls.entry(url).or_default();
                *known = (known.0.or(task.user.as_deref()), known.1.or(task.password.as_deref()));
            }
        }
        let mut is_missing = false;
        for (url, (user, password)) in urls {
            let listen = routers.iter().any(|router| router == url);
            match Transport::find(url, &arguments.fleet.plugins.plugins) {
                Ok(transport) => {
                    let (user, password) = (user.map(str::to_owned), password.map(str::to_owned));
                    let settings = SessionSettings { url: url.to_owned(), listen, user, password, tls: None };
                    let components = components(assembly, url);
                    networks.all.push(Network { transport, components, others: others(assembly, url), settings });
                }
                Err(error @ TransportError::Missing { .. }) if listen => networks.notes.push(format!(
                    "the topics of `{url}` are served inside this program, and no other program can join them: {error}"
                )),
                Err(error) => {
                    eprint(&format!("error: components of the fleet are on the network `{url}`, but {error}\n"));
                    is_missing = true;
                }
            }
        }
        if is_missing {
            eprint("\nnothing was started\n");
            return Err(Exit::WrongInput);
        }
        Ok(networks)
    }

    /// Joins the networks, in the code that gets the control before components initialize. Waits for networks that are
    /// not there yet, until the end is asked for.
    pub(super) fn join(self, handle: &Handle, is_over: impl Fn() -> bool) -> Result<Vec<Client>, StartError> {
        for note in self.notes {
            handle.note(Level::Warning, note);
        }
        let mut clients = Vec::new();
        for Network { transport, components, others, settings } in self.all {
            let port: Arc<Port> = Arc::default();
            let wait = Wait { longest: self.wait, is_over: &is_over };
            let Some(session) = opened(transport, &settings, &port, handle, &wait)? else { break };
            let fleet = handle.use_network(&settings.url, &port);
            let member = Settings {
                program: RandomState::new().hash_one(std::process::id()),
                name: self.name.clone(),
                patience: u64::try_from(self.patience.as_nanos()).unwrap_or(u64::MAX),
                limit: LIMIT,
                components,
                others,
            };
            let client = Client::start(session, &port, member, fleet);
            clients.push(client.map_err(|error| StartError::Network { url: settings.url.clone(), error })?);
        }
        Ok(clients)
    }
}

/// How long a network is waited for that is not there yet.
struct Wait<'a> {
    /// `None` is for ever.
    longest: Option<Duration>,
    /// True once the end was asked for.
    is_over: &'a dyn Fn() -> bool,
}

/// A session of a network; `None` if the end was asked for before it was there.
fn opened(
    transport: Transport,
    settings: &SessionSettings,
    port: &Arc<Port>,
    handle: &Handle,
    wait: &Wait<'_>,
) -> Result<Option<TransportSession>, StartError> {
    let url = &settings.url;
    let since = Instant::now();
    let mut has_waited = false;
    loop {
        match TransportSession::open(transport, settings, Arc::clone(port) as Arc<_>) {
            Ok(Opened::Session(session)) => {
                let what = if settings.listen { "listens at" } else { "has joined the network at" };
                handle.note(Level::Info, format!("the program {what} `{url}`"));
                return Ok(Some(session));
            }
            Ok(Opened::Unreachable(why)) => {
                if !std::mem::replace(&mut has_waited, true) {
                    handle.note(Level::Warning, format!("waits for the message broker at `{url}`: {why}"));
                }
            }
            Err(error) => return Err(StartError::Network { url: url.clone(), error }),
        }
        if (wait.is_over)() {
            return Ok(None);
        }
        sleep(PAUSE);
        if let Some(longest) = wait.longest.filter(|longest| since.elapsed() >= *longest) {
            let error = format!("no message broker was there within the {} of `--for`", format_duration(longest));
            return Err(StartError::Network { url: url.clone(), error });
        }
    }
}

/// The components of this program that are on a network.
fn components(assembly: &Assembly, url: &str) -> BTreeSet<String> {
    on(&assembly.components, url).map(|spec| spec.path.clone()).collect()
}

/// The other nodes of the fleet that have components on a network.
fn others(assembly: &Assembly, url: &str) -> BTreeSet<String> {
    on(&assembly.elsewhere, url).map(|spec| spec.node.to_string()).collect()
}

fn on<'s>(specs: &'s [ComponentSpec], url: &str) -> impl Iterator<Item = &'s ComponentSpec> {
    specs.iter().filter(move |spec| spec.task.as_ref().is_some_and(|task| task.url.as_deref() == Some(url)))
}

/// The addresses of the routers of an assembly.
fn routers(assembly: &Assembly) -> Vec<String> {
    let of = |name: &str| RouterClass::linked().find(|router| router.class == name);
    let known = assembly.components.iter().filter_map(|spec| {
        let router = of(&spec.class.declaration().name)?;
        // The checker has made one of these values.
        (router.address)(&spec.values).ok()
    });
    known.collect()
}
