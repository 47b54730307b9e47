//! The code of a library.

use std::ffi::{CStr, OsStr, OsString, c_int, c_void};
use std::mem::{MaybeUninit, offset_of};
use std::os::unix::ffi::OsStrExt;
use std::os::unix::fs::MetadataExt;
use std::path::Path;
use std::sync::{Mutex, PoisonError};
use std::{error, fmt, fs, ptr, slice};

use libloading::os::unix::{Library, Symbol};
use saoms_abi::{PluginTable, VERSION};
use saoms_api::host::present::{self, Function, Owner, enter, looked_after};

use super::boundary::Implementation;
use super::copy::{FLAGS, PrivateCopy};
use super::tables::{all, whole};
use super::{Code, ImportedClass, ImportedLoopClass, ImportedRule, Metadata, PluginError};

/// Loads a library, and gives what its entry gives for this version of a boundary: null or a constant table. It is
/// never unloaded.
pub(crate) fn load_table<T>(
    path: &Path,
    package: &str,
    entry: &str,
    version: u32,
) -> Result<(&'static str, *const T), PluginError> {
    let unloadable =
        |message: String| PluginError::Unloadable { path: path.to_owned(), package: package.to_owned(), message };
    let name: &'static str = path.display().to_string().leak();
    let owner = Owner::of_library(name);
    let _looked = looked_after(owner, Function::Load);
    let _entered = enter(owner, Function::Load);
    let library = loaded(path).map_err(unloadable)?;
    let missing = |why: &str| unloadable(format!("it has no function `{entry}`: {why}"));
    // SAFETY: by the rules of the boundary, what the metadata call the entry is a function of this type.
    let entry: Symbol<unsafe extern "C" fn(u32) -> *const T> =
        unsafe { library.code.get(entry.as_bytes()) }.map_err(|error| missing(&with_causes(&error)))?;
    // The system also finds those of the libraries that it depends on, such as `_exit`.
    if !library.has(*entry as usize) {
        return Err(missing("it is one of another library"));
    }
    note_code(name, *entry as usize);
    // SAFETY: the same.
    Ok((name, unsafe { entry(version) }))
}

/// Loads a library of components. It is never unloaded.
pub(super) fn load(path: &Path, metadata: &Metadata, text: &str) -> Result<Code, PluginError> {
    let unloadable =
        |message: String| PluginError::Unloadable { path: path.to_owned(), package: metadata.package.clone(), message };
    let (name, table) = load_table::<PluginTable>(path, &metadata.package, &metadata.entry, VERSION)?;
    // SAFETY: by the same rules the table is null or constant; what a table of this version begins with is there, and
    // what may be missing is not looked at before its size.
    let table = unsafe { table.as_ref() }.ok_or_else(|| unloadable("it returns no table".to_owned()))?;
    let disagrees =
        |message: String| unloadable(format!("its code and its metadata are not from the same build: {message}"));
    if table.version != VERSION {
        return Err(disagrees(format!("its code has version {} of the boundary, expected {VERSION}", table.version)));
    }
    // What came later may be missing in libraries that were built before.
    let least = offset_of!(PluginTable, implementations);
    if table.size < least {
        return Err(disagrees(format!("its table has {} bytes, expected {least}", table.size)));
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
        let mut code = Code { classes: Vec::new(), loops: Vec::new(), rules: Vec::new(), implementation: None };
        let names = metadata.class_names();
        for ((class, of), asked) in
            all(table.classes, "class", &names)?.into_iter().zip(&names).zip(metadata.asked_functions())
        {
            whole((*class).component, &format!("class `{of}`"))?;
            let class = ImportedClass::new(&*class, name);
            if let Some((function, why)) = asked.into_iter().find(|(function, _)| !class.has(function)) {
                return Err(format!(
                    "`{function}` in its `SaomsComponentTable` of class `{of}` is null, but its metadata say `{why}`: \
                     set one or leave out the other"
                ));
            }
            code.classes.push(class);
        }
        let names = metadata.loop_names();
        for (looping, of) in all(table.loops, "loop", &names)?.into_iter().zip(&names) {
            whole((*looping).looping, &format!("loop `{of}`"))?;
            code.loops.push(ImportedLoopClass::new(&*looping, name));
        }
        let names: Vec<String> = metadata.rules.iter().map(|rule| rule.code.id.to_owned()).collect();
        for (rule, of) in all(table.rules, "rule", &names)?.into_iter().zip(&names) {
            code.rules.push(ImportedRule::new(*rule, Owner::of(&format!("rule `{of}`"), name)));
        }
        if let Some(language) = metadata.implementations.first() {
            let of = format!("implementations of `{language}`");
            let given = table.size >= size_of::<PluginTable>();
            let table = whole(if given { table.implementations } else { ptr::null() }, &of)?;
            whole((*table).component, &of)?;
            code.implementation = Some(Implementation::new(&*table, name));
        }
        Ok(code)
    };
    code().map_err(unloadable)
}

