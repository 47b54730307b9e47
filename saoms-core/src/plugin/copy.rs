//! The private copy of a library that is loaded in its place: code is read from its file while it runs, so that a
//! linker or a copy that writes over the file would end the program.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};
use std::{env, fs, io, process};

use libloading::os::unix::{Library, RTLD_LOCAL, RTLD_NOW};
use object::Endianness;
use object::elf::{self, FileHeader64};
use object::read::elf::{Dyn as _, FileHeader as _};

use super::library::why;

/// How libraries are loaded: all that they call is bound at once, and their own `dlclose` does not unload them.
pub(super) const FLAGS: i32 = RTLD_NOW | RTLD_LOCAL | libc::RTLD_NODELETE;

/// A copy of a library, until it is loaded: the loaded code does not need the name of its file any more.
pub(super) struct PrivateCopy {
    pub(super) path: PathBuf,
    /// True if it lies beside the library, where the system finds what it depends on by paths from its own folder.
    is_beside: bool,
}

impl Drop for PrivateCopy {
    fn drop(&mut self) {
        let _ = fs::remove_file(&self.path);
    }
}

impl PrivateCopy {
    /// A copy beside a library, or among the temporary files where nothing can be written beside it.
    pub(super) fn of(library: &Path) -> io::Result<PrivateCopy> {
        static NUMBER: AtomicU32 = AtomicU32::new(0);
        let number = NUMBER.fetch_add(1, Ordering::Relaxed);
        // A name without a slash would be searched for in the system's folders.
        let library = std::path::absolute(library)?;
        let name = library.file_name().unwrap_or_default().to_string_lossy();
        // Hidden, and with no ending of a library: nobody takes it for one.
        let name = format!(".{name}.{}-{number}", process::id());
        let copied = |path: PathBuf, is_beside: bool| {
            let copy = PrivateCopy { path, is_beside };
            fs::copy(&library, &copy.path).map(|_| copy)
        };
        copied(library.with_file_name(&name), true).or_else(|_| copied(env::temp_dir().join(&name), false))
    }

    /// Loads what a library depends on by paths from its own folder, in which its copy is not: the system takes what is
    /// loaded already for what the copy asks for.
    pub(super) fn load_dependencies(&self, library: &Path) -> Result<(), String> {
        if self.is_beside {
            return Ok(());
        }
        for dependency in dependencies(library).unwrap_or_default() {
            // SAFETY: whoever names a library wants its code to run, and this is a part of it.
            let loaded = unsafe { Library::open(Some(&dependency), FLAGS) };
            // Never unloaded, as the library.
            std::mem::forget(loaded.map_err(|error| why(&error, &dependency))?);
        }
        Ok(())
    }
}

/// The files that a library depends on by paths from its own folder.
fn dependencies(library: &Path) -> Option<Vec<PathBuf>> {
    let data = fs::read(library).ok()?;
    let data = data.as_slice();
    let header = FileHeader64::<Endianness>::parse(data).ok()?;
    let endian = header.endian().ok()?;
    let sections = header.sections(endian, data).ok()?;
    let (entries, link) = sections.dynamic(endian, data).ok()??;
    let strings = sections.strings(endian, data, link).ok()?;
    let folder = std::path::absolute(library).ok()?.parent()?.to_str()?.to_owned();
    let (mut needed, mut folders) = (Vec::new(), Vec::new());
    for entry in entries {
        let text = || entry.string(endian, strings).ok().and_then(|text| std::str::from_utf8(text).ok());
        match entry.tag(endian) {
            elf::DT_NEEDED => needed.extend(text()),
            elf::DT_RPATH | elf::DT_RUNPATH => {
                let paths = text().unwrap_or_default().split(':').filter(|path| path.contains("ORIGIN"));
                folders.extend(paths.map(|path| path.replace("${ORIGIN}", &folder).replace("$ORIGIN", &folder)));
            }
            _ => {}
        }
    }
    let file = |name: &str| folders.iter().map(|folder| Path::new(folder).join(name)).find(|path| path.exists());
    Some(needed.into_iter().filter_map(file).collect())
}

#[cfg(test)]
mod tests {
    use std::process::Command;

    use super::*;

    #[test]
    fn a_copy_elsewhere_has_what_lies_beside_the_library() {
        let (folder, elsewhere) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
        let build = |name: &str, code: &str, more: &[&str]| {
            let source = folder.path().join(name).with_extension("c");
            fs::write(&source, code).unwrap();
            let mut cc = Command::new("cc");
            cc.args(["-shared", "-fPIC", "-o", name]).arg(&source).args(more).current_dir(folder.path());
            assert!(cc.status().unwrap().success());
        };
        build("libcopied_wheels.so", "int turn(void) { return 7; }\n", &["-Wl,-soname,libcopied_wheels.so"]);
        let link = ["-L.", "-lcopied_wheels", "-Wl,-rpath,$ORIGIN"];
        build("libcopied_robot.so", "extern int turn(void);\nint go(void) { return turn(); }\n", &link);
        let library = folder.path().join("libcopied_robot.so");
        let copy = PrivateCopy { path: elsewhere.path().join("copy"), is_beside: false };
        fs::copy(&library, &copy.path).unwrap();
        // SAFETY: the code is that above.
        let open = || unsafe { Library::open(Some(&copy.path), FLAGS) };
        assert!(open().is_err());
        copy.load_dependencies(&library).unwrap();
        open().unwrap();
    }
}
