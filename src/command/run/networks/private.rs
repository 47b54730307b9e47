//! Files with secrets.

use std::fs::{File, OpenOptions};
use std::io::{self, Read as _};
use std::os::unix::fs::{MetadataExt as _, OpenOptionsExt as _};
use std::path::Path;

/// The size of a file with passwords, at most.
const LARGEST: u64 = 1 << 20;

/// A file that nobody but the user can read, or why it is none.
pub(super) fn opened(path: &Path) -> Result<File, String> {
    let shown = path.display();
    let fault = |error: io::Error| format!("`{shown}` cannot be read: {error}");
    // A pipe without a writer must not hold the program up.
    let file = OpenOptions::new().read(true).custom_flags(libc::O_NONBLOCK | libc::O_CLOEXEC).open(path);
    let file = file.map_err(fault)?;
    let metadata = file.metadata().map_err(fault)?;
    if !metadata.is_file() {
        return Err(format!("`{shown}` is not a regular file"));
    }
    // SAFETY: the call takes nothing and cannot fail.
    let user = unsafe { libc::geteuid() };
    if metadata.mode() & 0o077 != 0 || ![user, 0].contains(&metadata.uid()) {
        return Err(format!("other users can read or change `{shown}`: restrict it with `chmod 600`"));
    }
    Ok(file)
}

/// The text of such a file.
pub(in crate::command) fn read(path: &Path) -> Result<String, String> {
    let mut text = String::new();
    let read = opened(path)?.take(LARGEST).read_to_string(&mut text);
    read.map_err(|error| format!("`{}` cannot be read: {error}", path.display()))?;
    Ok(text)
}
