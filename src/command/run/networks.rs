//! The networks of a run: where the composites have a `url` or a message broker.

mod hooks;
mod private;
mod settings;

use std::collections::{BTreeMap, BTreeSet};
use std::hash::{BuildHasher, RandomState};
use std::panic::resume_unwind;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::{self, sleep};
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use saoms_api::Level;
use saoms_api::host::format_duration;
use saoms_core::network::exchange::Settings;
use saoms_core::network::exchange::wire::LARGEST_NUMBER;
use saoms_core::network::rights::Granted;
use saoms_core::network::transport::{
    Carrier, Opened, Receiver, SessionSettings, TopicSession, TransportError, TransportSession, peers,
};
use saoms_core::network::{Client, Entrance, Entry, Membership, Port, Refused as Occupied, TopicMembership};
use saoms_core::schedule::{Handle, StartError};
use saoms_lang::assembly::{Assembly, ComponentSpec};
use saoms_lang::diagnostic::Diagnostic;
use saoms_lang::model::Hangup;

use super::ending::Signalled;
use super::{RunArguments, title};
pub(super) use hooks::Door;
use hooks::Hooks;
pub(in crate::command) use private::read as read_private;
use settings::Resolver;

/// Reasons for which a network is waited for that are told, at most.
const MOST_REASONS: usize = 8;
/// What people do about a broker that is not there.
const TO_DO: &str = "start it, or correct `url`";
/// Pause before a network is tried again that is not there yet.
const PAUSE: Duration = Duration::from_millis(200);
/// Time between two looks at what others say before the components begin.
const LOOK: Duration = Duration::from_millis(5);
/// The bits of the number of a program that differ between its networks.
const NETWORK_BITS: u64 = 0xff;
/// Time without a sign of life after which a program is missed: three of its longest periods, between these. Signs of
/// life wait for no execution, so that more would only keep people, and the end, waiting.
const LEAST_PATIENCE: Duration = Duration::from_secs(1);
const LONGEST_PATIENCE: Duration = Duration::from_secs(10);

/// The networks that a run takes part in.
#[derive(Debug)]
pub(super) struct Networks {
    all: Vec<Network>,
    name: String,
    /// The node of the program.
    node: Option<String>,
    /// Time without a sign of life after which others miss this program.
    patience: Duration,
    /// The time of `--for`.
    limit: Option<Duration>,
    /// Time for which a network is waited for that is not there yet; `None` is for ever.
    wait: Option<Duration>,
    /// Time for which the end is waited with for programs that lack events.
    linger: Duration,
    /// Bytes of events that are kept for programs that have not received them, at most.
    backlog: usize,
    /// What a lost link leads to.
    lost_link: Hangup,
    /// What has to be said once the run has a log.
    notes: Vec<String>,
}

#[derive(Debug)]
struct Network {
    transport: Carrier,
    /// The components on it.
    components: BTreeSet<String>,
    /// The one that is its router here.
    router: Option<String>,
    /// The other nodes of the fleet that are on it.
    others: BTreeSet<String>,
    settings: SessionSettings,
    membership: Membership,
}

impl Network {
    /// Who joins it.
    fn who(&self) -> Who<'_> {
        Who { components: &self.components, router: self.router.as_deref(), settings: &self.settings }
    }
}

/// The reason for which there are no networks, which is in the list of diagnostics.
#[derive(Clone, Copy, Debug)]
pub(super) struct Refused;

