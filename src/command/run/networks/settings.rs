//! The settings of networks: what components say of them, with passwords from where they are kept.

use std::collections::{BTreeMap, BTreeSet};
use std::env;
use std::path::Path;

use saoms_api::Secret;
use saoms_api::extension::{Access, FailureNotice, Router, RouterClass, TlsPaths};
use saoms_core::network::key;
use saoms_core::network::rights::Grant;
use saoms_core::network::transport::{Account, Carrier, SessionSettings, TlsFiles, TransportError, peers};
use saoms_lang::assembly::{Assembly, ComponentSpec, RemoteTarget, TaskProperties};
use saoms_lang::diagnostic::{Diagnostic, codes};

use super::private;

/// A connection to a network as its components describe it: where several say something, the first one counts; that
/// they do not differ was checked.
#[derive(Debug, Default)]
pub(super) struct Described {
    /// The component that is the network's router here.
    pub(super) router: Option<(usize, Router)>,
    user: Option<(usize, String)>,
    password: Option<(usize, Secret)>,
    password_file: Option<(usize, String)>,
    tls: TlsPaths,
    /// The components that give the files for TLS.
    tls_of: [usize; 3],
    /// The first component on the network.
    first: usize,
}

/// The networks of an assembly, by their urls. A component that is called over one, and may be on none itself, is where
/// those are that call it, and as they say. Components are numbered as in [`Assembly::all`].
pub(super) fn described(assembly: &Assembly) -> BTreeMap<String, Described> {
    let mut all: BTreeMap<String, Described> = BTreeMap::new();
    for (index, spec) in assembly.components.iter().enumerate() {
        if let Some(router) = RouterClass::read(&spec.class.declaration().name, &spec.values) {
            let known =
                all.entry(router.url.clone()).or_insert_with(|| Described { first: index, ..Described::default() });
            known.router.get_or_insert((index, router));
        }
    }
    let is_here = |end: &RemoteTarget| end.node == assembly.node;
    let calls = |spec: &ComponentSpec| spec.references.iter().flat_map(|wire| &wire.elsewhere).any(is_here);
    for (index, spec) in assembly.all().enumerate() {
        let is_on = index < assembly.components.len() || calls(spec);
        let Some(task) = spec.task.as_ref().filter(|_| is_on) else { continue };
        let Some(url) = &task.url else { continue };
        let known = all.entry(url.clone()).or_insert_with(|| Described { first: index, ..Described::default() });
        known.add(index, task);
    }
    all
}

impl Described {
    fn add(&mut self, index: usize, task: &TaskProperties) {
        fn first<T: Clone>(known: &mut Option<(usize, T)>, index: usize, given: Option<&T>) {
            if known.is_none() {
                *known = given.map(|given| (index, given.clone()));
            }
        }
        first(&mut self.user, index, task.user.as_ref());
        first(&mut self.password, index, task.password.as_ref());
        first(&mut self.password_file, index, task.password_file.as_ref());
        let given = [
            (&mut self.tls.ca, &task.tls_ca),
            (&mut self.tls.certificate, &task.tls_certificate),
            (&mut self.tls.key, &task.tls_key),
        ];
        for (place, (known, given)) in given.into_iter().enumerate() {
            if known.is_none() && given.is_some() {
                known.clone_from(given);
                self.tls_of[place] = index;
            }
        }
    }
}

/// Makes settings of what components say, and notes what cannot be used.
pub(super) struct Resolver<'r> {
    pub(super) assembly: &'r Assembly,
    /// The name of the program.
    pub(super) name: &'r str,
    pub(super) faults: Vec<Diagnostic>,
}

