//! The first tags of files.

use std::borrow::Cow;
use std::fs;
use std::io::Read;
use std::path::{Path, PathBuf};

use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};

use crate::limits::FIRST_TAG_BYTES;
use crate::source::OpenTexts;

/// A composite that was seen.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Head {
    pub(super) path: PathBuf,
    pub(super) namespace: String,
    pub(super) local: String,
}

#[cfg(test)]
thread_local! {
    /// The number of files that were read.
    pub(super) static LOOKED_AT: std::cell::Cell<usize> = const { std::cell::Cell::new(0) };
}

/// The name and namespace of the composite in a file; `None` when its first tag is no `composite`.
pub(super) fn head(path: &Path, open: &OpenTexts) -> Option<Head> {
    #[cfg(test)]
    LOOKED_AT.with(|count| count.set(count.get() + 1));
    first_tag(path, open, |tag| {
        if tag.local_name().as_ref() != "composite" {
            return None;
        }
        let namespace = value(tag, "targetNamespace").unwrap_or_default();
        Some(Head { path: path.to_owned(), namespace, local: value(tag, "name")? })
    })
}

/// The local name of the first tag of a file and its namespace, as far as the tag says it.
pub(super) fn root(path: &Path, open: &OpenTexts) -> Option<(String, Option<String>)> {
    first_tag(path, open, |tag| {
        let prefix = tag.name().prefix().map(|prefix| format!("xmlns:{}", prefix.as_ref()));
        let namespace = value(tag, prefix.as_deref().unwrap_or("xmlns"));
        Some((tag.local_name().as_ref().to_owned(), namespace))
    })
}

fn value(tag: &BytesStart<'_>, name: &str) -> Option<String> {
    let found = tag.try_get_attribute(name).ok().flatten()?;
    quick_xml::escape::unescape(&found.value).ok().map(|text| text.trim().to_owned())
}

/// The result of the first tag of a file.
fn first_tag<T>(path: &Path, open: &OpenTexts, make: impl FnOnce(&BytesStart<'_>) -> Option<T>) -> Option<T> {
    if open.outside(path).is_some() {
        return None;
    }
    let mut bytes = Vec::new();
    let text = if let Some(open) = open.get(path) {
        Cow::Borrowed(open.as_str())
    } else {
        // What is no file, as a pipe, might never come to an end.
        if !fs::metadata(path).ok()?.is_file() {
            return None;
        }
        open.read(path).ok()?.take(FIRST_TAG_BYTES).read_to_end(&mut bytes).ok()?;
        String::from_utf8_lossy(&bytes)
    };
    let mut reader = Reader::from_str(text.trim_start_matches('\u{feff}'));
    loop {
        match reader.read_event().ok()? {
            Event::Start(tag) | Event::Empty(tag) => return make(&tag),
            Event::Eof => return None,
            _ => {}
        }
    }
}
