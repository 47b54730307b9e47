//! Texts of users inside messages.

use saoms_api::host::escaped;

use super::Diagnostic;
use crate::limits::QUOTED_CHARACTERS;
use crate::source::Location;

/// A text of the user between backticks: shortened when long, invisible characters escaped.
///
/// ```
/// assert_eq!(saoms_lang::diagnostic::quoted("a\tb"), "`a\\tb`");
/// ```
pub fn quoted(text: &str) -> String {
    let mut out = String::from("`");
    for (count, character) in text.chars().enumerate() {
        if count == QUOTED_CHARACTERS {
            out.push('…');
            break;
        }
        if character.is_control() || matches!(character, '\u{feff}' | '\u{fffe}' | '\u{ffff}') {
            out.extend(character.escape_default());
        } else {
            out.push(character);
        }
    }
    out.push('`');
    out
}

/// The description of a suggestion that replaces a name.
pub(crate) fn replacing(name: &str, meant: &str) -> String {
    format!("replace {} with {}", quoted(name), quoted(meant))
}

impl Diagnostic {
    /// Adds the suggestion to write another name in place of the one at a place, with what XML asks for in it.
    #[must_use]
    pub(crate) fn replace(self, written: &str, at: Location, meant: &str) -> Self {
        self.suggest(replacing(written, meant), at, escaped(meant))
    }
}
