//! Texts of users inside messages.

use saoms_api::host::{escaped, one_line};

use super::Diagnostic;
use crate::limits::{LISTED_NAMES, QUOTED_CHARACTERS};
use crate::source::Location;

/// A text of the user between backticks: shortened when long, invisible characters escaped.
///
/// ```
/// assert_eq!(saoms_lang::diagnostic::quoted("a\tb"), "`a\\tb`");
/// ```
pub fn quoted(text: &str) -> String {
    let end = text.char_indices().nth(QUOTED_CHARACTERS).map_or(text.len(), |(end, _)| end);
    format!("`{}{}`", one_line(&text[..end]), if end < text.len() { "…" } else { "" })
}

/// The description of a suggestion that replaces a name.
pub(crate) fn replacing(name: &str, meant: &str) -> String {
    match meant {
        "" => format!("remove {}", quoted(name)),
        meant => format!("replace {} with {}", quoted(name), quoted(meant)),
    }
}

/// Names for a line of help: `a`, `b` and `c`, so many of them.
pub(crate) fn list<'n>(names: impl IntoIterator<Item = &'n str>) -> String {
    let mut names = names.into_iter();
    let shown: Vec<String> = names.by_ref().take(LISTED_NAMES).map(quoted).collect();
    let more = names.count();
    match (&shown[..], more) {
        ([], _) => "none".to_owned(),
        ([one], 0) => one.clone(),
        ([most @ .., last], 0) => format!("{} and {last}", most.join(", ")),
        _ => format!("{} and {more} more", shown.join(", ")),
    }
}

impl Diagnostic {
    /// Adds the suggestion to write another name in place of the one at a place, with what XML asks for in it.
    #[must_use]
    pub(crate) fn replace(self, written: &str, at: Location, meant: &str) -> Self {
        self.suggest(replacing(written, meant), at, escaped(meant))
    }
}
