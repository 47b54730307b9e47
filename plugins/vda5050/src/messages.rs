//! The messages of VDA 5050 2.0, as far as they matter here. What a vehicle says beyond that is passed over.

use saoms_api::host::calendar_date;
use serde::{Deserialize, Deserializer, Serialize};
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

/// What a vehicle says of itself. Some write `null` for what they have nothing to say of.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub(crate) struct State {
    #[serde(deserialize_with = "or_default")]
    pub(crate) order_id: String,
    #[serde(deserialize_with = "or_default")]
    pub(crate) last_node_id: String,
    #[serde(deserialize_with = "or_default")]
    pub(crate) driving: bool,
    #[serde(deserialize_with = "or_default")]
    pub(crate) operating_mode: String,
    #[serde(deserialize_with = "or_default")]
    node_states: Vec<serde::de::IgnoredAny>,
    #[serde(deserialize_with = "or_default")]
    edge_states: Vec<serde::de::IgnoredAny>,
    #[serde(deserialize_with = "or_default")]
    pub(crate) action_states: Vec<ActionState>,
    pub(crate) battery_state: Option<Battery>,
    pub(crate) agv_position: Option<Seen>,
    #[serde(deserialize_with = "or_default")]
    pub(crate) errors: Vec<VehicleError>,
}

/// How an action goes.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub(crate) struct ActionState {
    #[serde(deserialize_with = "or_default")]
    pub(crate) action_id: String,
    #[serde(deserialize_with = "or_default")]
    pub(crate) action_status: String,
    #[serde(deserialize_with = "or_default")]
    pub(crate) result_description: String,
}

/// The battery of a vehicle.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub(crate) struct Battery {
    /// In percent.
    pub(crate) battery_charge: Option<f64>,
}

/// Where a vehicle believes to be, in metres.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub(crate) struct Seen {
    x: Option<f64>,
    y: Option<f64>,
    #[serde(deserialize_with = "or_default")]
    position_initialized: bool,
}

/// An error that a vehicle has.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub(crate) struct VehicleError {
    #[serde(deserialize_with = "or_default")]
    pub(crate) error_type: String,
    #[serde(deserialize_with = "or_default")]
    pub(crate) error_level: String,
    #[serde(deserialize_with = "or_default")]
    pub(crate) error_description: String,
    #[serde(deserialize_with = "or_default")]
    pub(crate) error_references: Vec<ErrorReference>,
}

/// What an error is about.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub(crate) struct ErrorReference {
    #[serde(deserialize_with = "or_default")]
    pub(crate) reference_key: String,
    #[serde(deserialize_with = "or_default")]
    pub(crate) reference_value: String,
}

/// A value, or its default for `null`.
fn or_default<'de, D: Deserializer<'de>, T: Default + Deserialize<'de>>(from: D) -> Result<T, D::Error> {
    Option::deserialize(from).map(Option::unwrap_or_default)
}

impl State {
    /// True if nothing of the order is left to drive.
    pub(crate) fn has_arrived(&self) -> bool {
        self.node_states.is_empty() && self.edge_states.is_empty() && !self.driving
    }

    /// Where the vehicle is, in metres, if it knows.
    pub(crate) fn position(&self) -> Option<(f64, f64)> {
        let seen = self.agv_position.as_ref().filter(|seen| seen.position_initialized)?;
        Some((seen.x?, seen.y?))
    }

    /// The state of an action.
    pub(crate) fn action(&self, id: &str) -> Option<&ActionState> {
        self.action_states.iter().find(|one| one.action_id == id)
    }
}

impl ActionState {
    /// True if it is over, well or not.
    pub(crate) fn is_over(&self) -> bool {
        ["FINISHED", "FAILED"].contains(&&*self.action_status)
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_null_in_a_state_is_what_is_not_said() {
        let read = |text: &str| serde_json::from_str::<State>(text);
        let state = read(
            r#"{"orderId":"o1","lastNodeId":null,"nodeStates":null,"edgeStates":null,"driving":true,
                "operatingMode":null,
                "actionStates":[{"actionId":"a","actionStatus":"FINISHED","resultDescription":null}],
                "errors":[{"errorType":"e","errorLevel":null,"errorDescription":null,"errorReferences":null}],
                "batteryState":{"batteryCharge":null},"agvPosition":{"x":1.0,"y":null,"positionInitialized":true}}"#,
        );
        let state = state.unwrap();
        assert_eq!((&*state.order_id, &*state.last_node_id, state.driving), ("o1", "", true));
        assert_eq!(state.action("a").map(|action| &*action.action_status), Some("FINISHED"));
        // A charge or a place of 0 would be something else.
        assert_eq!((state.battery_state.and_then(|battery| battery.battery_charge), state.errors.len()), (None, 1));
        assert_eq!(read(r#"{"agvPosition":{"x":1.0,"y":null,"positionInitialized":true}}"#).unwrap().position(), None);
        assert_eq!(
            read(r#"{"agvPosition":{"x":1,"y":2.5,"positionInitialized":true}}"#).unwrap().position(),
            Some((1.0, 2.5))
        );
        let refused = read("{\n\"driving\": \"yes\"}").unwrap_err().to_string();
        assert!(refused.contains("expected a boolean at line 2"), "{refused}");
    }
}
