//! The keys of Zenoh under which nodes with `rmw_zenoh` exchange messages and know of each other, and what stands
//! beside a message.

use std::fmt::Write as _;

use saoms_transport::Topic;
use sha2::{Digest as _, Sha256};

/// The name of the node.
const NODE: &str = "saoms";
/// The settings for delivery that are the usual ones of ROS 2.
const USUAL: &str = "::,:,:,:,,";
/// What nodes say of a type whose hash they do not know, as those of Humble.
const UNKNOWN: &str = "TypeHashNotSupported";
/// Bytes of the number of a publisher.
pub(crate) const GID: usize = 16;

/// What an end of a topic is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum End {
    Publisher,
    Subscriber,
}

impl End {
    fn shown(self) -> &'static str {
        match self {
            End::Publisher => "MP",
            End::Subscriber => "MS",
        }
    }
}

/// The keys of a topic in a domain.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Keys {
    domain: u32,
    name: String,
    /// The type as DDS names it.
    kind: String,
    hash: String,
}

impl Keys {
    pub(crate) fn of(domain: u32, topic: &Topic) -> Keys {
        let mut hash = "RIHS01_".to_owned();
        for byte in Sha256::digest(&topic.description) {
            // Writing to a text does not fail.
            let _ = write!(hash, "{byte:02x}");
        }
        let (package, own) = topic.kind.rsplit_once('/').unwrap_or(("", &topic.kind));
        let kind = format!("{}::dds_::{own}_", package.replace('/', "::"));
        Keys { domain, name: topic.name.clone(), kind, hash }
    }

    /// The key of the messages.
    pub(crate) fn messages(&self) -> String {
        format!("{}/{}/{}/{}", self.domain, self.name, self.kind, self.hash)
    }

    /// The keys of the messages of all definitions of the type.
    pub(crate) fn all_messages(&self) -> String {
        format!("{}/{}/{}/*", self.domain, self.name, self.kind)
    }

    /// Why a message under this key is not of the definition of the type that the fleet has.
    pub(crate) fn fault(&self, key: &str) -> Option<String> {
        let found = key.rsplit('/').next().unwrap_or_default();
        let is_same = found == self.hash || found == UNKNOWN;
        (!is_same).then(|| format!("its sender has another definition of the type: {found}, expected {}", self.hash))
    }

    /// The token by which nodes know of an end of the topic.
    pub(crate) fn token(&self, session: &str, number: u64, end: End) -> String {
        let (Keys { domain, kind, hash, .. }, name) = (self, self.mangled());
        format!("@ros2_lv/{domain}/{session}/0/{number}/{}/%/%/{NODE}/{name}/{kind}/{hash}/{USUAL}", end.shown())
    }

    /// The tokens of all that read the topic.
    pub(crate) fn readers(&self) -> String {
        format!("@ros2_lv/{}/*/*/*/MS/*/*/*/{}/**", self.domain, self.mangled())
    }

    fn mangled(&self) -> String {
        format!("%{}", self.name.replace('/', "%"))
    }
}

/// The token by which nodes know of the program.
pub(crate) fn node(domain: u32, session: &str) -> String {
    format!("@ros2_lv/{domain}/{session}/0/0/NN/%/%/{NODE}")
}

/// What stands beside a message: its number, when it was sent in nanoseconds since 1970, and who sent it.
pub(crate) fn attachment(number: i64, time: i64, gid: [u8; GID]) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(2 * size_of::<i64>() + 1 + GID);
    bytes.extend(number.to_le_bytes());
    bytes.extend(time.to_le_bytes());
    bytes.push(GID as u8);
    bytes.extend(gid);
    bytes
}
