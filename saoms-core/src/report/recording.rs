use serde::de::IgnoredAny;
use serde::{Deserialize, Deserializer, Serialize};
use serde_json::value::RawValue;

/// What was recorded of a run, as JSON that its maker alone understands.
#[derive(Clone, Debug, Serialize)]
#[serde(transparent)]
pub struct Recording(Box<RawValue>);

impl Recording {
    /// A recording of this JSON.
    ///
    /// # Errors
    /// The text is no JSON.
    pub fn of(json: String) -> Result<Recording, serde_json::Error> {
        RawValue::from_string(json).map(Recording)
    }

    /// Its JSON.
    pub fn json(&self) -> &str {
        self.0.get()
    }
}

impl PartialEq for Recording {
    fn eq(&self, other: &Recording) -> bool {
        self.json() == other.json()
    }
}

/// Reads over a recording.
///
/// # Errors
/// It is no JSON.
pub(super) fn ignored<'a, D: Deserializer<'a>>(deserializer: D) -> Result<Option<Recording>, D::Error> {
    IgnoredAny::deserialize(deserializer).map(|_| None)
}
