//! The code of a library.

use std::path::Path;
use std::{error, fmt, slice};

use libloading::{Library, Symbol};
use saoms_api::abi::{
    ClassTable, Entry, ImportedClass, ImportedLoopClass, LoopClassTable, PluginTable, VERSION,
};

use super::{Code, Metadata, PluginError};

/// Loads a library for good.
pub(super) fn load(path: &Path, metadata: &Metadata, text: &str) -> Result<Code, PluginError> {
    let unloadable = |message: String| PluginError::Unloadable {
        path: path.to_owned(),
        package: metadata.package.clone(),
        message,
    };
    // A name without a slash would be searched for in the system's folders.
    let absolute = std::path::absolute(path).map_err(|error| unloadable(error.to_string()))?;
    // SAFETY: whoever names a library wants its code to run; its metadata say that it was made for this program.
    let library = unsafe { Library::new(&absolute) }.map_err(|error| unloadable(whole(&error)))?;
    // It stays: its functions, its texts and its threads are in use until the program ends.
    let library: &'static Library = Box::leak(Box::new(library));
    let table = {
        // SAFETY: by the rules of the boundary, what the metadata call the entry is a function of this type.
        let entry: Symbol<'_, Entry> =
            unsafe { library.get(metadata.entry.as_bytes()) }.map_err(|error| {
                unloadable(format!("it has no function `{}`: {}", metadata.entry, whole(&error)))
            })?;
        // SAFETY: the same.
        unsafe { entry(VERSION) }
    };
    // SAFETY: by the same rules the table is null or constant; what a table of this version begins with is there.
    let table = unsafe { table.as_ref() }.ok_or_else(|| unloadable("it gives no table".to_owned()))?;
    let disagrees = |message: String| {
        unloadable(format!("its code and its metadata are not from the same build: {message}"))
    };
    if table.version != VERSION {
        return Err(disagrees(format!(
            "its code has version {} of the boundary, expected {VERSION}",
            table.version
        )));
    }
    if table.size < size_of::<PluginTable>() {
        return Err(disagrees(format!(
            "its table has {} bytes, expected {}",
            table.size,
            size_of::<PluginTable>()
        )));
    }
    let counts = [
        ("classes", table.class_count, metadata.classes.len()),
        ("loops", table.loop_count, metadata.loops.len()),
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
    // SAFETY: the table says that so many are there, and that is what the metadata say.
    let (classes, loops) =
        unsafe { (list(table.classes, table.class_count), list(table.loops, table.loop_count)) };
    let class_sizes = classes.iter().map(|class| (class.size, size_of::<ClassTable>()));
    let loop_sizes = loops.iter().map(|one| (one.size, size_of::<LoopClassTable>()));
    if let Some((found, expected)) = class_sizes.chain(loop_sizes).find(|(found, expected)| found < expected)
    {
        return Err(disagrees(format!("a table has {found} bytes, expected {expected}")));
    }
    // SAFETY: a library with metadata of this version keeps the rules of the boundary.
    unsafe {
        Ok(Code {
            classes: classes.iter().map(|class| ImportedClass::new(*class)).collect(),
            loops: loops.iter().map(|one| ImportedLoopClass::new(*one)).collect(),
        })
    }
}

/// # Safety
/// So many are there, for as long as the program runs.
unsafe fn list<T>(first: *const T, count: usize) -> &'static [T] {
    if count == 0 {
        return &[];
    }
    // SAFETY: as the caller promises.
    unsafe { slice::from_raw_parts(first, count) }
}

/// An error with its causes: libloading's own text hides them.
fn whole(error: &dyn error::Error) -> String {
    struct Whole<'a>(&'a dyn error::Error);

    impl fmt::Display for Whole<'_> {
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

    Whole(error).to_string()
}
