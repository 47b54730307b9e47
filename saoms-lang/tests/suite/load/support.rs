//! Folders of files, and what is said of them.

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

use saoms_lang::contribution::{Finder, FolderFleet, read_values};
use saoms_lang::diagnostic::Diagnostics;
use saoms_lang::load::{MAX_SIZE, load_file, read};
use saoms_lang::model::{Composite, Contribution};
use saoms_lang::source::{OpenTexts, Sources};

/// A folder that is alone in the one around it: contributions in the folders beside it are looked at, too.
pub(crate) struct Folder {
    _around: tempfile::TempDir,
    path: PathBuf,
}

impl Folder {
    pub(crate) fn path(&self) -> &Path {
        &self.path
    }
}

/// A folder with these files.
pub(crate) fn written(files: &[(&str, String)]) -> Folder {
    let around = tempfile::tempdir().unwrap();
    let folder = Folder { path: around.path().join("folder"), _around: around };
    fs::create_dir(folder.path()).unwrap();
    for (name, text) in files {
        let path = folder.path().join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    }
    folder
}

/// The composite of a text, with what is said of it.
pub(crate) fn loaded(name: &str, text: &str) -> (Option<Composite>, Sources, Diagnostics) {
    let (mut sources, mut diagnostics) = (Sources::new(), Diagnostics::new());
    let file = sources.add(name, text);
    (load_file(file, &sources, &mut diagnostics), sources, diagnostics)
}

/// The composite of a file, with the files of its values.
pub(crate) fn load(path: &Path, sources: &mut Sources, diagnostics: &mut Diagnostics) -> Option<Composite> {
    let file = read(path, MAX_SIZE, sources, diagnostics)?;
    let mut composite = load_file(file, sources, diagnostics)?;
    read_values(&mut composite, MAX_SIZE, sources, diagnostics);
    Some(composite)
}

/// The composite of a file and all that it names, with what is said of them. These texts count in place of files.
pub(crate) fn loaded_with_named(path: &Path, open: OpenTexts) -> (Contribution, Sources, Diagnostics) {
    let (mut sources, mut diagnostics) = (Sources::with_open(open), Diagnostics::new());
    let first = load(path, &mut sources, &mut diagnostics);
    let mut contribution = Contribution::of(first.into_iter().collect());
    Finder::new(sources.open().clone()).load_named(&mut contribution, MAX_SIZE, &mut sources, &mut diagnostics);
    (contribution, sources, diagnostics)
}

/// The fleets of a folder, with what is said of its files.
pub(crate) fn loaded_folder(folder: &Path) -> (Vec<FolderFleet>, Sources, Diagnostics) {
    let (mut sources, mut diagnostics) = (Sources::new(), Diagnostics::new());
    let fleets = Finder::new(OpenTexts::default()).load_folder(folder, MAX_SIZE, &mut sources, &mut diagnostics);
    (fleets, sources, diagnostics)
}

/// The diagnostics, with the folder as `FOLDER`.
pub(crate) fn shown(folder: &Path, sources: &Sources, diagnostics: Diagnostics) -> String {
    let mut out = String::new();
    for one in &diagnostics.into_sorted() {
        let file = sources.get(one.location.file);
        let at = file.line_column(one.location.span.start);
        let (severity, code, what) = (one.severity.name(), one.code.id, sources.snippet(one.location));
        let _ = writeln!(out, "{}:{}:{} [{what}] {severity} {code} {}", file.path(), at.line, at.column, one.message);
        one.help.iter().for_each(|help| _ = writeln!(out, "  {help}"));
        one.suggestions.iter().for_each(|one| _ = writeln!(out, "  {}", one.description));
    }
    out.replace(&format!("{}/", folder.display()), "").replace(&folder.display().to_string(), "FOLDER")
}
