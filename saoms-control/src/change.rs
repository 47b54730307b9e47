//! The files of a fleet that is wanted in place of the one that runs, and what they change.

use std::path::{Path, PathBuf};
use std::time::Duration;

use saoms_core::schedule::PlannedChanges;
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// The fleet that a client wants, as its command line gives it. The program of the fleet reads these files.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ChangeRequest {
    /// The folder of the client, an absolute path: relative paths begin there, and diagnostics show files from there.
    pub folder: PathBuf,
    /// The composites, as for `saoms run`.
    pub files: Vec<PathBuf>,
    /// Values of composite properties, as `NAME=VALUE`.
    #[serde(default)]
    pub set: Vec<String>,
    /// Severities of diagnostics, as `CODE=LEVEL`.
    #[serde(default)]
    pub severities: Vec<String>,
    /// Plugins beside those of the run.
    #[serde(default)]
    pub plugins: Vec<PathBuf>,
    /// True if files outside of the folders of the composites may be read.
    #[serde(default)]
    pub allow_outside: bool,
    /// The size in bytes of the largest file that is read; without it, that of the run.
    #[serde(default)]
    pub max_size: Option<u64>,
    /// True if texts for people may have colours.
    #[serde(default)]
    pub coloured: bool,
    /// True if components may lose their state.
    #[serde(default)]
    pub allow_loss: bool,
    /// The time for which components that leave may finish what they have begun before they end, in milliseconds; 60 s
    /// without it.
    #[serde(default)]
    pub wait_ms: Option<u64>,
    /// Who wants the change, for the journal.
    #[serde(default)]
    pub by: Option<String>,
}

impl ChangeRequest {
    /// A path of the client as the program of the fleet means it: paths stay as they are where both mean the same.
    pub fn path(&self, path: &Path) -> PathBuf {
        let is_same = std::env::current_dir().is_ok_and(|folder| folder == self.folder);
        if is_same { path.to_owned() } else { self.folder.join(path) }
    }

    /// The time for which components that leave may finish what they have begun.
    pub fn wait(&self) -> Option<Duration> {
        self.wait_ms.map(Duration::from_millis)
    }
}

/// What became of a request.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct ChangeAnswer {
    /// What was found in the files, as `saoms check --format json` tells it.
    pub diagnostics: Vec<Value>,
    /// The same as people read it.
    pub text: String,
    /// What else is to be known.
    pub notes: Vec<String>,
    /// What would change, or has changed; `null` where the files describe no fleet.
    pub plan: Option<PlannedChanges>,
    /// Why it was not applied; the fleet is as it was then.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub failure: Option<ChangeFailure>,
    /// True if the fleet is that of the files now; not there in the answer of a plan.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub applied: Option<bool>,
    /// Why a crash of the program would undo the change, which was made.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub uncommitted: Option<String>,
}

/// Why a change was not applied.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct ChangeFailure {
    /// The reason.
    pub error: String,
    /// True if the request itself asks for what cannot be; otherwise the fleet has tried it, and is as it was.
    pub refused: bool,
    /// True if it was not tried, since another change was being made.
    pub busy: bool,
}

impl ChangeAnswer {
    /// True if the fleet is that of the files now.
    pub fn is_applied(&self) -> bool {
        self.applied == Some(true)
    }
}
