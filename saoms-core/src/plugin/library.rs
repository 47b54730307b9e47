//! The code of a library.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};
use std::{env, error, fmt, fs, io, process};

use libloading::os::unix::{Library, RTLD_LOCAL, RTLD_NOW, Symbol};
use saoms_abi::{EntryPoint, PluginTable, VERSION};

use super::tables::{all, whole};
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
    // All that it calls is bound now: a function that nobody has would end the program when it is called first.
    // SAFETY: whoever names a library wants its code to run; its metadata say that it was made for this program.
    let library =
        unsafe { Library::open(Some(file), RTLD_NOW | RTLD_LOCAL) }.map_err(|error| unloadable(why(&error, file)));
    if let Some(copy) = &copy {
        // The loaded library does not need the file name any more.
        let _ = fs::remove_file(copy);
    }
    let library = library?;
    // Never unloaded: its functions, texts and threads are in use until the program ends.
    let library: &'static Library = Box::leak(Box::new(library));
    let table = {
        // SAFETY: by the rules of the boundary, what the metadata call the entry is a function of this type.
        let entry: Symbol<EntryPoint> = unsafe { library.get(metadata.entry.as_bytes()) }
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
    let code = || unsafe {
        let mut code = Code { classes: Vec::new(), loops: Vec::new(), rules: Vec::new() };
        let names = metadata.class_names();
        for (class, name) in all(table.classes, "class", &names)?.into_iter().zip(&names) {
            whole((*class).component, &format!("class `{name}`"))?;
            code.classes.push(ImportedClass::new(&*class));
        }
        let names = metadata.loop_names();
        for (looping, name) in all(table.loops, "loop", &names)?.into_iter().zip(&names) {
            whole((*looping).looping, &format!("loop `{name}`"))?;
            code.loops.push(ImportedLoopClass::new(&*looping));
        }
        let names: Vec<String> = metadata.rules.iter().map(|rule| rule.code.id.to_owned()).collect();
        for rule in all(table.rules, "rule", &names)? {
            code.rules.push(ImportedRule::new(*rule));
        }
        Ok(code)
    };
    code().map_err(unloadable)
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

/// What keeps the system from loading a library, without the name of the file that it was loaded from, and what to do.
fn why(error: &dyn error::Error, file: &Path) -> String {
    let text = with_causes(error);
    let text = text.replace(&format!("{}: ", file.display()), "");
    match text.contains("undefined symbol") {
        true => format!("{text}: link it with the file that defines this, or with `-l` of the library that does"),
        false => text,
    }
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
