//! Texts as values of records, which are copied and allocate nothing.

use std::collections::HashSet;
use std::fmt;
use std::sync::{Mutex, PoisonError};

use crate::Value;

/// The number of bytes of a text that a value holds by itself.
const SHORT: usize = 22;

/// The number of bytes of all longer texts that are kept.
const KEPT: usize = 4 << 20;

/// The end of a text that was cut.
const CUT: &str = "…";

/// A text of at most 22 bytes, in place.
#[derive(Clone, Copy)]
pub struct ShortText {
    length: u8,
    bytes: [u8; SHORT],
}

impl ShortText {
    /// The text, if it is short enough.
    fn of(text: &str) -> Option<ShortText> {
        let mut bytes = [0; SHORT];
        bytes.get_mut(..text.len())?.copy_from_slice(text.as_bytes());
        Some(ShortText { length: text.len() as u8, bytes })
    }

    /// The beginning of a text.
    fn cut(text: &str) -> ShortText {
        let end = (0..=SHORT - CUT.len()).rev().find(|end| text.is_char_boundary(*end)).unwrap_or(0);
        let mut bytes = [0; SHORT];
        bytes[..end].copy_from_slice(&text.as_bytes()[..end]);
        bytes[end..end + CUT.len()].copy_from_slice(CUT.as_bytes());
        ShortText { length: (end + CUT.len()) as u8, bytes }
    }

    /// The text.
    pub fn as_str(&self) -> &str {
        let bytes = self.bytes.get(..usize::from(self.length)).unwrap_or_default();
        // Both constructors copy whole characters.
        std::str::from_utf8(bytes).unwrap_or_default()
    }
}

impl fmt::Debug for ShortText {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.as_str().fmt(formatter)
    }
}

/// The value of a text: a short one holds it. Of longer ones each is kept once, for as long as the program runs, until
/// all together are too long: then further ones are cut.
pub(super) fn value_of(text: &str) -> Value {
    match ShortText::of(text) {
        Some(short) => Value::Text(short),
        None => kept(text).map_or_else(|| Value::Text(ShortText::cut(text)), Value::Word),
    }
}

/// A text in its one copy; `None` where too much is kept already.
pub(crate) fn kept(text: &str) -> Option<&'static str> {
    static TEXTS: Mutex<Option<Texts>> = Mutex::new(None);
    let mut texts = TEXTS.lock().unwrap_or_else(PoisonError::into_inner);
    texts.get_or_insert_default().keep(text, KEPT)
}

#[derive(Default)]
struct Texts {
    known: HashSet<&'static str>,
    bytes: usize,
}

impl Texts {
    fn keep(&mut self, text: &str, most: usize) -> Option<&'static str> {
        if let Some(known) = self.known.get(text) {
            return Some(known);
        }
        self.bytes = self.bytes.checked_add(text.len()).filter(|bytes| *bytes <= most)?;
        let copy: &'static str = Box::leak(Box::from(text));
        self.known.insert(copy);
        Some(copy)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_are_whole_where_they_can_be_kept_and_cut_at_a_character_otherwise() {
        assert_eq!(ShortText::of("").unwrap().as_str(), "");
        assert_eq!(ShortText::of(&"a".repeat(22)).unwrap().as_str(), "a".repeat(22));
        assert!(ShortText::of(&"a".repeat(23)).is_none());
        assert_eq!(ShortText::cut(&"ä".repeat(12)).as_str(), format!("{}…", "ä".repeat(9)));
        let long = "the controller does not answer".to_owned();
        assert!(matches!(value_of(&long), Value::Word(word) if word == long));
        let mut texts = Texts::default();
        let first = texts.keep(&long, 50).unwrap();
        assert!(std::ptr::eq(first, texts.keep(&long.clone(), 50).unwrap()), "once");
        assert_eq!(texts.keep("one that is as long as the other", 50), None);
        assert!(texts.keep(&long, 50).is_some(), "what is kept stays");
    }
}
