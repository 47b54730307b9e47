//! The networks of a fleet: its brokers, and what its components say of their connections.

use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};

use saoms_api::extension::{Router, RouterClass, Topics};

use crate::assembly::{TaskProperties, on_bus};
use crate::check::component::ComponentCheck;
use crate::check::fleet::Fleet;
use crate::check::report::{Report, list};
use crate::check::tasks::broker_address::{
    encrypted, fault, host_and_port, ip, is_in_clear, is_loopback, is_of_topics, is_plain, peers,
};
use crate::diagnostic::{Diagnostic, Severity, codes, nearest, quoted};
use crate::source::Location;

const PROTECT: &str = "give it `user` and `password`, `transport` tls, `tlsCertificate` and `tlsKey`: see docs/security.md; or, \
    in a network that you trust, set `unprotected` to true";

/// Reports what is wrong with the networks of a fleet.
pub(crate) fn check(fleet: &Fleet<'_>, checks: &[ComponentCheck<'_>], report: &mut Report<'_>) {
    report.about_all();
    let networks = Networks::of(fleet, checks);
    let faulty = networks.routers.iter().filter(|(place, router)| networks.router(*place, router, report));
    let faulty: Vec<&str> = faulty.map(|(_, router)| router.url.as_str()).collect();
    networks.protection(report);
    networks.peers(report);
    networks.topics_alone(report);
    networks.shared_ports(report);
    networks.unserved(&faulty, report);
    networks.differences(report);
    networks.shared_topics(report);
}

struct Networks<'n, 'a> {
    fleet: &'n Fleet<'a>,
    checks: &'n [ComponentCheck<'a>],
    /// The brokers, with their places in the fleet.
    routers: Vec<(usize, Router)>,
    /// The components on a network, with their urls.
    tasks: Vec<(usize, &'n str, &'n TaskProperties)>,
    /// True if there may be brokers that are not known, for a fault of theirs.
    is_part: bool,
}

