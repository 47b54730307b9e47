//! Composites with comments that expect diagnostics.

mod comments;
#[cfg(test)]
mod tests;
mod write;

use std::fmt::Write as _;
use std::path::Path;
use std::{env, fs};

use comments::{Expectation, comments, plain};
use write::{Placement, rewritten};

use crate::Fleet;

/// Compares the diagnostics of the composite in a file, or of each in a folder, with those that its comments expect.
///
/// A comment that begins with `~` expects a diagnostic: a code, and as much of its message as matters. It is about the
/// line that it stands in; `~^` is the line above, `~v` the one below, `~^3` the third above. Every diagnostic has to
/// be expected, and every expectation met. With `UPDATE_EXPECT=1` in the environment the comments are written anew.
///
/// ```xml
/// <property name="batery">50</property> <!--~ S3004 no property `batery` -->
/// <property name="asleep">maybe</property>
/// <!--~^ error S3007 -->
/// ```
/// A composite without such comments has to have no diagnostics. See `docs/testing.md` of the project.
///
/// # Panics
/// With a line for each difference, when the diagnostics are others; when a folder has no composites.
#[track_caller]
#[expect(clippy::panic, reason = "a test whose expectation is not met has failed")]
pub fn expect_diagnostics(path: impl AsRef<Path>) {
    let path = path.as_ref();
    if !path.is_dir() {
        return Fleet::of_file(path).expect_diagnostics();
    }
    let files = composites(path);
    if files.is_empty() {
        panic!("there are no files `*.composite` in `{}`", path.display());
    }
    let differences: String = files.iter().filter_map(|file| Fleet::of_file(file).differences().err()).collect();
    if !differences.is_empty() {
        panic!("{differences}{HINT}");
    }
}

const HINT: &str = "- is expected and not found, + is found and not expected; UPDATE_EXPECT=1 writes what is found";

/// The composites in a folder and below, sorted.
fn composites(folder: &Path) -> Vec<std::path::PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = entry.path();
        match path.extension() {
            _ if path.is_dir() => found.extend(composites(&path)),
            Some(extension) if extension == "composite" => found.push(path),
            _ => {}
        }
    }
    found.sort_unstable();
    found
}

/// A text that was checked, and the diagnostics in it.
#[derive(Debug)]
pub(crate) struct Checked {
    pub(crate) path: String,
    pub(crate) text: String,
    pub(crate) found: Vec<Found>,
}

/// A diagnostic.
#[derive(Clone, Debug)]
pub(crate) struct Found {
    pub(crate) line: u32,
    pub(crate) severity: &'static str,
    pub(crate) code: &'static str,
    pub(crate) message: String,
}

impl Found {
    fn meets(&self, expectation: &Expectation) -> bool {
        self.line == expectation.line
            && self.code == expectation.code
            && expectation.severity.as_ref().is_none_or(|severity| severity == self.severity)
            && plain(&self.message).contains(&plain(&expectation.text))
    }
}

impl Checked {
    /// Diagnostics that were not expected, and expectations without a diagnostic: a line each, in the order of the
    /// text.
    fn differences(&self) -> String {
        let mut open: Vec<&Found> = self.found.iter().collect();
        let mut expected: Vec<Expectation> =
            comments(&self.text).into_iter().map(|comment| comment.expectation).collect();
        // The most specific expectation chooses first.
        expected.sort_by_key(|one| std::cmp::Reverse(one.text.len()));
        let mut lines = Vec::new();
        for one in expected {
            match open.iter().position(|found| found.meets(&one)) {
                Some(place) => _ = open.remove(place),
                None => {
                    let severity = one.severity.map_or_else(String::new, |severity| severity + " ");
                    let text = format!("{severity}{} {}", one.code, one.text);
                    lines.push((one.line, format!("- {}", text.trim_end())));
                }
            }
        }
        for one in open {
            lines.push((one.line, format!("+ {} {} {}", one.severity, one.code, plain(&one.message))));
        }
        lines.sort();
        let mut out = String::new();
        for (line, text) in &lines {
            let _ = writeln!(out, "{}:{line}: {text}", self.path);
        }
        out
    }
}

impl Fleet {
    /// Compares the diagnostics of the fleet with those that comments in its composites expect, including the
    /// composites that it names; see [`expect_diagnostics`].
    ///
    /// # Panics
    /// As there.
    #[track_caller]
    #[expect(clippy::panic, reason = "a test whose expectation is not met has failed")]
    pub fn expect_diagnostics(&self) {
        if let Err(differences) = self.differences() {
            panic!("{differences}{HINT}");
        }
    }

    /// Differences for [`expect_diagnostics`](Fleet::expect_diagnostics), which rewrites the comments if
    /// `UPDATE_EXPECT` is set.
    fn differences(&self) -> Result<(), String> {
        let texts = self.texts();
        let differences: String = texts.iter().map(Checked::differences).collect();
        if differences.is_empty() {
            return Ok(());
        }
        if env::var_os("UPDATE_EXPECT").is_none() || !self.update(&texts) {
            return Err(differences);
        }
        Ok(())
    }

    /// Rewrites the comments; `true` if the files expect exactly the found diagnostics then.
    fn update(&self, texts: &[Checked]) -> bool {
        let files: Vec<&Checked> =
            texts.iter().filter(|one| !one.differences().is_empty() && Path::new(&one.path).is_file()).collect();
        for placement in Placement::ALL {
            let written =
                files.iter().all(|file| fs::write(&file.path, rewritten(&file.text, &file.found, placement)).is_ok());
            if written && self.texts().iter().all(|one| one.differences().is_empty()) {
                return true;
            }
        }
        // Files whose diagnostics cannot be expressed in comments stay as they were.
        for file in files {
            let _ = fs::write(&file.path, &file.text);
        }
        false
    }
}
