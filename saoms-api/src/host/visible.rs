//! Texts of others as people may be shown them.

use std::borrow::Cow;
use std::fmt::{self, Display, Write};

/// True for a character that steers what shows it in place of being seen: control characters (C0, DEL, C1), those that
/// turn the writing direction or break lines in Unicode (UAX #9, UAX #14), marks of the byte order and others of no
/// width, and noncharacters. Joiners are no such characters: scripts and emoji need them.
pub fn is_invisible(character: char) -> bool {
    character.is_control()
        || matches!(
            character,
            '\u{ad}' | '\u{61c}' | '\u{180e}' | '\u{200b}' | '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}'
                | '\u{2060}'..='\u{2064}' | '\u{2066}'..='\u{2069}' | '\u{feff}'
                | '\u{fffe}' | '\u{ffff}'
        )
}

/// A text of somebody else on one line: what is invisible stands there as in a literal of Rust. No name can clear a
/// terminal then, turn what stands beside it around, or add a line that looks like one of the program.
///
/// ```
/// use saoms_api::host::one_line;
///
/// assert_eq!(one_line("a\n\u{1b}[2J\u{202e}b"), "a\\n\\u{1b}[2J\\u{202e}b");
/// ```
pub fn one_line(text: &str) -> Cow<'_, str> {
    if !text.contains(is_invisible) {
        return Cow::Borrowed(text);
    }
    let mut shown = String::with_capacity(text.len() + 8);
    text.chars().for_each(|character| show(character, &mut shown));
    Cow::Owned(shown)
}

/// Characters of a quotation in a message, and of what stands between two of them: about a line, and about ten.
const LONGEST: [usize; 2] = [1000, 100];

/// Shortens what a message quotes between backticks, however long it is: the whole value is at the place of the
/// message. The rest of a message is not without end either, as it may be of a plugin.
///
/// ```
/// let mut message = format!("found `{}`, expected a number", "x".repeat(1_000_000));
/// saoms_api::host::shorten(&mut message);
/// assert_eq!(message, format!("found `{}…`, expected a number", "x".repeat(100)));
/// ```
pub fn shorten(message: &mut String) {
    if message.len() <= LONGEST[1] {
        return;
    }
    let pieces = message.split('`').enumerate().map(|(place, piece)| {
        let cut = piece.char_indices().nth(LONGEST[place % 2]);
        cut.map_or(Cow::Borrowed(piece), |(end, _)| Cow::Owned(format!("{}…", &piece[..end])))
    });
    let pieces: Vec<Cow<'_, str>> = pieces.collect();
    if pieces.iter().any(|piece| matches!(piece, Cow::Owned(_))) {
        *message = pieces.join("`");
    }
}

/// The bytes of a text for people that are shown.
const MOST_SHOWN: usize = 10_000;

/// A text for people, of whatever length: what is no text is replaced, and what is beyond 10,000 bytes left out, with
/// its length.
pub fn shown(text: &[u8]) -> Cow<'_, str> {
    let Some((first, more @ [_, ..])) = text.split_at_checked(MOST_SHOWN) else {
        return String::from_utf8_lossy(text);
    };
    let first = String::from_utf8_lossy(first);
    // A character that was cut in two is left out.
    format!("{}… ({} more bytes)", first.trim_end_matches(char::REPLACEMENT_CHARACTER), more.len()).into()
}

fn show(character: char, shown: &mut String) {
    if is_invisible(character) {
        shown.extend(character.escape_default());
    } else {
        shown.push(character);
    }
}

/// A text of several lines for people: as [`one_line`], but for line ends and tabs.
#[derive(Clone, Copy, Debug)]
pub struct Visible<'a, T: ?Sized>(pub &'a T);

impl<T: Display + ?Sized> Display for Visible<'_, T> {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(Escaping(out), "{}", self.0)
    }
}

struct Escaping<'a, 'b>(&'a mut fmt::Formatter<'b>);

impl Write for Escaping<'_, '_> {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        for piece in text.split_inclusive(['\n', '\t']) {
            let end = piece.len() - usize::from(piece.ends_with(['\n', '\t']));
            self.0.write_str(&one_line(&piece[..end]))?;
            self.0.write_str(&piece[end..])?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_stay_and_all_that_steers_is_escaped() {
        let text = "a\tb\n\u{9b}c\r\u{2066}d\u{85}";
        assert_eq!(Visible(text).to_string(), "a\tb\n\\u{9b}c\\r\\u{2066}d\\u{85}");
        assert!(matches!(one_line("plain Ü 🤖"), Cow::Borrowed(_)));
    }
}
