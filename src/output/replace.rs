//! Files that are written whole or not at all: a text is written beside the file and takes its name.

use std::fs::{self, File, Metadata, OpenOptions, Permissions};
use std::io::{self, BufWriter, ErrorKind, Write};
use std::os::unix::fs::{MetadataExt, OpenOptionsExt, PermissionsExt, fchown};
use std::path::{Path, PathBuf};
use std::process;
use std::sync::OnceLock;

/// The bits that new files lack, as the program was started: code of a library may set others.
static MASK: OnceLock<libc::mode_t> = OnceLock::new();

/// Notes the present mask as that of files to come. Asked while no other thread makes a file.
pub(crate) fn keep_mask() {
    MASK.get_or_init(|| {
        // SAFETY: the calls take no pointers and never fail. The mask can only be read by setting another one.
        unsafe {
            let mask = libc::umask(0o077);
            libc::umask(mask);
            mask
        }
    });
}

/// Permissions of new files, once the mask is kept.
pub(crate) fn mode_of_files() -> Option<u32> {
    MASK.get().map(|mask| 0o666 & !mask)
}

/// Makes a folder, with all above it that are not there.
pub(super) fn make_folder(path: &Path) -> io::Result<()> {
    if let Some(mask) = MASK.get() {
        // SAFETY: the call takes no pointers and never fails.
        unsafe { libc::umask(*mask) };
    }
    fs::create_dir_all(path)
}

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
    } else if let Some(mode) = mode_of_files() {
        file.set_permissions(Permissions::from_mode(mode))?;
    }
    file.sync_all()
}
