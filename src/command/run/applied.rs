//! What was applied to a fleet with a state folder, for the program that goes on: it starts from its own files.

use std::path::{Path, PathBuf};
use std::sync::{Arc, PoisonError};
use std::time::SystemTime;

use saoms_api::Level;
use saoms_api::host::one_line;
use saoms_control::date;
use saoms_core::assemble::fingerprint;
use saoms_core::schedule::{Handle, SharedText};
use saoms_lang::assembly::Assembly;
use serde::{Deserialize, Serialize};

/// The name under which the state folder has it.
const NAME: &str = "applied fleet";

/// The last change that was applied, in the state folder.
pub(super) struct LastApplied(SharedText);

/// A fleet that was applied.
#[derive(Serialize, Deserialize)]
struct AppliedFleet {
    /// The files, by absolute paths.
    files: Vec<PathBuf>,
    /// The date on which it was asked for.
    date: String,
    by: Option<String>,
    fingerprint: u64,
}

impl LastApplied {
    /// Has it outlive the program. Warns if an earlier one was changed to another fleet than the one that starts, whose
    /// fingerprint and files these are.
    pub(super) fn outlive(handle: &Handle, fingerprint: u64, files: &[PathBuf]) -> LastApplied {
        let kept = SharedText::default();
        if let Some(left) = handle.share_text(NAME, &kept) {
            let applied = serde_json::from_str::<AppliedFleet>(&left).ok();
            let other = applied.filter(|applied| applied.fingerprint != fingerprint);
            other.iter().for_each(|applied| handle.note(Level::Warning, applied.warning(files)));
            *kept.lock().unwrap_or_else(PoisonError::into_inner) = left;
        }
        LastApplied(kept)
    }

    /// What the state folder has from the moment on at which a change to this fleet takes effect.
    pub(super) fn of(&self, wanted: &Assembly, files: &[PathBuf], by: Option<String>) -> Option<(SharedText, String)> {
        let absolute = |path: &PathBuf| std::path::absolute(path).unwrap_or_else(|_| path.clone());
        let applied = AppliedFleet {
            files: files.iter().map(absolute).collect(),
            date: date(SystemTime::now()),
            by,
            fingerprint: fingerprint(wanted),
        };
        // A path that is no text has no JSON.
        Some((Arc::clone(&self.0), serde_json::to_string(&applied).ok()?))
    }
}

impl AppliedFleet {
    /// What is to know where another fleet starts, that of these files.
    fn warning(&self, files: &[PathBuf]) -> String {
        let by = self.by.as_ref().map(|by| format!(" by {by}")).unwrap_or_default();
        let [applied, started] = [self.files.as_slice(), files].map(command_line);
        let text = format!(
            "the fleet was changed by `saoms apply{applied}`{by} on {}, and this run is of another one, that of \
             `saoms run{started}`: `saoms apply{applied}` makes it the former, `saoms apply{started}` keeps the latter \
             and ends this warning",
            self.date
        );
        one_line(&text).into_owned()
    }
}

/// Files as arguments of a command.
fn command_line(files: &[impl AsRef<Path>]) -> String {
    files.iter().map(|file| format!(" {}", file.as_ref().display())).collect()
}
