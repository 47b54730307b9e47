use serde::{Deserialize, Serialize};

/// A running fleet, as it introduces itself.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct FleetDescription {
    /// Its name: that of its first composite.
    pub name: String,
    /// The process that runs it.
    pub pid: u32,
    /// The files of its composites, as the command line names them.
    pub composites: Vec<String>,
    /// The version of the program.
    pub version: String,
    /// Start of the fleet, in seconds since 1970.
    pub started: u64,
    /// True if it runs in virtual time.
    pub is_virtual: bool,
    /// Its address on the network, as `http://127.0.0.1:8080`.
    #[serde(default)]
    pub url: Option<String>,
    /// The file with the token for that, with which a client may do everything.
    #[serde(default)]
    pub token_file: Option<String>,
    /// The file with the token with which a client may see everything.
    #[serde(default)]
    pub view_token_file: Option<String>,
    /// The history that it writes.
    #[serde(default)]
    pub history: Option<String>,
    /// The seed of all chance.
    pub seed: u64,
}
