use std::path::Path;
use std::sync::{Mutex, PoisonError};

use saoms_abi::VERSION;
use saoms_api::rule::{Code, Severity};
use serde::Deserialize;
use serde::de::{Deserializer, Error as _};
use serde_json::value::RawValue;

use super::{PluginError, declared_names};

/// Metadata of a library.
#[derive(Debug, Deserialize)]
pub struct Metadata {
    /// The version of `saoms-api` that it was built with; empty for one in another language.
    #[serde(default)]
    pub api: String,
    /// Its name.
    #[serde(default)]
    pub package: String,
    /// Its version.
    #[serde(default)]
    pub version: String,
    /// Panic strategy: `unwind` or `abort`.
    #[serde(default)]
    pub(super) panic: String,
    /// The name of the function that gives its tables.
    pub(super) entry: String,
    /// The declarations of its classes.
    #[serde(default)]
    pub(super) classes: Vec<Box<RawValue>>,
    /// The declarations of its loops.
    #[serde(default)]
    pub(super) loops: Vec<Box<RawValue>>,
    /// Its rules over whole fleets.
    #[serde(default)]
    pub(super) rules: Vec<RuleMetadata>,
    /// The languages whose classes it runs.
    #[serde(default)]
    pub implementations: Vec<String>,
}

impl Metadata {
    /// The names of its classes, in the order of its tables.
    pub(super) fn class_names(&self) -> Vec<String> {
        names(&self.classes)
    }

    /// Of each of its classes, in the order of its tables, the functions that its declaration asks for, with what asks.
    pub(super) fn asked_functions(&self) -> Vec<Vec<(&'static str, &'static str)>> {
        #[derive(Default, Deserialize)]
        #[serde(default)]
        struct Asking {
            reacts: bool,
            saves: bool,
            properties: Vec<Property>,
        }
        #[derive(Deserialize)]
        struct Property {
            #[serde(default)]
            live: bool,
        }
        let asked = |one: &RawValue| {
            // The registry has judged them all before code is loaded.
            let Asking { reacts, saves, properties } = serde_json::from_str(one.get()).unwrap_or_default();
            let is_live = properties.iter().any(|property| property.live);
            let all = [
                (reacts, "react", "\"reacts\": true"),
                (saves, "save", "\"saves\": true"),
                (saves, "restore", "\"saves\": true"),
                (is_live, "update", "\"live\": true"),
            ];
            all.into_iter().filter(|(asks, ..)| *asks).map(|(_, function, why)| (function, why)).collect()
        };
        self.classes.iter().map(|one| asked(one)).collect()
    }

    /// The names of its loops, in the order of its tables.
    pub(super) fn loop_names(&self) -> Vec<String> {
        names(&self.loops)
    }
}

fn names(declarations: &[Box<RawValue>]) -> Vec<String> {
    #[derive(Deserialize)]
    struct Named {
        #[serde(alias = "class", alias = "loop", default)]
        name: String,
    }
    // The registry has judged them all before code is loaded.
    let name = |one: &RawValue| serde_json::from_str(one.get()).map(|Named { name }| name);
    declarations.iter().map(|one| name(one).unwrap_or_default()).collect()
}

/// Metadata of a rule.
#[derive(Clone, Copy, Debug)]
pub(super) struct RuleMetadata {
    pub(super) code: &'static Code,
    pub(super) judges_parts: bool,
    pub(super) prevents_start: bool,
}

impl<'de> Deserialize<'de> for RuleMetadata {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<RuleMetadata, D::Error> {
        #[derive(Deserialize)]
        #[serde(rename_all = "camelCase")]
        struct Written {
            code: String,
            name: String,
            meaning: String,
            severity: String,
            rule: Option<String>,
            judges_parts: bool,
            #[serde(default)]
            prevents_start: bool,
        }
        let Written { code: id, name, meaning, severity, rule, judges_parts, prevents_start } =
            Written::deserialize(from)?;
        let severities = [Severity::Note, Severity::Warning, Severity::Error];
        let severity = severities.into_iter().find(|known| known.name() == severity).ok_or_else(|| {
            D::Error::custom(format!("found the severity `{severity}`, expected `note`, `warning` or `error`"))
        })?;
        let code = kept(&id, &name, &meaning, severity, rule.as_deref());
        Ok(RuleMetadata { code, judges_parts, prevents_start })
    }
}

/// The code as a leaked constant, as diagnostics need it. Equal codes are leaked once, so a plugin that is read again
/// costs nothing.
fn kept(id: &str, name: &str, meaning: &str, severity: Severity, rule: Option<&str>) -> &'static Code {
    static KNOWN: Mutex<Vec<&'static Code>> = Mutex::new(Vec::new());
    let mut known = KNOWN.lock().unwrap_or_else(PoisonError::into_inner);
    let same = |code: &&Code| {
        (code.id, code.name, code.meaning) == (id, name, meaning) && (code.severity, code.rule) == (severity, rule)
    };
    if let Some(same) = known.iter().find(|code| same(code)) {
        return same;
    }
    let text = |text: &str| &*text.to_owned().leak();
    let (id, name, meaning, rule) = (text(id), text(name), text(meaning), rule.map(text));
    let new: &'static Code = Box::leak(Box::new(Code { id, name, meaning, severity, rule }));
    known.push(new);
    new
}

/// The part of the metadata that every version has.
#[derive(Deserialize)]
struct Head {
    saoms: String,
    abi: u32,
    #[serde(default)]
    api: String,
}

/// Reads metadata.
pub(super) fn read(path: &Path, text: &str) -> Result<Metadata, PluginError> {
    let malformed = |message: String| PluginError::Metadata { path: path.to_owned(), message };
    // The version first: metadata of another version may have another shape.
    let head: Head = serde_json::from_str(text).map_err(|error| malformed(error.to_string()))?;
    if head.saoms != "plugin" {
        return Err(malformed(format!("found `{}` for `saoms`, expected `plugin`", head.saoms)));
    }
    if head.abi != VERSION {
        return Err(PluginError::Version { path: path.to_owned(), found: head.abi, api: head.api });
    }
    let metadata: Metadata = serde_json::from_str(text).map_err(|error| malformed(error.to_string()))?;
    declared_names::check(text).map_err(malformed)?;
    if metadata.panic == "abort" {
        return Err(PluginError::Aborts { path: path.to_owned(), package: metadata.package });
    }
    Ok(metadata)
}
