//! What a component is called in reports and snapshots, made once and shared by all of them.

use saoms_lang::assembly::ComponentSpec;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use smol_str::SmolStr;

/// The names of a component, ready for each of its reports.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Label {
    /// Its path.
    pub(crate) name: SmolStr,
    /// Its `ID`.
    pub(crate) id: Option<SmolStr>,
    pub(crate) class: SmolStr,
}

impl Label {
    pub(crate) fn of(spec: &ComponentSpec) -> Label {
        let id = spec.task.as_ref().map(|task| SmolStr::from(&task.id));
        Label { name: SmolStr::from(&spec.path), id, class: SmolStr::from(spec.class.name()) }
    }
}

pub(super) fn serialize<S: Serializer>(text: &SmolStr, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(text)
}

pub(super) fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<SmolStr, D::Error> {
    String::deserialize(deserializer).map(SmolStr::from)
}

/// The same for a name that may be absent.
pub(super) mod optional {
    use super::{Deserialize, Deserializer, Serialize, Serializer, SmolStr};

    pub(in super::super) fn serialize<S: Serializer>(text: &Option<SmolStr>, serializer: S) -> Result<S::Ok, S::Error> {
        text.as_deref().serialize(serializer)
    }

    pub(in super::super) fn deserialize<'de, D: Deserializer<'de>>(
        deserializer: D,
    ) -> Result<Option<SmolStr>, D::Error> {
        Ok(Option::<String>::deserialize(deserializer)?.map(SmolStr::from))
    }
}