impl<'n, 'a> Networks<'n, 'a> {
    fn of(fleet: &'n Fleet<'a>, checks: &'n [ComponentCheck<'a>]) -> Self {
        let (mut routers, mut tasks, mut is_part) = (Vec::new(), Vec::new(), false);
        for (place, check) in checks.iter().enumerate().filter(|(place, _)| fleet.members[*place].runs()) {
            let class = fleet.class_of(place).filter(|_| check.is_sound());
            let Some(class) = class else {
                is_part = true;
                continue;
            };
            let name = &class.class.declaration().name;
            match RouterClass::read(name, check.given.own()) {
                Some(router) => routers.push((place, router)),
                // Its class refuses its values.
                None => is_part |= RouterClass::linked().any(|router| router.class == name),
            }
            if let Some(task) = &check.task {
                let url = task.url.as_deref().filter(|url| fault(url).is_none());
                tasks.extend(url.map(|url| (place, url, task)));
            }
        }
        Self { fleet, checks, routers, tasks, is_part }
    }

    /// Where a component gives a property, or else its name.
    fn at(&self, place: usize, property: &str) -> Location {
        self.given(place, property).unwrap_or(self.fleet.members[place].component.name.location)
    }

    fn given(&self, place: usize, property: &str) -> Option<Location> {
        Some(self.checks[place].given.get(property)?.place)
    }

    /// True if two components run in one program.
    fn are_together(&self, one: usize, other: usize) -> bool {
        self.fleet.members[one].node == self.fleet.members[other].node
    }

    /// Reports what is wrong with one broker. True if it is about TLS.
    fn router(&self, place: usize, router: &Router, report: &mut Report<'_>) -> bool {
        self.account(place, router, report);
        self.access(place, router, report);
        let given = |name: &str, is: bool| self.given(place, name).filter(|_| is);
        let tls = &router.tls;
        let pair = (given("tlsCertificate", tls.certificate.is_some()), given("tlsKey", tls.key.is_some()));
        let first = given("tlsCa", tls.ca.is_some()).or(pair.0).or(pair.1);
        if tls_files(&router.url, first, pair, report) {
            return true;
        }
        if router.url.starts_with("tls://") && pair == (None, None) {
            let message = format!("the broker at {} has no certificate", quoted(&router.url));
            report.push(
                Diagnostic::new(&codes::TLS_SETTINGS, self.at(place, "transport"), message)
                    .help("give `tlsCertificate` and `tlsKey`: programs recognise the broker by them"),
            );
            return true;
        }
        let is_open = !is_loopback(&router.url) && !router.is_unprotected;
        let asks = router.has_users() || tls.ca.is_some();
        let what = match (asks, is_plain(&router.url)) {
            (false, true) => "asks for no password, and does not encrypt",
            (false, false) => "asks for no password",
            (true, true) => "does not encrypt what it receives, passwords among it",
            (true, false) => return false,
        };
        if is_open {
            let message = format!("other machines can reach the broker at {}, which {what}", quoted(&router.url));
            report.push(Diagnostic::new(&codes::OPEN_BROKER, self.at(place, "IP"), message).help(PROTECT));
        }
        false
    }

    /// Reports what is wrong with the protection of each network, as its components describe it together.
    fn protection(&self, report: &mut Report<'_>) {
        let mut seen: Vec<&str> = Vec::new();
        for (place, url, _) in &self.tasks {
            if seen.contains(url) {
                continue;
            }
            seen.push(url);
            let first = |name: &str, is: fn(&TaskProperties) -> bool| {
                let mut of = self.tasks.iter().filter(|(_, known, task)| known == url && is(task));
                of.find_map(|(place, ..)| self.given(*place, name))
            };
            let pair = (
                first("tlsCertificate", |task| task.tls_certificate.is_some()),
                first("tlsKey", |task| task.tls_key.is_some()),
            );
            let files = first("tlsCa", |task| task.tls_ca.is_some()).or(pair.0).or(pair.1);
            let is_told = tls_files(url, files, pair, report);
            let Some(tls) = encrypted(url).filter(|_| !is_told && !is_loopback(url) && peers(url).is_none()) else {
                continue;
            };
            let at = self.at(*place, "url");
            let password = first("password", |task| task.password.is_some());
            let one = match password.or(first("passwordFile", |task| task.password_file.is_some())) {
                Some(password) => {
                    let message = format!(
                        "a password is for {}, which has no TLS: who is on the way can take the connection over",
                        quoted(url)
                    );
                    Diagnostic::new(&codes::CREDENTIALS_IN_CLEAR, at, message).label(password, "the password")
                }
                None => {
                    let message = format!("messages to {} go over the network without protection", quoted(url));
                    Diagnostic::new(&codes::UNPROTECTED_NETWORK, at, message)
                }
            };
            let tls = quoted(&tls);
            report.push(one.help(match is_plain(url) {
                true => {
                    format!("write {tls}, and give the broker `transport` tls and certificates: see docs/security.md")
                }
                false => {
                    format!("write {tls} with `tlsCa`, and let the broker listen there with TLS: see docs/brokers.md")
                }
            }));
        }
    }

    /// Reports networks of other programs' topics that are asked for more: to join the nodes of a fleet, or to be
    /// protected.
    fn topics_alone(&self, report: &mut Report<'_>) {
        let mut first: BTreeMap<&str, usize> = BTreeMap::new();
        for (place, url, _) in self.tasks.iter().filter(|(_, url, _)| is_of_topics(url)) {
            let Some(other) = first.get(url) else {
                first.insert(url, *place);
                if !is_loopback(url) {
                    let message = format!("messages to {} go over the network without protection", quoted(url));
                    let one = Diagnostic::new(&codes::UNPROTECTED_NETWORK, self.at(*place, "url"), message);
                    report.push(one.help("use it on one machine, in a network that you trust, or through a tunnel"));
                }
                continue;
            };
            if !self.are_together(*other, *place) {
                let message = format!(
                    "components of two nodes are on the network {}, which carries topics of other programs alone",
                    quoted(url)
                );
                let one = Diagnostic::new(&codes::NODES_OVER_TOPICS, self.at(*place, "url"), message);
                report.push(one.label(self.at(*other, "url"), "in another node").help(
                    "programs of one fleet need a network of their own, such as `host:port`: see docs/networks.md",
                ));
                return;
            }
        }
    }

    /// Reports what is wrong with the networks without a broker: other machines reach them, or a node is not named.
    fn peers(&self, report: &mut Report<'_>) {
        let mut seen: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
        for (place, url, task) in &self.tasks {
            let Some(named) = peers(url) else { continue };
            let is_first = !seen.contains_key(url);
            let nodes = seen.entry(url).or_default();
            if is_first && !is_loopback(url) {
                let of_network = || self.tasks.iter().filter(|(_, known, _)| known == url).map(|(.., task)| task);
                let has = |is: fn(&TaskProperties) -> bool| of_network().any(|task| is(task));
                let is_mutual = has(|task| task.tls_ca.is_some()) && has(|task| task.tls_certificate.is_some());
                if is_in_clear(url) || !is_mutual {
                    let message = "other machines can reach these peers, which do not ask for certificates";
                    let one = Diagnostic::new(&codes::OPEN_BROKER, self.at(*place, "url"), message);
                    report.push(one.help(
                        "write `peers+tls://`, and give `tlsCa`, `tlsCertificate` and `tlsKey`: see docs/security.md",
                    ));
                }
            }
            if task.user.is_some() && is_first {
                let message = "peers know no users: none of them is the broker that would ask for one";
                let one = Diagnostic::new(&codes::CREDENTIALS, self.at(*place, "user"), message);
                report.push(one.severity(Severity::Error).help(
                    "leave `user` and its password out; peers recognise each other by certificates, with `peers+tls://`",
                ));
            }
            let node = self.fleet.members[*place].node.as_str();
            let names: Vec<&str> = named.map(|(name, _)| name).collect();
            if node.is_empty() || nodes.contains(&node) || names.contains(&node) {
                continue;
            }
            nodes.push(node);
            let at = self.at(*place, "url");
            let message = format!("node {} is not among the peers of this network", quoted(node));
            let one = Diagnostic::new(&codes::PEER_MISSING, at, message);
            report.push(one.help(match nearest(node, names.iter().copied()) {
                Some(near) => format!("write {} in place of {}", quoted(node), quoted(near)),
                None => format!("add `,{node}=host:port`, with the address at which its program listens"),
            }));
        }
    }

    /// Reports an account that is incomplete.
    fn account(&self, place: usize, router: &Router, report: &mut Report<'_>) {
        let given = |name: &str, is: bool| self.given(place, name).filter(|_| is);
        let user = given("user", router.user.is_some());
        let password = given("password", router.password.is_some());
        let file = given("passwordFile", router.password_file.is_some());
        let (at, message, help) = match (user, password, file) {
            (_, Some(_), Some(file)) => (file, "`password` and `passwordFile` are both given", "keep one of them"),
            (None, Some(at), None) => (at, "`password` is given without `user`", "give both, or neither"),
            (None, None, Some(at)) => (at, "`passwordFile` is given without `user`", "give both, or neither"),
            (Some(at), None, None) => (at, "`user` is given without `password`", "give both, or neither"),
            _ => return,
        };
        // Without a user the broker would ask for nothing.
        report.push(Diagnostic::new(&codes::CREDENTIALS, at, message).severity(Severity::Error).help(help));
    }

    /// Reports access that nobody can have, or that nothing enforces.
    fn access(&self, place: usize, router: &Router, report: &mut Report<'_>) {
        let places = self.checks[place].given.places_of("access");
        let Some(first) = places.first().filter(|_| !router.access.is_empty()) else { return };
        let mut fault = |index: usize, message: String, help: &str| {
            let at = *places.get(index).unwrap_or(first);
            report.push(Diagnostic::new(&codes::ACCESS, at, message).help(help));
        };
        if !router.has_users() {
            let message = "the broker has `access`, and asks for no user".to_owned();
            return fault(0, message, "give it `user` and `password`, or `users`");
        }
        // Topics of components that are on other machines alone are not known here.
        let known = self.topics_of(&router.url);
        let nodes: BTreeSet<&str> = self.fleet.members.iter().map(|member| &*member.node).collect();
        for (index, access) in router.access.iter().enumerate() {
            let user = quoted(&access.user);
            if router.users.is_none() && Some(&access.user) != router.user.as_ref() {
                let message = format!("the broker accepts no user {user}");
                fault(index, message, "name further users in the file of `users`");
            }
            if router.access[..index].iter().any(|other| other.user == access.user) {
                fault(index, format!("the access of {user} is given twice"), "keep one of them");
            }
            for node in access.runs.iter().filter(|node| !nodes.contains(&***node)) {
                let message = format!("no component names node {}, which {user} runs", quoted(node));
                let meant = nearest(node, nodes.iter().copied().filter(|node| !node.is_empty()));
                let help = meant.map(|meant| format!("{} is meant", quoted(meant)));
                fault(index, message, &help.unwrap_or("components name their nodes with `saoms:node`".to_owned()));
            }
            for name in [&access.reads, &access.writes].into_iter().flat_map(Topics::names) {
                let meant = nearest(name, known.keys().map(|topic| &**topic));
                if let Some(meant) = meant.filter(|_| !known.contains_key(&**name)) {
                    let message = format!("no component has topic {}, which {user} has access to", quoted(name));
                    fault(index, message, &format!("{} is meant", quoted(meant)));
                }
            }
        }
    }

    /// Reports brokers that listen at one port.
    fn shared_ports(&self, report: &mut Report<'_>) {
        for (index, (place, router)) in self.routers.iter().enumerate() {
            let is_same =
                |(other, one): &&(usize, Router)| self.are_together(*place, *other) && collide(&router.url, &one.url);
            let Some((first, other)) = self.routers[..index].iter().find(is_same) else { continue };
            let message =
                format!("the brokers at {} and {} listen at one port", quoted(&router.url), quoted(&other.url));
            let one = Diagnostic::new(&codes::BROKERS_COLLIDE, self.at(*place, "port"), message);
            report.push(one.label(self.at(*first, "port"), "the other one").help("give each another `port`"));
        }
    }

    /// True if a broker of the fleet serves a url. Names of this machine are known alone: others may mean it, too.
    fn is_served(&self, url: &str) -> bool {
        if peers(url).is_some() {
            return true;
        }
        let serves =
            |router: &Router| router.url == url || collide(&router.url, url) && is_same_transport(&router.url, url);
        self.routers.iter().any(|(_, router)| serves(router))
    }

    /// Reports urls that no broker of the fleet serves, where it has brokers: others may run elsewhere. Those of faulty
    /// brokers may be meant otherwise.
    fn unserved(&self, faulty: &[&str], report: &mut Report<'_>) {
        if self.routers.is_empty() || self.is_part {
            return;
        }
        let mut seen: Vec<&str> = Vec::new();
        for (place, url, task) in &self.tasks {
            if seen.contains(url) {
                continue;
            }
            seen.push(url);
            let is_told =
                is_plain(url) && (!is_loopback(url) || task.tls_ca.is_some() || task.tls_certificate.is_some());
            let near = self.routers.iter().map(|(_, router)| router.url.as_str()).find(|router| collide(router, url));
            // Who listens there is no program of the fleet.
            let is_elsewhere = is_of_topics(url) && near.is_none();
            if is_elsewhere || self.is_served(url) || near.is_some_and(|near| is_told || faulty.contains(&near)) {
                continue;
            }
            let message = format!("the fleet has no broker at {}", quoted(url));
            let one = Diagnostic::new(&codes::NO_BROKER, self.at(*place, "url"), message);
            let urls = list(self.routers.iter().map(|(_, router)| router.url.as_str()));
            report.push(match near {
                Some(near) => one.help(format!("write {}, as the broker has it", quoted(near))),
                None => one.help(format!("its brokers are at {urls}; or start another program that has this one")),
            });
        }
    }

    /// Reports accounts and certificates of one url that differ.
    fn differences(&self, report: &mut Report<'_>) {
        let mut first: BTreeMap<(&str, &str, &str), (usize, String)> = BTreeMap::new();
        for (place, url, task) in &self.tasks {
            let node = self.fleet.members[*place].node.as_str();
            let password = task.password.as_ref();
            let password =
                password.map(|secret| secret.resolve(|_| None).unwrap_or_else(|variable| format!("${variable}")));
            let given = [
                ("user", task.user.clone()),
                ("password", password),
                ("passwordFile", task.password_file.clone()),
                ("tlsCa", task.tls_ca.clone()),
                ("tlsCertificate", task.tls_certificate.clone()),
                ("tlsKey", task.tls_key.clone()),
            ];
            for (name, value) in given {
                let Some(value) = value else { continue };
                let (other, known) = first.entry((node, url, name)).or_insert_with(|| (*place, value.clone()));
                if *known != value {
                    let paths = [*place, *other].map(|place| quoted(self.fleet.members[place].path()));
                    let message = format!(
                        "components {} and {} differ in `{name}` for {}: their program has one connection to it",
                        paths[0],
                        paths[1],
                        quoted(url)
                    );
                    let one = Diagnostic::new(&codes::NETWORK_SETTINGS_DIFFER, self.at(*place, name), message);
                    let one = one.label(self.at(*other, name), "the other one");
                    report.push(one.help("give both the same: by a `source`, or in one of them alone"));
                }
            }
        }
    }

    /// The topics of the components of a network, each with the first component.
    fn topics_of(&self, url: &str) -> BTreeMap<Cow<'n, str>, usize> {
        let mut topics = BTreeMap::new();
        for (place, _, task) in self.tasks.iter().filter(|(_, known, _)| *known == url) {
            let Some(class) = self.fleet.class_of(*place) else { continue };
            for topic in class.publishes.iter().chain(&class.subscribes) {
                let name = on_bus(&self.fleet.members[*place].site, task.topic_rename.name(&topic.name));
                topics.entry(name.into_owned().into()).or_insert(*place);
            }
        }
        topics
    }

    /// Reports topics that components of two networks use, once for each network but the first.
    fn shared_topics(&self, report: &mut Report<'_>) {
        let mut urls: Vec<&str> = Vec::new();
        for (_, url, _) in &self.tasks {
            // That there is no broker is told.
            if !urls.contains(url) && (self.routers.is_empty() || self.is_served(url)) {
                urls.push(url);
            }
        }
        let mut known: BTreeMap<Cow<'_, str>, usize> = BTreeMap::new();
        for url in urls {
            let own = self.topics_of(url);
            // Of topics between nodes another rule tells.
            let shared = own.iter().filter_map(|(topic, place)| Some((&**topic, *place, *known.get(topic)?)));
            let shared: Vec<(&str, usize, usize)> =
                shared.filter(|(_, place, other)| self.are_together(*place, *other)).collect();
            if let Some((_, place, other)) = shared.iter().min_by_key(|(_, place, _)| *place) {
                let topics = list(shared.iter().map(|(topic, ..)| *topic));
                let what = if shared.len() == 1 { "topic" } else { "topics" };
                let message = format!("components of two networks use {what} {topics}");
                let one = Diagnostic::new(&codes::TOPIC_ON_NETWORKS, self.at(*place, "url"), message);
                report.push(one.label(self.at(*other, "url"), "the other network").help(
                    "what is published goes to the publisher's network alone: give all one `url`, or rename the topics with \
                     `topicRename`",
                ));
            }
            own.into_iter().for_each(|(topic, place)| _ = known.entry(topic).or_insert(place));
        }
    }
}

