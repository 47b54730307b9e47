use saoms_lang::assembly::{Assembly, ComponentSpec};
use serde::{Deserialize, Serialize};

use super::Outcome;
use crate::hash::text_hash;

/// The part of a fleet that a report is about: one of its nodes, or several whose reports were joined.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct PartOfFleet {
    /// The node; empty in a report that joins those of several.
    pub node: String,
    /// All nodes of the fleet, by name.
    pub nodes: Vec<String>,
    /// A digest of the whole fleet, 16 hexadecimal digits: the paths, classes, sites and nodes of all components.
    pub fleet: String,
    /// When the run began, by the clock of the machine, in microseconds since 1970.
    pub began_us: u64,
}

impl PartOfFleet {
    /// The part that an assembly is, before its run; `None` for a whole fleet.
    pub fn of(assembly: &Assembly) -> Option<PartOfFleet> {
        if assembly.node.is_empty() {
            return None;
        }
        let of_one = |spec: &ComponentSpec| format!("{} {} {} {}", spec.path, spec.class.name(), spec.site, spec.node);
        let mut all: Vec<String> = assembly.all().map(of_one).collect();
        all.sort_unstable();
        let fleet = format!("{:016x}", text_hash(&all.join("\n")));
        let nodes = assembly.nodes().into_keys().map(|node| node.to_string()).collect();
        Some(PartOfFleet { node: assembly.node.to_string(), nodes, fleet, began_us: 0 })
    }
}

/// A node of a fleet whose reports were joined.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct NodeReport {
    /// The node.
    pub node: String,
    /// The seed of all chance in its program.
    pub seed: u64,
    /// When its program began, in seconds since the first one did.
    pub began_s: f64,
    /// How long its run lasted, in seconds.
    pub time_s: f64,
    /// Its outcome.
    pub outcome: Outcome,
}
