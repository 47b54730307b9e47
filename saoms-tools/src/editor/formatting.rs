//! The layout of `saoms fmt` for a text that is open.

use saoms_lang::source::Sources;
use saoms_lang::syntax;

use super::scene::file::File;
use crate::format::{WIDTH, format};

/// The text of a file in the one layout; `None` where the file is not well-formed.
pub fn formatted(file: &File) -> Option<String> {
    let mut sources = Sources::new();
    let id = sources.add(file.path.display().to_string(), file.text.to_string());
    let document = syntax::parse(id, sources.get(id).text()).well_formed().ok()?;
    Some(format(&document, WIDTH))
}
