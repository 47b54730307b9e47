//! The place of the larger collection of composites. The other test programs of the workspace include this file.

use std::path::{Path, PathBuf};

/// The folder of the collection: `shared/corpus` beside the workspace, or beside one of the folders around it.
pub(crate) fn collection() -> Option<PathBuf> {
    let package = Path::new(env!("CARGO_MANIFEST_DIR"));
    package.ancestors().map(|folder| folder.join("shared/corpus")).find(|folder| folder.is_dir())
}
