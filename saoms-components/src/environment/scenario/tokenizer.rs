use std::ops::Range;

use saoms_api::rule::nearest;

use crate::text::{TextFault, bytes};

/// Tokenizer of a scenario line.
pub(super) struct Tokenizer<'a> {
    text: &'a str,
    line: &'a str,
    words: Vec<&'a str>,
    at: usize,
}

/// Separator of the two ends of a range.
const DOTS: &str = "..";

impl<'a> Tokenizer<'a> {
    /// The words of a line of the text. A block such as `(3, 1)` is one word, and so are dots
    /// in a row: in `2s...4s` the third one is no start of `.4s`.
    pub(super) fn of(text: &'a str, line: &'a str) -> Tokenizer<'a> {
        let (mut words, mut rest) = (Vec::new(), line.trim_start());
        while !rest.is_empty() {
            let length = if rest.starts_with(DOTS) {
                rest.len() - rest.trim_start_matches('.').len()
            } else if rest.starts_with('(') {
                rest.find(')').map_or(rest.len(), |end| end + 1)
            } else {
                let end = rest.find(|sign: char| sign.is_whitespace() || sign == '(').unwrap_or(rest.len());
                rest[..end].find(DOTS).unwrap_or(end)
            };
            words.push(rest[..length].trim_end());
            rest = rest[length..].trim_start();
        }
        Tokenizer { text, line, words, at: 0 }
    }

    pub(super) fn peek(&self) -> Option<&'a str> {
        self.words.get(self.at).copied()
    }

    /// The word after the next one.
    pub(super) fn peek_second(&self) -> Option<&'a str> {
        self.words.get(self.at + 1).copied()
    }

    /// Byte of the line at which the next word ends.
    pub(super) fn end_of_next(&self) -> usize {
        self.peek().map_or(self.line.len(), |word| bytes(self.line, word).end)
    }

    /// Takes the next word if it equals `word`.
    pub(super) fn take(&mut self, word: &str) -> bool {
        let is_next = self.peek() == Some(word);
        self.at += usize::from(is_next);
        is_next
    }

    /// Takes the separator of a range if it is next. More than two dots are a fault.
    pub(super) fn take_dots(&mut self) -> Result<bool, TextFault> {
        match self.peek() {
            Some(word) if word.len() > DOTS.len() && word.starts_with(DOTS) => {
                Err(self.wrong(word, "`..` between the two ends of a range").instead(Some(DOTS)))
            }
            _ => Ok(self.take(DOTS)),
        }
    }

    /// Takes the next word, or reports what was expected there.
    pub(super) fn next(&mut self, expected: &str) -> Result<&'a str, TextFault> {
        let word = self.peek().ok_or_else(|| self.missing(expected))?;
        self.at += 1;
        Ok(word)
    }

    /// Takes the next word if it is one of these.
    pub(super) fn one_of(&mut self, known: &[&'static str], expected: &str) -> Result<&'static str, TextFault> {
        let word = self.next(expected)?;
        known
            .iter()
            .copied()
            .find(|known| *known == word)
            .ok_or_else(|| self.wrong(word, expected).instead(nearest(word, known.iter().copied())))
    }

    /// The rest of the line from a word on.
    pub(super) fn rest(&self, word: &str) -> &'a str {
        &self.line[bytes(self.line, word).start..]
    }

    /// The line up to a word.
    pub(super) fn before(&self, word: &str) -> &'a str {
        &self.line[..bytes(self.line, word).start]
    }

    /// Takes all words that are left.
    pub(super) fn skip_rest(&mut self) {
        self.at = self.words.len();
    }

    /// Byte range of a word in the text.
    pub(super) fn bytes(&self, word: &str) -> Range<usize> {
        bytes(self.text, word)
    }

    /// The text of a byte range.
    pub(super) fn text(&self, bytes: &Range<usize>) -> &'a str {
        &self.text[bytes.clone()]
    }

    /// The text from the start of one word to the end of another.
    pub(super) fn span(&self, first: &str, last: &str) -> &'a str {
        &self.text[self.bytes(first).start..self.bytes(last).end]
    }

    /// The word that was taken last.
    pub(super) fn last(&self) -> &'a str {
        self.at.checked_sub(1).and_then(|last| self.words.get(last).copied()).unwrap_or(self.line)
    }

    /// A fault: another word was expected.
    pub(super) fn wrong(&self, word: &str, expected: &str) -> TextFault {
        self.fault(word, format!("found `{word}`, expected {expected}"))
    }

    /// A fault in a word.
    pub(super) fn fault(&self, word: &str, message: impl Into<String>) -> TextFault {
        TextFault::new(self.bytes(word), message)
    }

    /// A fault: the line ends where something was expected.
    pub(super) fn missing(&self, expected: &str) -> TextFault {
        let end = self.bytes(self.line.trim_end()).end;
        TextFault::new(end..end, format!("found the end of the line, expected {expected}"))
    }
}