/// Reports files for TLS that are incomplete, or for a network without it: where the first of them is given, and where
/// certificate and key are. True if there is such a fault.
fn tls_files(
    url: &str,
    first: Option<Location>,
    pair: (Option<Location>, Option<Location>),
    report: &mut Report<'_>,
) -> bool {
    let Some(first) = first else { return false };
    let both = "give both: the key shows that the certificate is one's own";
    let (at, message, help) = match pair {
        _ if is_in_clear(url) => {
            let named = encrypted(url).unwrap_or_default();
            (
                first,
                format!("the files for TLS are not used: {} is without TLS", quoted(url)),
                format!("name the network {}, or leave them out", quoted(&named)),
            )
        }
        _ if is_of_topics(url) => {
            let message = format!("the files for TLS are not used: {} is without TLS", quoted(url));
            (first, message, "leave them out".to_owned())
        }
        (Some(at), None) => (at, "`tlsCertificate` is given without `tlsKey`".to_owned(), both.to_owned()),
        (None, Some(at)) => (at, "`tlsKey` is given without `tlsCertificate`".to_owned(), both.to_owned()),
        _ => return false,
    };
    report.push(Diagnostic::new(&codes::TLS_SETTINGS, at, message).help(help));
    true
}

/// True if both addresses name the same transport.
fn is_same_transport(one: &str, other: &str) -> bool {
    let transport = |url: &str| url.split_once("://").map(|(transport, _)| transport.to_owned());
    transport(one) == transport(other)
}

/// True if two programs cannot listen at both addresses: one port of one machine.
fn collide(one: &str, other: &str) -> bool {
    let ((host, port), (other_host, other_port)) = (host_and_port(one), host_and_port(other));
    let (ip, other_ip) = (ip(one), ip(other));
    let is_all = |ip: Option<std::net::IpAddr>| ip.is_some_and(|ip| ip.is_unspecified());
    let is_same = host.eq_ignore_ascii_case(other_host) || ip.is_some() && ip == other_ip;
    port == other_port && (is_same || is_all(ip) || is_all(other_ip))
}
