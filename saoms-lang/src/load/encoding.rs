//! The probable encoding of bytes that are no UTF-8.

use crate::diagnostic::{Diagnostic, Severity, codes, quoted};
use crate::source::{FileId, Span};

/// An encoding with two or four bytes a letter that the first bytes of a file show, with its name for `iconv`.
pub fn by_its_bytes(bytes: &[u8]) -> Option<&'static str> {
    match bytes {
        [0xff, 0xfe, 0, 0, ..] | [b'<', 0, 0, 0, ..] => Some("UTF-32LE"),
        [0, 0, 0xfe, 0xff, ..] | [0, 0, 0, b'<', ..] => Some("UTF-32BE"),
        [0xff, 0xfe, ..] | [b'<', 0, ..] => Some("UTF-16LE"),
        [0xfe, 0xff, ..] | [0, b'<', ..] => Some("UTF-16BE"),
        _ => None,
    }
}

/// The encoding that an XML declaration names.
pub(super) fn declared(bytes: &[u8]) -> Option<String> {
    let start = bytes.strip_prefix(&[0xef, 0xbb, 0xbf]).unwrap_or(bytes);
    let start = String::from_utf8_lossy(&start[..start.len().min(200)]);
    let (declaration, _) = start.strip_prefix("<?xml")?.split_once("?>")?;
    let (_, after) = declaration.split_once("encoding")?;
    let after = after.trim_start().strip_prefix('=')?.trim_start();
    let quote = after.chars().next().filter(|quote| matches!(quote, '"' | '\''))?;
    let (name, _) = after[1..].split_once(quote)?;
    let is_name = name.bytes().all(|byte| byte.is_ascii_alphanumeric() || b"-_.:".contains(&byte));
    (is_name && !name.is_empty()).then(|| name.to_owned())
}

/// The warning that a file says to be in an encoding that it cannot be in: one of two or four bytes for each letter.
/// Other programs refuse it.
pub(super) fn contradiction(file: FileId, text: &str) -> Option<Diagnostic> {
    const WIDE: [&str; 4] = ["UTF-16", "UTF-32", "UCS-2", "UCS-4"];
    let name = declared(text.as_bytes())?;
    let upper = name.to_ascii_uppercase();
    WIDE.iter().find(|wide| upper.starts_with(**wide) || upper.ends_with(*wide))?;
    let start = text.find(&name)? as u32;
    let place = Span::new(start, start + name.len() as u32).in_file(file);
    let message = format!("the XML declaration says {}, but the file is in UTF-8", quoted(&name));
    let one = Diagnostic::new(&codes::FILE_ENCODING, place, message).severity(Severity::Warning);
    Some(one.suggest(format!("replace {} with `UTF-8`", quoted(&name)), place, "UTF-8"))
}

/// The kind of a file whose first bytes are known to be no text.
pub(super) fn of_another_kind(bytes: &[u8]) -> Option<&'static str> {
    const KINDS: [(&[u8], &str); 8] = [
        (b"PK\x03\x04", "a ZIP or JAR archive"),
        (&[0x1f, 0x8b], "a gzip archive"),
        (b"\x7fELF", "a program or library"),
        (&[0xca, 0xfe, 0xba, 0xbe], "a Java class"),
        (b"%PDF", "a PDF document"),
        (b"\x89PNG", "a picture"),
        (&[0xff, 0xd8, 0xff], "a picture"),
        (b"SQLite format 3", "a database"),
    ];
    KINDS.iter().find(|(start, _)| bytes.starts_with(start)).map(|(_, what)| *what)
}
