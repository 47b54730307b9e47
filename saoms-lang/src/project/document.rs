//! Files as documents, for tools that change the text of composites and judge nothing but that it is well-formed.

use std::path::{Path, PathBuf};

use super::read;
use crate::contribution::{composites_below, root};
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::source::{OpenTexts, Sources};
use crate::syntax::{self, Document, Parse};

/// The reasons why files cannot be taken, with the texts that they are about.
#[derive(Debug)]
pub struct Refused {
    /// The diagnostics by file and place.
    pub diagnostics: Vec<Diagnostic>,
    /// The texts that were read.
    pub sources: Sources,
}

/// The document of a file of at most `max_size` bytes, or of standard input where the path is [`INPUT`](super::INPUT).
///
/// # Errors
/// The file cannot be read, or is not well-formed.
pub fn document(path: &Path, max_size: u64) -> Result<Document, Box<Refused>> {
    let (mut sources, mut diagnostics) = (Sources::new(), Diagnostics::new());
    let file = read(path, max_size, &mut sources, &mut diagnostics);
    if let Some(file) = file {
        let Parse { document, faults } = syntax::parse(file, sources.get(file).text());
        if faults.is_empty() {
            return Ok(document);
        }
        faults.into_iter().for_each(|fault| diagnostics.push(fault));
    }
    Err(Box::new(Refused { diagnostics: diagnostics.into_sorted(), sources }))
}

/// The files of these paths, where a folder means all composites in it and below. Folders with none, and with more than
/// are looked at, are refused beside the files, and so are links that lead out of a folder unless that is allowed.
pub fn composite_files(paths: &[PathBuf], allows_outside: bool) -> (Vec<PathBuf>, Option<Refused>) {
    let open = OpenTexts::default().confined(!allows_outside);
    let (mut sources, mut diagnostics) = (Sources::with_open(open.clone()), Diagnostics::new());
    let mut files = Vec::with_capacity(paths.len());
    for path in paths {
        if !path.is_dir() {
            files.push(path.clone());
            continue;
        }
        open.permit(path);
        open.permit(&root(path));
        for file in composites_below(path, &mut sources, &mut diagnostics) {
            match open.outside(&file) {
                // It says why it is not read.
                Some(_) => _ = read(&file, 0, &mut sources, &mut diagnostics),
                None => files.push(file),
            }
        }
    }
    let refused = diagnostics.has_errors().then(|| Refused { diagnostics: diagnostics.into_sorted(), sources });
    (files, refused)
}