impl Networks {
    /// The networks of an assembly, each with its transport. What is wrong with their settings is added to
    /// `diagnostics`.
    ///
    /// # Errors
    /// There is no transport for a url, or the settings of a network are wrong.
    pub(super) fn of(
        arguments: &RunArguments,
        assembly: &Assembly,
        diagnostics: &mut Vec<Diagnostic>,
    ) -> Result<Networks, Refused> {
        let mut networks = Networks {
            all: Vec::new(),
            name: arguments.node.clone().unwrap_or_else(|| title(arguments)),
            node: arguments.node.clone(),
            patience: LEAST_PATIENCE,
            limit: arguments.limit,
            wait: arguments.connect_timeout,
            linger: arguments.linger,
            backlog: usize::try_from(arguments.backlog).unwrap_or(usize::MAX),
            lost_link: assembly.run.lost_link.unwrap_or(Hangup::GoOn),
            notes: Vec::new(),
        };
        if arguments.virtual_time {
            return Ok(networks);
        }
        let periods = assembly.components.iter().filter_map(|spec| spec.task.as_ref()).map(|task| task.period);
        networks.patience =
            periods.max().map_or(LEAST_PATIENCE, |period| (3 * period).clamp(LEAST_PATIENCE, LONGEST_PATIENCE));
        let name = networks.name.clone();
        let mut resolver = Resolver { assembly, name: &name, faults: Vec::new() };
        for (url, described) in settings::described(assembly) {
            let listen = described.router.is_some();
            if let Some(named) = peers(&url) {
                if arguments.node.is_none() && assembly.nodes().len() > 1 {
                    // All peers are in this program, which is told.
                    continue;
                }
                let named: Vec<&str> = named.map(|(name, _)| name).collect();
                if !named.contains(&name.as_str()) {
                    resolver.unnamed(&described, &named);
                }
            }
            match Carrier::find(&url, &arguments.fleet.plugins.plugins) {
                Ok(transport) => {
                    if matches!(transport, Carrier::Topics(_)) {
                        resolver.needs_more(&url, &described, !others(assembly, &url).is_empty());
                    }
                    let settings = resolver.settings(&url, &described);
                    if resolver.faults.is_empty() {
                        resolver.judge(transport, &settings, &described);
                    }
                    let granted = settings::granted(&described, &settings.users, assembly);
                    let membership = Membership {
                        url: url.clone(),
                        peers: peers(&url).into_iter().flatten().filter(|(peer, _)| *peer != name).map(owned).collect(),
                        user: settings.account.as_ref().map(|account| account.user.clone()),
                        grants: (!granted.is_empty()).then(|| Granted::of(&granted)),
                        readers: readers(assembly, &url),
                        has_calls: assembly.calls_over(&url).next().is_some(),
                    };
                    let (components, others) = (components(assembly, &url), others(assembly, &url));
                    let router = described.router.as_ref();
                    let router = router.map(|(index, _)| assembly.components[*index].path.clone());
                    networks.all.push(Network { transport, components, router, others, settings, membership });
                }
                Err(error @ TransportError::Missing { .. }) if listen => networks.notes.push(format!(
                    "the topics of `{url}` are served inside this program, and no other program can join them: {error}"
                )),
                Err(error) => resolver.no_transport(&url, &described, &error),
            }
        }
        // Another program may need what this one serves before it serves what this one needs.
        networks.all.sort_by_key(|network| !network.settings.listen);
        let is_wrong = !resolver.faults.is_empty();
        diagnostics.extend(resolver.faults);
        if is_wrong { Err(Refused) } else { Ok(networks) }
    }

    /// Joins the networks, in the code that gets the control before components initialize. Waits for networks that are
    /// not there yet, until the end is asked for. No network hears of the program before all accept it.
    ///
    /// # Errors
    /// One cannot be joined: none is.
    pub(super) fn join(
        self,
        handle: &Handle,
        signals: &Signalled,
        door: &Arc<Door>,
    ) -> Result<Vec<Client>, StartError> {
        for note in self.notes {
            handle.note(Level::Warning, note);
        }
        let wait = Wait { longest: self.wait, limit: self.limit, is_over: &|| signals.has_come() };
        // Of two programs that begin at once, the same one begins on each of their networks, as the later one.
        let program = RandomState::new().hash_one(std::process::id()) & !NETWORK_BITS;
        let date = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default().as_nanos();
        let entrance = Entrance::default();
        let mut asking =
            Asking { entrance, places: Vec::new(), handle, wait: &wait, node: self.node.as_deref(), all: &self.all };
        let (mut parts, mut clients) = (Vec::new(), Vec::new());
        for (number, network) in self.all.iter().enumerate() {
            let Network { transport, components, others, settings, membership, .. } = network;
            let port: Arc<Port> = Arc::default();
            let who = network.who();
            let hooks = Hooks {
                fleet: handle.clone(),
                lost_link: self.lost_link,
                ending: signals.ending(),
                door: Arc::clone(door),
            };
            let transport = match *transport {
                Carrier::Messages(transport) => transport,
                Carrier::Topics(transport) => {
                    let open = |receiver| TopicSession::open(transport, settings, receiver);
                    let Some((session, _)) = asking.open(&who, &port, &open)? else { return Ok(Vec::new()) };
                    let fleet = handle.use_topics(&settings.url, &port, hooks);
                    let (url, listens) = (settings.url.clone(), settings.listen);
                    let membership = TopicMembership { url, listens, patience: self.patience };
                    let client = Client::prepare_topics(session, &port, membership, fleet);
                    clients.push(client.map_err(|error| who.error(&error))?);
                    continue;
                }
            };
            let open = |receiver| TransportSession::open(transport, settings, receiver);
            let Some((session, has_waited)) = asking.open(&who, &port, &open)? else { return Ok(Vec::new()) };
            let fleet = handle.use_network(&settings.url, &port, hooks);
            let program = program | (number as u64 & NETWORK_BITS);
            let memory = fleet.recall(program);
            // The clock may have been set back since the last start.
            let earlier = memory.as_ref().map_or(0, |memory| memory.start);
            let member = Settings {
                program,
                began: u64::try_from(date).unwrap_or_default().max(earlier).min(LARGEST_NUMBER),
                name: self.name.clone(),
                patience: u64::try_from(self.patience.as_nanos()).unwrap_or(u64::MAX),
                limit: self.backlog,
                linger: u64::try_from(self.linger.as_nanos()).unwrap_or(u64::MAX),
                components: components.clone(),
                others: others.clone(),
                memory,
            };
            let is_fresh = has_waited || !membership.peers.is_empty();
            let added = asking.entrance.add(session, &port, member, membership, is_fresh, Instant::now());
            added.map_err(|error| who.error(&error))?;
            asking.places.push(number);
            parts.push((who, fleet, membership));
        }
        while asking.look()? != Entry::Free {
            if signals.has_come() {
                return Ok(Vec::new());
            }
            sleep(LOOK);
        }
        for (entered, (who, fleet, membership)) in asking.entrance.into_all().into_iter().zip(parts) {
            let client = Client::prepare(entered, membership.clone(), fleet);
            clients.push(client.map_err(|error| who.error(&error))?);
        }
        clients.iter_mut().for_each(Client::begin);
        Ok(clients)
    }
}

