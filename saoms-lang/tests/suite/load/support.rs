//! Folders of files, and what is said of them.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use saoms_lang::diagnostic::Diagnostics;
use saoms_lang::source::Sources;

/// A folder of these files.
pub(crate) fn written(files: &[(&str, String)]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in files {
        let path = folder.path().join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    }
    folder
}

/// What is said, with the folder as `FOLDER`.
pub(crate) fn shown(folder: &Path, sources: &Sources, diagnostics: Diagnostics) -> String {
    let mut out = String::new();
    for one in &diagnostics.into_sorted() {
        let file = sources.get(one.location.file);
        let at = file.line_column(one.location.span.start);
        let (severity, code, what) = (one.severity.name(), one.code.id, sources.snippet(one.location));
        let _ = writeln!(
            out,
            "{}:{}:{} [{what}] {severity} {code} {}",
            file.path(),
            at.line,
            at.column,
            one.message
        );
        one.help.iter().for_each(|help| _ = writeln!(out, "  {help}"));
        one.suggestions.iter().for_each(|one| _ = writeln!(out, "  {}", one.description));
    }
    out.replace(&format!("{}/", folder.display()), "").replace(&folder.display().to_string(), "FOLDER")
}
