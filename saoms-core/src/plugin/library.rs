//! The code of a library.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};
use std::{env, error, fmt, fs, io, process};

use libloading::{Library, Symbol};
use saoms_abi::{EntryPoint, PluginTable, VERSION};

use super::boundary::LEAST_COMPONENT_TABLE;
use super::{Code, ImportedClass, ImportedLoopClass, ImportedRule, Metadata, PluginError};

/// Loads a library. It is never unloaded.
pub(super) fn load(path: &Path, copied: bool, metadata: &Metadata, text: &str) -> Result<Code, PluginError> {
    let unloadable =
        |message: String| PluginError::Unloadable { path: path.to_owned(), package: metadata.package.clone(), message };
    // A name without a slash would be searched for in the system's folders.
    let absolute = std::path::absolute(path).map_err(|error| unloadable(error.to_string()))?;
    let copy = match copied {
        true => Some(copy(&absolute).map_err(|error| unloadable(format!("no copy of it: {error}")))?),
        false => None,
    };
    let file = copy.as_deref().unwrap_or(&absolute);
    // SAFETY: whoever names a library wants its code to run; its metadata say that it was made for this program.
    let library = unsafe { Library::new(file) }.map_err(|error| unloadable(with_causes(&error)));
    if let Some(copy) = &copy {
        // The loaded library does not need the file name any more.
        let _ = fs::remove_file(copy);
    }
    let library = library?;
    // Never unloaded: its functions, texts and threads are in use until the program ends.
    let library: &'static Library = Box::leak(Box::new(library));
    let table = {
        // SAFETY: by the rules of the boundary, what the metadata call the entry is a function of this type.
        let entry: Symbol<'_, EntryPoint> = unsafe { library.get(metadata.entry.as_bytes()) }
            .map_err(|error| unloadable(format!("it has no function `{}`: {}", metadata.entry, with_causes(&error))))?;
        // SAFETY: the same.
        unsafe { entry(VERSION) }
    };
    // SAFETY: by the same rules the table is null or constant; what a table of this version begins with is there.
    let table = unsafe { table.as_ref() }.ok_or_else(|| unloadable("it gives no table".to_owned()))?;
    let disagrees =
        |message: String| unloadable(format!("its code and its metadata are not from the same build: {message}"));
    if table.version != VERSION {
        return Err(disagrees(format!("its code has version {} of the boundary, expected {VERSION}", table.version)));
    }
    if table.size < size_of::<PluginTable>() {
        return Err(disagrees(format!("its table has {} bytes, expected {}", table.size, size_of::<PluginTable>())));
    }
    let counts = [
        ("classes", table.class_count, metadata.classes.len()),
        ("loops", table.loop_count, metadata.loops.len()),
        ("rules", table.rule_count, metadata.rules.len()),
    ];
    for (what, found, expected) in counts {
        if found != expected {
            return Err(disagrees(format!("its code has {found} {what}, its metadata have {expected}")));
        }
    }
    // SAFETY: the table says where its metadata are.
    if unsafe { table.metadata.get_text() }.ok() != Some(text) {
        return Err(disagrees("the texts differ".to_owned()));
    }
    // SAFETY: a library with metadata of this version keeps the rules of the boundary: so many tables are there.
    unsafe {
        let classes = tables(table.classes, table.class_count).map_err(disagrees)?;
        let loops = tables(table.loops, table.loop_count).map_err(disagrees)?;
        let rules = tables(table.rules, table.rule_count).map_err(disagrees)?;
        for class in &classes {
            check(class.component, LEAST_COMPONENT_TABLE).map_err(disagrees)?;
        }
        for looping in &loops {
            one(looping.looping).map_err(disagrees)?;
        }
        Ok(Code {
            classes: classes.into_iter().map(|class| ImportedClass::new(class)).collect(),
            loops: loops.into_iter().map(|looping| ImportedLoopClass::new(looping)).collect(),
            rules: rules.into_iter().map(|rule| ImportedRule::new(*rule)).collect(),
        })
    }
}

/// A copy of a library: beside it, where it finds what it depends on, or among the temporary files.
fn copy(path: &Path) -> io::Result<PathBuf> {
    static NUMBER: AtomicU32 = AtomicU32::new(0);
    let number = NUMBER.fetch_add(1, Ordering::Relaxed);
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let name = format!(".{name}.{}-{number}", process::id());
    let beside = path.with_file_name(&name);
    fs::copy(path, &beside).map(|_| beside).or_else(|_| {
        let elsewhere = env::temp_dir().join(&name);
        fs::copy(path, &elsewhere).map(|_| elsewhere)
    })
}

/// A table, which begins with its size.
///
/// # Safety
/// It is null, or there for as long as the program runs.
unsafe fn one<T>(table: *const T) -> Result<&'static T, String> {
    // SAFETY: as the caller promises; when it has the size of the type, all of it is there.
    unsafe { check(table, size_of::<T>()).map(|()| &*table) }
}

/// Checks that a table is there and has so many bytes at least. If a table gains fields within a version, that is the
/// first size of the version, and missing fields are `None`.
///
/// # Safety
/// As [`one`].
unsafe fn check<T>(table: *const T, least: usize) -> Result<(), String> {
    if table.is_null() {
        return Err("a table is missing".to_owned());
    }
    // SAFETY: as the caller promises; all tables begin with their size.
    let size = unsafe { *table.cast::<usize>() };
    if size < least {
        return Err(format!("a table has {size} bytes, expected {least}"));
    }
    Ok(())
}

/// # Safety
/// So many are there, for as long as the program runs.
unsafe fn tables<T>(first: *const *const T, count: usize) -> Result<Vec<&'static T>, String> {
    // SAFETY: as the caller promises.
    (0..count).map(|place| unsafe { one(*first.add(place)) }).collect()
}

/// An error with its causes: libloading's own text hides them.
fn with_causes(error: &dyn error::Error) -> String {
    struct WithCauses<'a>(&'a dyn error::Error);

    impl fmt::Display for WithCauses<'_> {
        fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
            write!(out, "{}", self.0)?;
            let mut cause = self.0.source();
            while let Some(error) = cause {
                write!(out, ": {error}")?;
                cause = error.source();
            }
            Ok(())
        }
    }

    WithCauses(error).to_string()
}
