//! The layout of `saoms fmt` for a text that is open.

use saoms_lang::source::Sources;
use saoms_lang::xml;

use super::scene::file::File;
use crate::format::{WIDTH, format};

/// The text of a file in the one layout; `None` where the file is not well-formed.
pub fn formatted(file: &File) -> Option<String> {
    let mut sources = Sources::new();
    let id = sources.add(file.path.display().to_string(), file.text.to_string());
    let parsed = xml::parse(id, sources.get(id).text());
    let document = parsed.document.filter(|_| parsed.fault.is_none())?;
    Some(format(&document, WIDTH))
}
