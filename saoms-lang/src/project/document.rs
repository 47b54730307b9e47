//! Files as documents, for tools that change the text of composites and judge nothing but that it is well-formed.

use std::path::{Path, PathBuf};

use super::read;
use crate::contribution::composites_below;
use crate::diagnostic::{Diagnostic, Diagnostics, human};
use crate::source::Sources;
use crate::syntax::{self, Document, Parse};

/// The reasons why files cannot be taken, with the texts that they are about.
#[derive(Debug)]
pub struct Refused {
    /// The diagnostics by file and place.
    pub diagnostics: Vec<Diagnostic>,
    /// The texts that were read.
    pub sources: Sources,
}

impl Refused {
    /// The diagnostics as people read them.
    pub fn text(&self, colour: bool) -> String {
        human(&self.diagnostics, &self.sources, colour)
    }
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
/// are looked at, are refused beside the files.
pub fn composite_files(paths: &[PathBuf]) -> (Vec<PathBuf>, Option<Refused>) {
    let (mut sources, mut diagnostics) = (Sources::new(), Diagnostics::new());
    let mut files = Vec::with_capacity(paths.len());
    for path in paths {
        match path.is_dir() {
            true => files.extend(composites_below(path, &mut sources, &mut diagnostics)),
            false => files.push(path.clone()),
        }
    }
    let refused = diagnostics.has_errors().then(|| Refused { diagnostics: diagnostics.into_sorted(), sources });
    (files, refused)
}
