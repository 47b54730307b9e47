//! The messages of VDA 5050 2.0, as far as they matter here. What a vehicle says beyond that is passed over.

use saoms_api::host::calendar_date;
use serde::{Deserialize, Serialize};
use std::time::{SystemTime, UNIX_EPOCH};

/// What each message begins with.
#[derive(Debug, Serialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct Head<'a> {
    pub(crate) header_id: u32,
    pub(crate) timestamp: String,
    pub(crate) version: &'static str,
    pub(crate) manufacturer: &'a str,
    pub(crate) serial_number: &'a str,
}

/// An order: nodes, and the edges between them.
#[derive(Debug, Serialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct Order<'a> {
    #[serde(flatten)]
    pub(crate) head: Head<'a>,
    pub(crate) order_id: &'a str,
    pub(crate) order_update_id: u32,
    pub(crate) nodes: Vec<Node>,
    pub(crate) edges: Vec<Edge>,
}

/// A place of an order.
#[derive(Debug, Serialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct Node {
    pub(crate) node_id: String,
    pub(crate) sequence_id: u32,
    pub(crate) released: bool,
    pub(crate) node_position: Position,
    pub(crate) actions: Vec<ActionOrder>,
}

/// A way of an order.
#[derive(Debug, Serialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct Edge {
    pub(crate) edge_id: String,
    pub(crate) sequence_id: u32,
    pub(crate) released: bool,
    pub(crate) start_node_id: String,
    pub(crate) end_node_id: String,
    pub(crate) actions: Vec<ActionOrder>,
}

/// A position on a map, in metres.
#[derive(Debug, Serialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct Position {
    pub(crate) x: f64,
    pub(crate) y: f64,
    pub(crate) map_id: String,
}

/// An action of an order, or one at once.
#[derive(Debug, Serialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct ActionOrder {
    pub(crate) action_type: &'static str,
    pub(crate) action_id: String,
    pub(crate) blocking_type: &'static str,
    pub(crate) action_parameters: Vec<Parameter>,
}

/// A parameter of an action.
#[derive(Debug, Serialize)]
pub(crate) struct Parameter {
    pub(crate) key: &'static str,
    pub(crate) value: String,
}

/// Actions that are to be carried out at once.
#[derive(Debug, Serialize)]
pub(crate) struct InstantActions<'a> {
    #[serde(flatten)]
    pub(crate) head: Head<'a>,
    pub(crate) actions: Vec<ActionOrder>,
}

/// What a vehicle says of itself.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub(crate) struct State {
    pub(crate) order_id: String,
    pub(crate) last_node_id: String,
    pub(crate) driving: bool,
    pub(crate) operating_mode: String,
    node_states: Vec<serde::de::IgnoredAny>,
    edge_states: Vec<serde::de::IgnoredAny>,
    pub(crate) action_states: Vec<ActionState>,
    pub(crate) battery_state: Option<Battery>,
    pub(crate) agv_position: Option<Seen>,
    pub(crate) errors: Vec<VehicleError>,
}

/// How an action goes.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub(crate) struct ActionState {
    pub(crate) action_id: String,
    pub(crate) action_status: String,
    pub(crate) result_description: String,
}

/// The battery of a vehicle.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub(crate) struct Battery {
    /// In percent.
    pub(crate) battery_charge: f64,
}

/// Where a vehicle believes to be, in metres.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub(crate) struct Seen {
    pub(crate) x: f64,
    pub(crate) y: f64,
    pub(crate) position_initialized: bool,
}

/// An error that a vehicle has.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub(crate) struct VehicleError {
    pub(crate) error_type: String,
    pub(crate) error_level: String,
    pub(crate) error_description: String,
    pub(crate) error_references: Vec<ErrorReference>,
}

/// What an error is about.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub(crate) struct ErrorReference {
    pub(crate) reference_key: String,
    pub(crate) reference_value: String,
}

impl State {
    /// True if nothing of the order is left to drive.
    pub(crate) fn has_arrived(&self) -> bool {
        self.node_states.is_empty() && self.edge_states.is_empty() && !self.driving
    }

    /// The state of an action.
    pub(crate) fn action(&self, id: &str) -> Option<&ActionState> {
        self.action_states.iter().find(|one| one.action_id == id)
    }
}

impl VehicleError {
    /// True if it is about what this key names.
    pub(crate) fn is_about(&self, key: &str, value: &str) -> bool {
        self.error_references.iter().any(|one| one.reference_key == key && one.reference_value == value)
    }
}

/// The time of now as ISO 8601 has it, in UTC.
pub(crate) fn now() -> String {
    let now = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    let (seconds, milliseconds) = (now.as_secs(), now.subsec_millis());
    let (year, month, day) = calendar_date(seconds / 86_400);
    let of_day = seconds % 86_400;
    let (hour, minute, second) = (of_day / 3_600, of_day / 60 % 60, of_day % 60);
    format!("{year:04}-{month:02}-{day:02}T{hour:02}:{minute:02}:{second:02}.{milliseconds:03}Z")
}
