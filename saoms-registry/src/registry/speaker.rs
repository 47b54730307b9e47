//! Fields of messages that say who speaks.

use std::collections::BTreeMap;
use std::fmt;

use serde::Deserialize;
use serde_json::Value;

/// A field of a message that names its speaker: the component whose properties have this number.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
pub struct SpeakerField {
    /// The name of the field, which is an integer.
    pub field: String,
    /// It names the speaker only in messages whose fields have these constants.
    #[serde(default)]
    pub only: BTreeMap<String, String>,
    /// It names the speaker unless one of these fields has this constant.
    #[serde(default)]
    pub unless: BTreeMap<String, String>,
    /// What an operator does instead of speaking in the name of that component, as the end of a sentence.
    #[serde(default)]
    pub instead: String,
}

impl SpeakerField {
    /// The number of the speaker of a message, which is given with its fields; `None` if this field names none.
    pub fn speaker(&self, message: &Value) -> Option<i128> {
        let is = |(field, constant): (&String, &String)| message[field] == **constant;
        if !self.only.iter().all(is) || self.unless.iter().any(is) {
            return None;
        }
        let number = &message[&self.field];
        number.as_i64().map(i128::from).or_else(|| number.as_u64().map(i128::from))
    }

    /// The first contradiction with the schema of the message.
    pub(super) fn check(&self, schema: &Value) -> Result<(), String> {
        let message = schema["name"].as_str().unwrap_or_default();
        let find = |name: &str| {
            let mut fields = schema["fields"].as_array().into_iter().flatten();
            let found = fields.find(|field| field["name"] == name).map(|field| &field["type"]);
            found.ok_or_else(|| format!("`speakers` names `{name}`, which is not a field of `{message}`"))
        };
        if !find(&self.field)?.as_str().is_some_and(|of| of.starts_with("int") || of.starts_with("uint")) {
            return Err(format!("`speakers` names `{}` of `{message}`, which is not an integer", self.field));
        }
        for (field, constant) in self.only.iter().chain(&self.unless) {
            if find(field)?["values"].get(constant).is_none() {
                return Err(format!(
                    "`speakers` names `{constant}`, which is not a constant of `{field}` of `{message}`"
                ));
            }
        }
        Ok(())
    }
}

impl fmt::Display for SpeakerField {
    /// The field, and when it names the speaker: `` `healer`, unless `stage` is `REQUEST` ``.
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "`{}`", self.field)?;
        self.only.iter().try_for_each(|(field, constant)| write!(out, ", where `{field}` is `{constant}`"))?;
        self.unless.iter().try_for_each(|(field, constant)| write!(out, ", unless `{field}` is `{constant}`"))
    }
}
