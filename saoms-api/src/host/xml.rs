//! XML that is written.

use std::fmt::Write;

/// A text as it can stand everywhere in XML: inside an element, and in an attribute within quotation marks of either
/// kind.
///
/// Characters that reading would change are written by their numbers: tabs and line ends, which become blanks in
/// attributes (XML 1.0, 3.3.3), and returns (2.11). A character that XML has no way to write (2.2) becomes U+FFFD.
///
/// ```
/// assert_eq!(saoms_api::host::escaped("a\"b]]> & 'c'\n"), "a&quot;b]]&gt; &amp; &apos;c&apos;&#10;");
/// ```
pub fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for character in text.chars() {
        match character {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&apos;"),
            '\t' | '\n' | '\r' => _ = write!(out, "&#{};", u32::from(character)),
            '\u{0}'..='\u{1f}' | '\u{fffe}' | '\u{ffff}' => out.push('\u{fffd}'),
            _ => out.push(character),
        }
    }
    out
}