/// Notes the addresses of a library's code, of which this is one, so that a crash on a thread of its own is told.
fn note_code(library: &'static str, address: usize) {
    struct Asked(&'static str, usize);

    /// Called for each library of the process until it answers with something else than 0.
    unsafe extern "C" fn look(about: *mut libc::dl_phdr_info, _: usize, asked: *mut c_void) -> c_int {
        // SAFETY: the system lends what it knows of a library, and gives back what `dl_iterate_phdr` was given.
        let (about, Asked(library, address)) = unsafe { (&*about, &*asked.cast::<Asked>()) };
        // SAFETY: so many headers are there.
        let headers = unsafe { slice::from_raw_parts(about.dlpi_phdr, usize::from(about.dlpi_phnum)) };
        let is_code = |header: &&libc::Elf64_Phdr| header.p_type == libc::PT_LOAD && header.p_flags & libc::PF_X != 0;
        let range = |header: &libc::Elf64_Phdr| {
            let start = (about.dlpi_addr + header.p_vaddr) as usize;
            start..start + header.p_memsz as usize
        };
        let mut code = headers.iter().filter(is_code).map(range);
        if !code.clone().any(|range| range.contains(address)) {
            return 0;
        }
        code.by_ref().for_each(|range| present::note_code(library, range));
        1
    }

    let mut asked = Asked(library, address);
    // SAFETY: the function gets the value that lives until the call returns.
    unsafe { libc::dl_iterate_phdr(Some(look), (&raw mut asked).cast()) };
}

/// A library that is loaded.
struct Loaded {
    code: Library,
    /// The name of the file that it was loaded from, which no other library has.
    file: Option<OsString>,
}

impl Loaded {
    /// True if this address lies in it.
    fn has(&self, address: usize) -> bool {
        let mut about = MaybeUninit::<libc::Dl_info>::zeroed();
        // SAFETY: all zeros are such a value; where the call finds something, it has written a name that stays.
        let name = unsafe {
            if libc::dladdr(address as *const c_void, about.as_mut_ptr()) == 0 {
                return false;
            }
            CStr::from_ptr(about.assume_init().dli_fname)
        };
        Path::new(OsStr::from_bytes(name.to_bytes())).file_name() == self.file.as_deref()
    }
}

/// The code of a file: that which is loaded already, if it is the same file.
fn loaded(path: &Path) -> Result<&'static Loaded, String> {
    /// Device, inode, size, and the times of the last change of content and file.
    type Stamp = (u64, u64, u64, [i64; 4]);
    static LOADED: Mutex<Vec<(Stamp, &'static Loaded)>> = Mutex::new(Vec::new());
    let about = fs::metadata(path).map_err(|error| error.to_string())?;
    let times = [about.mtime(), about.mtime_nsec(), about.ctime(), about.ctime_nsec()];
    let stamp = (about.dev(), about.ino(), about.size(), times);
    let mut loaded = LOADED.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some((_, library)) = loaded.iter().find(|(known, _)| *known == stamp) {
        return Ok(library);
    }
    let copy = PrivateCopy::of(path).map_err(|error| format!("it cannot be copied: {error}"))?;
    copy.load_dependencies(path)?;
    // All that it calls is bound now: a function that nobody has would end the program when it is called first.
    // SAFETY: whoever names a library wants its code to run; its metadata say that it was made for this program.
    let library = unsafe { Library::open(Some(&copy.path), FLAGS) };
    // Never unloaded: its functions, texts and threads are in use until the program ends.
    let code = library.map_err(|error| why(&error, &copy.path))?;
    let file = copy.path.file_name().map(ToOwned::to_owned);
    let library: &'static Loaded = Box::leak(Box::new(Loaded { code, file }));
    loaded.push((stamp, library));
    Ok(library)
}

/// What keeps the system from loading a library, without the name of the file that it was loaded from, and what to do.
pub(super) fn why(error: &dyn error::Error, file: &Path) -> String {
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
