//! Files that are written whole or not at all: a text is written beside the file and takes its name.

use std::fs::{self, File, Metadata, OpenOptions};
use std::io::{self, BufWriter, ErrorKind, Write};
use std::os::unix::fs::{MetadataExt, OpenOptionsExt, fchown};
use std::path::{Path, PathBuf};
use std::process;

/// Gives a file, which need not exist yet, another content. What there was stays if that cannot be written. The path
/// must be no link: that would be replaced and not the file behind it.
pub(crate) fn replace(path: &Path, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
    let earlier = earlier(path)?;
    let (file, beside) = create_beside(path, earlier.is_some())?;
    let written = fill(&file, earlier.as_ref(), write).and_then(|()| fs::rename(&beside, path));
    if written.is_err() {
        // Whatever is left of it is of no use.
        let _ = fs::remove_file(&beside);
    }
    written
}

/// Tries whether [`replace`] can do its work, without a trace.
pub(super) fn can_replace(path: &Path) -> io::Result<()> {
    let (_, beside) = create_beside(path, earlier(path)?.is_some())?;
    fs::remove_file(beside)
}

/// The file that is there, which its user may write: one that is protected is not replaced either.
fn earlier(path: &Path) -> io::Result<Option<Metadata>> {
    match OpenOptions::new().write(true).open(path) {
        Ok(file) => file.metadata().map(Some),
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(None),
        Err(error) => Err(error),
    }
}

/// Creates a file in the folder of another one.
fn create_beside(path: &Path, is_there: bool) -> io::Result<(File, PathBuf)> {
    let folder = path.parent().unwrap_or(Path::new(""));
    // Until it has the permissions of the file that it replaces, nobody else reads it.
    let mode = if is_there { 0o600 } else { 0o666 };
    let mut number = 0;
    loop {
        let beside = folder.join(format!(".saoms.{}.{number}.new", process::id()));
        match OpenOptions::new().write(true).create_new(true).mode(mode).open(&beside) {
            Ok(file) => return Ok((file, beside)),
            // Of another output, or of a process of this number that was killed.
            Err(error) if error.kind() == ErrorKind::AlreadyExists => number += 1,
            Err(error) => return Err(error),
        }
    }
}

fn fill(
    file: &File,
    earlier: Option<&Metadata>,
    write: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> io::Result<()> {
    let mut buffered = BufWriter::new(file);
    write(&mut buffered)?;
    buffered.flush()?;
    if let Some(earlier) = earlier {
        // Only the superuser may give a file to others; who may not keeps what is theirs.
        let _ = fchown(file, Some(earlier.uid()), Some(earlier.gid()));
        file.set_permissions(earlier.permissions())?;
    }
    file.sync_all()
}
