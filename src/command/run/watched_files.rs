//! Files that are looked at again and again, until they change.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::os::unix::fs::MetadataExt;
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

/// The time between two looks. A file has changed when two looks in a row find it alike, and other than before.
pub(super) const LOOK: Duration = Duration::from_millis(300);

/// The time by which the clock of files may be behind.
const COARSE: Duration = Duration::from_millis(10);

/// The identity of a file's content: inode, size, and time of its last change.
type Stamp = (u64, u64, i64, i64);

/// Files and what was seen of them.
#[derive(Default)]
pub(super) struct WatchedFiles(BTreeMap<PathBuf, FileStamps>);

struct FileStamps {
    taken: Option<Stamp>,
    /// The file at the last look.
    seen: Option<Stamp>,
}

impl WatchedFiles {
    /// Also watches these files, which somebody began to read at this time: what was written since counts as changed.
    pub(super) fn add(&mut self, files: impl IntoIterator<Item = PathBuf>, since: SystemTime) {
        let since = since.checked_sub(COARSE).unwrap_or(since);
        let is_newer = |path: &Path| fs::metadata(path).and_then(|found| found.modified()).is_ok_and(|at| at > since);
        for file in files {
            self.0.entry(file).or_insert_with_key(|path| {
                let seen = stamp(path);
                FileStamps { taken: seen.filter(|_| !is_newer(path)), seen }
            });
        }
    }

    /// Watches these files and no others; what is known of those that are watched already stays.
    pub(super) fn set(&mut self, files: Vec<PathBuf>, since: SystemTime) {
        let files: BTreeSet<PathBuf> = files.into_iter().collect();
        self.0.retain(|path, _| files.contains(path));
        self.add(files, since);
    }

    /// The files that have changed since they were told the last time, and are complete.
    pub(super) fn look(&mut self) -> Vec<PathBuf> {
        self.0.iter_mut().filter_map(|(path, known)| known.look(path)).collect()
    }
}

impl FileStamps {
    /// The path, if its file differs from the one that was told and is complete.
    fn look(&mut self, path: &Path) -> Option<PathBuf> {
        let now = stamp(path);
        let settled = std::mem::replace(&mut self.seen, now) == now;
        (settled && now.is_some() && now != self.taken).then(|| {
            self.taken = now;
            path.to_owned()
        })
    }
}

fn stamp(path: &Path) -> Option<Stamp> {
    let found = fs::metadata(path).ok()?;
    Some((found.ino(), found.size(), found.mtime(), found.mtime_nsec()))
}