/// A program that asks on networks whether it may begin.
struct Asking<'a> {
    entrance: Entrance,
    /// The places of those networks among all.
    places: Vec<usize>,
    all: &'a [Network],
    handle: &'a Handle,
    wait: &'a Wait<'a>,
    /// The node of the program.
    node: Option<&'a str>,
}

impl Asking<'_> {
    /// Whether the program may begin on the networks that it has joined, which are the first of all.
    fn look(&mut self) -> Result<Entry, StartError> {
        let network = |place: usize| self.all.get(*self.places.get(place)?);
        let tell = |text: String| self.handle.note(Level::Warning, text);
        let entry = self.entrance.look(Instant::now(), self.wait.shortest(), tell);
        let entry = entry.map_err(|Occupied { place, why }| StartError::Network {
            url: network(place).map(|network| network.settings.url.clone()).unwrap_or_default(),
            error: in_node(&why, self.node),
        })?;
        match entry {
            Entry::Lost(place) => match network(place) {
                Some(network) => Err(network.who().gone(self.wait)),
                None => Ok(Entry::Open),
            },
            entry => Ok(entry),
        }
    }

    /// A session of a network, and whether it was waited for; `None` if the end was asked for before it was there.
    /// Meanwhile others on the networks before it are answered.
    fn open<S: Send>(
        &mut self,
        who: &Who<'_>,
        port: &Arc<Port>,
        open: Open<'_, S>,
    ) -> Result<Option<(S, bool)>, StartError> {
        let (handle, given, is_refused) = (self.handle, self.wait, AtomicBool::new(false));
        let is_over = || is_refused.load(Ordering::Relaxed) || (given.is_over)();
        let wait = Wait { is_over: &is_over, ..*given };
        thread::scope(|scope| {
            let name = "saoms-network".to_owned();
            let opening =
                thread::Builder::new().name(name).spawn_scoped(scope, || who.opened(open, port, handle, &wait));
            let opening = opening.map_err(|error| who.error(&format!("the system cannot create a thread: {error}")))?;
            let mut refused = None;
            while !opening.is_finished() {
                if refused.is_none() {
                    refused = self.look().err();
                    is_refused.store(refused.is_some(), Ordering::Relaxed);
                }
                sleep(LOOK);
            }
            let opened = opening.join().unwrap_or_else(|panic| resume_unwind(panic));
            refused.map_or(opened, Err)
        })
    }
}

/// How long a network is waited for that is not there yet.
struct Wait<'a> {
    /// The time of `--connect-timeout`; `None` is for ever.
    longest: Option<Duration>,
    /// The time of `--for`.
    limit: Option<Duration>,
    /// True once the end was asked for.
    is_over: &'a (dyn Fn() -> bool + Sync),
}

impl Wait<'_> {
    /// The shorter of both times.
    fn shortest(&self) -> Option<Duration> {
        self.longest.into_iter().chain(self.limit).min()
    }
}

/// Opens a session that delivers to a receiver.
type Open<'o, S> = &'o (dyn Fn(Arc<dyn Receiver>) -> Result<Opened<S>, String> + Sync);

/// Who joins a network.
struct Who<'a> {
    components: &'a BTreeSet<String>,
    /// The one that is the router here.
    router: Option<&'a str>,
    settings: &'a SessionSettings,
}

