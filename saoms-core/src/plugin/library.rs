//! The code of a library.

use std::path::Path;
use std::{error, fmt, slice};

use libloading::{Library, Symbol};
use saoms_api::abi::{ClassTable, Entry, ImportedClass, PluginTable, VERSION};

use super::{Metadata, PluginError};

/// Loads a library for good and gives its classes.
pub(super) fn load(path: &Path, metadata: &Metadata, text: &str) -> Result<Vec<ImportedClass>, PluginError> {
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
    if table.class_count != metadata.classes.len() {
        return Err(disagrees(format!(
            "its code has {} classes, its metadata have {}",
            table.class_count,
            metadata.classes.len()
        )));
    }
    // SAFETY: the table says where its metadata are.
    if unsafe { table.metadata.get_text() }.ok() != Some(text) {
        return Err(disagrees("the texts differ".to_owned()));
    }
    if table.class_count == 0 {
        return Ok(Vec::new());
    }
    // SAFETY: the table says that so many are there, and that is what the metadata say.
    let classes = unsafe { slice::from_raw_parts(table.classes, table.class_count) };
    let small = |class: &&ClassTable| class.size < size_of::<ClassTable>();
    if let Some(class) = classes.iter().find(small) {
        return Err(disagrees(format!(
            "a table of a class has {} bytes, expected {}",
            class.size,
            size_of::<ClassTable>()
        )));
    }
    // SAFETY: a library with metadata of this version keeps the rules of the boundary.
    Ok(classes.iter().map(|class| unsafe { ImportedClass::new(*class) }).collect())
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
