//! `file:` URIs and paths.

use std::fmt::Write;
use std::path::{Path, PathBuf};

/// The path that a `file:` URI names; `None` for other URIs.
pub(super) fn path(uri: &str) -> Option<PathBuf> {
    let rest = uri.strip_prefix("file://")?;
    // The host, as a rule none, is this machine's.
    let rest = &rest[rest.find('/')?..];
    let mut bytes = Vec::with_capacity(rest.len());
    let mut left = rest.bytes();
    while let Some(byte) = left.next() {
        let digit = |byte: Option<u8>| (byte? as char).to_digit(16);
        match byte {
            b'?' | b'#' => break,
            b'%' => {
                let (high, low) = (digit(left.next())?, digit(left.next())?);
                bytes.push((high * 16 + low) as u8);
            }
            byte => bytes.push(byte),
        }
    }
    Some(PathBuf::from(String::from_utf8(bytes).ok()?))
}

/// The URI of a path.
pub(super) fn uri(path: &Path) -> String {
    let path = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    let mut uri = "file://".to_owned();
    for byte in path.to_string_lossy().bytes() {
        if byte.is_ascii_alphanumeric() || b"/-._~".contains(&byte) {
            uri.push(byte as char);
        } else {
            let _ = write!(uri, "%{byte:02X}");
        }
    }
    uri
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_become_uris_and_back() {
        for (shown, expected) in [
            ("/a/b.composite", "file:///a/b.composite"),
            ("/a b/ü%.c#d", "file:///a%20b/%C3%BC%25.c%23d"),
            ("/🤖", "file:///%F0%9F%A4%96"),
        ] {
            assert_eq!(uri(Path::new(shown)), expected);
            assert_eq!(path(expected).unwrap(), Path::new(shown));
        }
    }

    #[test]
    fn uris_of_editors_are_understood() {
        assert_eq!(path("file://localhost/a").unwrap(), Path::new("/a"));
        assert_eq!(path("file:///c%3a/%e2%82%ac").unwrap(), Path::new("/c:/€"));
        assert_eq!(path("untitled:Untitled-1"), None);
        assert_eq!(path("file:///a%2"), None);
        assert_eq!(path("file:///%ff"), None);
        assert_eq!(path("file://"), None);
    }
}