impl Who<'_> {
    /// The components, for people.
    fn shown(&self) -> String {
        let all = self.components.iter().map(String::as_str);
        let mut all = self.router.into_iter().chain(all.filter(|_| self.router.is_none()));
        let first = all.next().unwrap_or_default();
        match all.count() {
            0 => format!("component `{first}`"),
            1 => format!("component `{first}` and another one"),
            more => format!("component `{first}` and {more} more"),
        }
    }

    fn error(&self, why: &str) -> StartError {
        let verb = if self.settings.listen { "serves" } else { "needs" };
        let error = format!("{why} ({} {verb} it)", self.shown());
        StartError::Network { url: self.settings.url.clone(), error }
    }

    /// The time of `--connect-timeout` has passed.
    fn not_in_time(&self, longest: Duration, why: &str) -> StartError {
        let within = match longest {
            Duration::ZERO => String::new(),
            longest => format!(" within the {} of `--connect-timeout`", format_duration(longest)),
        };
        self.error(&format!("no message broker was there{within}: {why}: {TO_DO}"))
    }

    /// The time of `--for` has passed.
    fn not_in_run(&self, limit: Duration) -> StartError {
        let limit = format_duration(limit);
        self.error(&format!("no message broker was there within the {limit} of `--for`: {TO_DO}"))
    }

    /// The link was lost before the components began, and the shorter of both times has passed since.
    fn gone(&self, wait: &Wait<'_>) -> StartError {
        match (wait.longest, wait.limit) {
            (longest, Some(limit)) if longest.is_none_or(|longest| limit < longest) => self.not_in_run(limit),
            (longest, _) => self.not_in_time(longest.unwrap_or_default(), "the link to it was lost"),
        }
    }

    /// A session of the network, and whether it was waited for; `None` if the end was asked for before it was there.
    fn opened<S>(
        &self,
        open: Open<'_, S>,
        port: &Arc<Port>,
        handle: &Handle,
        wait: &Wait<'_>,
    ) -> Result<Option<(S, bool)>, StartError> {
        let url = &self.settings.url;
        let since = Instant::now();
        let mut told: Vec<String> = Vec::new();
        loop {
            let why = match open(Arc::clone(port) as Arc<_>) {
                Ok(Opened::Session(session)) => {
                    // Who joins says so once it hears all that its components read.
                    if self.settings.listen {
                        handle.note(Level::Info, format!("the program listens at `{url}`"));
                    }
                    return Ok(Some((session, !told.is_empty())));
                }
                Ok(Opened::Unreachable(why)) => why,
                Err(error) => return Err(self.error(&error)),
            };
            let over = |longest: Option<Duration>| longest.filter(|longest| since.elapsed() >= *longest);
            if let Some(longest) = over(wait.longest) {
                return Err(self.not_in_time(longest, &why));
            }
            if !told.contains(&why) && told.len() < MOST_REASONS {
                let needs =
                    format!("{} {}", self.shown(), if self.components.len() == 1 { "needs it" } else { "need it" });
                handle
                    .note(Level::Warning, format!("waits for the message broker at `{url}`: {why}: {TO_DO}; {needs}"));
                told.push(why);
            }
            if (wait.is_over)() {
                return Ok(None);
            }
            sleep(PAUSE);
            if let Some(limit) = over(wait.limit) {
                return Err(self.not_in_run(limit));
            }
        }
    }
}

/// What is wrong with the components of a node.
fn in_node(why: &str, node: Option<&str>) -> String {
    node.map_or_else(|| why.to_owned(), |node| format!("{why}; this program runs node `{node}`"))
}

fn owned((name, address): (&str, &str)) -> (String, String) {
    (name.to_owned(), address.to_owned())
}

/// The components of this program that are on a network, those among them that are called over it.
fn components(assembly: &Assembly, url: &str) -> BTreeSet<String> {
    let called = assembly.calls_over(url).filter(|(_, end)| end.node == assembly.node);
    let called = called.map(|(_, end)| end.component.clone());
    on(&assembly.components, url).map(|spec| spec.path.clone()).chain(called).collect()
}

/// The other nodes of the fleet that have components on a network.
fn others(assembly: &Assembly, url: &str) -> BTreeSet<String> {
    let called = assembly.calls_over(url).map(|(_, end)| &end.node).filter(|node| **node != assembly.node);
    on(&assembly.elsewhere, url).map(|spec| &spec.node).chain(called).map(ToString::to_string).collect()
}

fn on<'s>(specs: &'s [ComponentSpec], url: &str) -> impl Iterator<Item = &'s ComponentSpec> {
    specs.iter().filter(move |spec| spec.url() == Some(url))
}

/// The components of a network that read each topic.
fn readers(assembly: &Assembly, url: &str) -> BTreeMap<String, Vec<String>> {
    let mut readers: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for spec in on(&assembly.components, url) {
        for topic in spec.subscribes() {
            let known = readers.entry(spec.topic(&topic.name).into_owned()).or_default();
            if known.last() != Some(&spec.path) {
                known.push(spec.path.clone());
            }
        }
    }
    readers
}
