//! What is said in rosbridge: an object of JSON with an `op`.

use serde::Deserialize;
use serde_json::{Value, json};

/// Something that the other end says.
#[derive(Debug, Deserialize)]
pub(crate) struct Op {
    pub(crate) op: String,
    #[serde(default)]
    pub(crate) id: Option<Value>,
    #[serde(default)]
    pub(crate) topic: String,
    /// The type of the messages.
    #[serde(default, rename = "type")]
    pub(crate) kind: String,
    /// A message, or the text of a status.
    #[serde(default)]
    pub(crate) msg: Value,
    #[serde(default)]
    pub(crate) service: String,
    #[serde(default)]
    pub(crate) args: Value,
    #[serde(default)]
    pub(crate) compression: Option<String>,
    /// The weight of a status.
    #[serde(default)]
    pub(crate) level: Option<String>,
}

/// The name of a topic or service without the `/` in front.
pub(crate) fn bare(name: &str) -> &str {
    name.trim_start_matches('/')
}

/// A message of a topic, given as JSON.
pub(crate) fn publish(topic: &str, message: &str) -> String {
    format!(r#"{{"op":"publish","topic":{},"msg":{message}}}"#, Value::from(topic))
}

/// What is wrong, for the other end.
pub(crate) fn status(id: Option<&Value>, text: &str) -> String {
    let mut status = json!({"op": "status", "level": "error", "msg": text});
    if let Some(id) = id {
        status["id"] = id.clone();
    }
    status.to_string()
}