impl Resolver<'_> {
    /// The settings of a connection. Faults are noted.
    pub(super) fn settings(&mut self, url: &str, described: &Described) -> SessionSettings {
        let mut settings = SessionSettings {
            url: url.to_owned(),
            listen: described.router.is_some(),
            peer: peers(url).is_some().then(|| self.name.to_owned()),
            account: None,
            users: Vec::new(),
            access: Vec::new(),
            tls: None,
        };
        let (tls, of) = match &described.router {
            Some((index, router)) => {
                settings.users = self.users(*index, router);
                settings.access = granted(described, &settings.users, self.assembly).iter().map(key::of_user).collect();
                (&router.tls, [*index; 3])
            }
            None => {
                if let Some((index, user)) = &described.user {
                    let file = described.password_file.as_ref().map(|(of, path)| (*of, path.as_str()));
                    let password = described.password.as_ref().map(|(of, secret)| (*of, secret));
                    settings.account = self.account(*index, user, password, file);
                }
                (&described.tls, described.tls_of)
            }
        };
        settings.tls = self.tls(tls, of);
        settings
    }

    /// Asks a transport whether it can use settings.
    pub(super) fn judge(&mut self, transport: Carrier, settings: &SessionSettings, described: &Described) {
        for fault in transport.judge(settings) {
            let router = described.router.as_ref().map(|(index, _)| *index);
            let tls = |place: usize| router.unwrap_or(described.tls_of[place]);
            let first = router.unwrap_or(described.first);
            let (component, property) = match fault.setting.as_str() {
                "ca" => (tls(0), "tlsCa"),
                "certificate" => (tls(1), "tlsCertificate"),
                "key" => (tls(2), "tlsKey"),
                "user" => (router.or(described.user.as_ref().map(|(index, _)| *index)).unwrap_or(first), "user"),
                "listen" => (first, if self.has(first, "transport") { "transport" } else { "IP" }),
                "users" => (first, if self.has(first, "users") { "users" } else { "user" }),
                _ if router.is_some() => (first, "IP"),
                _ => (first, "url"),
            };
            self.fault(component, property, &fault.text);
        }
    }

    /// Notes that a network of other programs has `nodes`, which need more than topics.
    pub(super) fn needs_more(&mut self, url: &str, described: &Described, nodes: bool) {
        let Some(ComponentSpec { path, .. }) = self.assembly.all().nth(described.first).filter(|_| nodes) else {
            return;
        };
        let Some(place) = self.assembly.places.get(path, "url") else { return };
        let message = format!(
            "components of several nodes are on the network `{url}`, which carries topics of other programs alone"
        );
        let one = Diagnostic::new(&codes::NODES_OVER_TOPICS, place, message);
        self.faults.push(one.help(
            "programs of one fleet need a network of their own, such as `host:port`; give one component this `url`, \
             which passes on what the others say",
        ));
    }

    /// Notes that there is no transport for the url of a network.
    pub(super) fn no_transport(&mut self, url: &str, described: &Described, error: &TransportError) {
        let (component, property) = match &described.router {
            Some((index, _)) => (*index, if self.has(*index, "transport") { "transport" } else { "IP" }),
            None => (described.first, "url"),
        };
        let Some(ComponentSpec { path, .. }) = self.assembly.all().nth(component) else { return };
        let Some(place) = self.assembly.places.get(path, property) else { return };
        let message = format!("component `{path}` is on the network `{url}`, but {error}");
        let one = Diagnostic::new(&codes::NO_TRANSPORT, place, message);
        self.faults.push(one.help("docs/networks.md says where the libraries of transports are looked for"));
    }

    /// Notes that the url of a network without a router does not name this program, but these.
    pub(super) fn unnamed(&mut self, described: &Described, named: &[&str]) {
        let Some(ComponentSpec { path, .. }) = self.assembly.all().nth(described.first) else { return };
        let Some(place) = self.assembly.places.get(path, "url") else { return };
        let named: Vec<String> = named.iter().map(|name| format!("`{name}`")).collect();
        let message =
            format!("this program, `{}`, is not among the peers of this network: {}", self.name, named.join(", "));
        let one = Diagnostic::new(&codes::PEER_MISSING, place, message);
        self.faults.push(one.help("a program is named by its node, or by the file of its composite"));
    }

    fn has(&self, component: usize, property: &str) -> bool {
        let Some(spec) = self.assembly.all().nth(component) else { return false };
        self.assembly.places.get(&spec.path, property) != self.assembly.places.get(&spec.path, "")
    }

    /// Notes what is wrong with a property of a component.
    fn fault(&mut self, component: usize, property: &str, text: &str) {
        let Some(ComponentSpec { path, .. }) = self.assembly.all().nth(component) else { return };
        let Some(place) = self.assembly.places.get(path, property) else { return };
        let message = format!("component `{path}`, property `{property}`: {text}");
        let one = Diagnostic::new(&codes::NETWORK_FILE, place, message);
        let one = one.help("docs/security.md says how a network is protected");
        if !self.faults.iter().any(|known| known.location == one.location && known.message == one.message) {
            self.faults.push(one);
        }
    }

    /// A path from the folder of the first composite.
    fn path(&self, path: &str) -> std::path::PathBuf {
        self.assembly.places.folder.join(Path::new(path.trim()))
    }

    /// A user with a password from where it is kept.
    fn account(
        &mut self,
        component: usize,
        user: &str,
        password: Option<(usize, &Secret)>,
        file: Option<(usize, &str)>,
    ) -> Option<Account> {
        let password = match (password, file) {
            (Some((of, secret)), _) => match secret.resolve(|name| env::var(name).ok()) {
                Ok(password) => password,
                Err(name) => {
                    let text = format!("the environment variable `{name}` is not set, or is no text in UTF-8");
                    self.fault(of, "password", &text);
                    return None;
                }
            },
            (None, Some((of, path))) => match private::read(&self.path(path)) {
                Ok(text) => text.trim_end_matches(['\n', '\r']).to_owned(),
                Err(text) => {
                    self.fault(of, "passwordFile", &text);
                    return None;
                }
            },
            (None, None) => {
                self.fault(component, "user", "there is no password: give `password` or `passwordFile`");
                return None;
            }
        };
        Some(Account { user: user.trim().to_owned(), password })
    }

    /// The users that a router accepts.
    fn users(&mut self, component: usize, router: &Router) -> Vec<Account> {
        let mut users = Vec::new();
        if let Some(user) = &router.user {
            let password = router.password.as_ref().map(|secret| (component, secret));
            let file = router.password_file.as_deref().map(|path| (component, path));
            users.extend(self.account(component, user, password, file));
        }
        let Some(path) = &router.users else { return users };
        let text = match private::read(&self.path(path)) {
            Ok(text) => text,
            Err(text) => {
                self.fault(component, "users", &text);
                return users;
            }
        };
        let mut seen: BTreeSet<String> = users.iter().map(|one| one.user.clone()).collect();
        for (line, text) in text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty()) {
            match text.split_once(':') {
                Some((user, password)) if seen.insert(user.to_owned()) => {
                    users.push(Account { user: user.to_owned(), password: password.to_owned() });
                }
                Some((user, _)) => {
                    let text = format!("user `{}` is there twice", user.escape_debug());
                    self.fault(component, "users", &text);
                }
                // The line may be a password.
                None => self.fault(component, "users", &format!("line {} of the file has no `:`", line + 1)),
            }
        }
        if users.is_empty() {
            self.fault(component, "users", "the file has no user: a line for each is `user:password`");
        }
        users
    }

    /// The files for TLS; the key is nobody else's.
    fn tls(&mut self, tls: &TlsPaths, of: [usize; 3]) -> Option<TlsFiles> {
        if *tls == TlsPaths::default() {
            return None;
        }
        if let Some(key) = &tls.key
            && let Err(text) = private::opened(&self.path(key))
        {
            self.fault(of[2], "tlsKey", &text);
            return None;
        }
        let path = |path: &Option<String>| path.as_ref().map(|path| self.path(path).display().to_string());
        Some(TlsFiles { ca: path(&tls.ca), certificate: path(&tls.certificate), key: path(&tls.key) })
    }
}

