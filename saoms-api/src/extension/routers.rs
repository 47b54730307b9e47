use smol_str::SmolStr;

use crate::host::PropertyValue;
use crate::{Failure, Secret};

/// The values of a component, by the names of their properties.
type Values = [(SmolStr, PropertyValue)];

/// A class whose components are routers of networks: where one of them is in a program, the program listens at its
/// address, and others join the network there.
#[derive(Clone, Copy, Debug)]
pub struct RouterClass {
    /// The name of the class.
    pub class: &'static str,
    /// The router that a component with these properties is.
    pub router: fn(&Values) -> Result<Router, Failure>,
}

/// A router of a network, as its component describes it. In brackets are the names of the component's properties, which
/// messages name.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Router {
    /// The address, as the `url` of its clients says it.
    pub url: String,
    /// The user that it accepts (`user`).
    pub user: Option<String>,
    /// The password of this user (`password`).
    pub password: Option<Secret>,
    /// The path of a file with this password (`passwordFile`).
    pub password_file: Option<String>,
    /// The path of a file with further users and their passwords, as lines `user:password` (`users`).
    pub users: Option<String>,
    /// What users may do (`access`); empty: all that are accepted may do everything.
    pub access: Vec<Access>,
    /// The paths of the files for TLS (`tlsCa`, `tlsCertificate`, `tlsKey`).
    pub tls: TlsPaths,
    /// True if it may be reached from other machines without protection (`unprotected`).
    pub is_unprotected: bool,
}

/// Paths of the files for TLS, all in PEM.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct TlsPaths {
    /// The certificates of who vouches for the other side (`tlsCa`).
    pub ca: Option<String>,
    /// The own certificate (`tlsCertificate`).
    pub certificate: Option<String>,
    /// The private key of this certificate (`tlsKey`).
    pub key: Option<String>,
}

/// What a user of a network may do.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Access {
    /// The user.
    pub user: String,
    /// The topics that the user's components may read.
    pub reads: Topics,
    /// The topics that they may publish.
    pub writes: Topics,
    /// The nodes of the fleet that the user's programs run: they may read and publish the topics of the components
    /// there, and call those of other nodes where these are wired to them.
    pub runs: Vec<String>,
    /// True if the user may control the programs of the network.
    pub controls: bool,
}

/// Topics of a network, by their names on the bus.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Topics {
    /// These.
    Some(Vec<String>),
    /// All.
    All,
}

impl Default for Topics {
    fn default() -> Topics {
        Topics::Some(Vec::new())
    }
}

impl Topics {
    /// Adds other topics.
    pub fn extend(&mut self, others: Topics) {
        match others {
            Topics::All => *self = Topics::All,
            Topics::Some(names) => names.iter().for_each(|name| self.add(name)),
        }
    }

    /// Adds a topic.
    pub fn add(&mut self, topic: &str) {
        if let Topics::Some(names) = self
            && !names.iter().any(|name| name == topic)
        {
            names.push(topic.to_owned());
        }
    }

    /// Those that are named.
    pub fn names(&self) -> &[String] {
        match self {
            Topics::All => &[],
            Topics::Some(names) => names,
        }
    }

    /// True if a topic is among them.
    pub fn contain(&self, topic: &str) -> bool {
        match self {
            Topics::All => true,
            Topics::Some(names) => names.iter().any(|name| name == topic),
        }
    }
}

impl Router {
    /// True if it asks those who join for a password.
    pub fn has_users(&self) -> bool {
        self.user.is_some() || self.users.is_some()
    }
}

inventory::collect!(RouterClass);

impl RouterClass {
    /// The classes that are linked into this program, in no particular order.
    pub fn linked() -> impl Iterator<Item = &'static RouterClass> {
        inventory::iter::<RouterClass>()
    }

    /// The router that a component of a class is; `None` if the class is none of routers, or refuses the values.
    pub fn read(class: &str, values: &Values) -> Option<Router> {
        let router = RouterClass::linked().find(|router| router.class == class)?;
        (router.router)(values).ok()
    }
}