/// What a router lets each of its users do; nothing where all may do everything. Who is not named may do nothing.
pub(super) fn granted(described: &Described, users: &[Account], assembly: &Assembly) -> Vec<Grant> {
    let Some((_, router)) = described.router.as_ref().filter(|(_, router)| !router.access.is_empty()) else {
        return Vec::new();
    };
    let named = |user: &str| router.access.iter().find(|access| access.user == user).cloned();
    let of = |one: &Account| named(&one.user).unwrap_or_else(|| Access { user: one.user.clone(), ..Access::default() });
    users.iter().map(|user| with_nodes(of(user), assembly, &router.url)).collect()
}

/// Lets a user also do what the components of the nodes that it runs do on the network of a router.
fn with_nodes(mut access: Access, assembly: &Assembly, router: &str) -> Grant {
    let runs: BTreeSet<&str> = access.runs.iter().map(String::as_str).collect();
    let on_network = || assembly.all().filter(|spec| spec.url().is_some_and(|url| leads_to(url, router)));
    let calls = on_network().flat_map(|spec| {
        let ends = spec.references.iter().flat_map(|wire| &wire.elsewhere);
        ends.flat_map(|end| [spec.node.as_str(), end.node.as_str()])
    });
    let runs_calls = calls.into_iter().any(|node| runs.contains(node));
    for spec in on_network().filter(|spec| runs.contains(spec.node.as_str())) {
        spec.publishes().for_each(|topic| access.writes.add(&spec.topic(&topic.name)));
        spec.subscribes().for_each(|topic| access.reads.add(&spec.topic(&topic.name)));
        // The program speaks for a component that failed.
        let is_about = |notice: &&FailureNotice| spec.publishes().any(|topic| topic.name == notice.about.name);
        FailureNotice::linked().filter(is_about).for_each(|notice| access.writes.add(&spec.topic(notice.topic.name)));
    }
    Grant::new(access, runs_calls)
}

/// True if a url leads to a router: it is the address of the router, or has its port where the router listens at all
/// addresses of its machine.
fn leads_to(url: &str, router: &str) -> bool {
    let ends = |url: &str| {
        let address = url.rsplit_once("://").map_or(url, |(_, address)| address);
        address.rsplit_once(':').map(|(host, port)| (host.to_owned(), port.to_owned()))
    };
    let (Some((_, port)), Some((host, own_port))) = (ends(url), ends(router)) else { return url == router };
    url == router || ["0.0.0.0", "[::]"].contains(&&*host) && port == own_port
}

#[cfg(test)]
mod tests {
    use super::leads_to;

    #[test]
    fn urls_lead_to_the_router_at_their_address() {
        assert!(leads_to("gate:61616", "gate:61616") && leads_to("tls://gate:61616", "tls://0.0.0.0:61616"));
        assert!(!leads_to("gate:61616", "gate:61617") && !leads_to("gate:61616", "hall:61616"));
    }
}
