use std::fmt::{self, Write};

/// A text that is put together while the program is compiled, as a tree: parts can come from constants of other types.
#[derive(Clone, Copy, Debug)]
pub enum ConstText {
    /// As it stands.
    Plain(&'static str),
    /// As a JSON string: in quotation marks, with escapes.
    Quoted(&'static str),
    /// As decimal digits.
    Number(usize),
    /// One after the other.
    Joined(&'static [ConstText]),
}

impl ConstText {
    /// No text.
    pub const EMPTY: ConstText = ConstText::Plain("");

    /// Its length in bytes.
    pub const fn length(self) -> usize {
        match self {
            ConstText::Plain(text) => text.len(),
            ConstText::Quoted(text) => {
                let (bytes, mut at, mut length) = (text.as_bytes(), 0, 2);
                while at < bytes.len() {
                    length += escape(bytes[at]).1;
                    at += 1;
                }
                length
            }
            ConstText::Number(number) => digits(number).1,
            ConstText::Joined(parts) => {
                let (mut at, mut length) = (0, 0);
                while at < parts.len() {
                    length += parts[at].length();
                    at += 1;
                }
                length
            }
        }
    }

    /// Its bytes; `N` has to be its [`length`](ConstText::length).
    pub const fn bytes<const N: usize>(self) -> [u8; N] {
        let mut bytes = [0; N];
        let end = self.put(&mut bytes, 0);
        assert!(end == N, "N has to be the length of the text");
        bytes
    }

    const fn put(self, bytes: &mut [u8], start: usize) -> usize {
        match self {
            ConstText::Plain(text) => copy(text.as_bytes(), text.len(), bytes, start),
            ConstText::Quoted(text) => {
                let mut end = copy(b"\"", 1, bytes, start);
                let mut at = 0;
                while at < text.len() {
                    let (escaped, length) = escape(text.as_bytes()[at]);
                    end = copy(&escaped, length, bytes, end);
                    at += 1;
                }
                copy(b"\"", 1, bytes, end)
            }
            ConstText::Number(number) => {
                let (digits, length) = digits(number);
                copy(digits.split_at(digits.len() - length).1, length, bytes, start)
            }
            ConstText::Joined(parts) => {
                let (mut at, mut end) = (0, start);
                while at < parts.len() {
                    end = parts[at].put(bytes, end);
                    at += 1;
                }
                end
            }
        }
    }
}

impl fmt::Display for ConstText {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            ConstText::Plain(text) => formatter.write_str(text),
            ConstText::Quoted(text) => {
                formatter.write_str("\"")?;
                for letter in text.chars() {
                    match u8::try_from(letter).map(escape) {
                        Ok((escaped, length)) if letter.is_ascii() => {
                            escaped[..length].iter().try_for_each(|byte| formatter.write_char(char::from(*byte)))?;
                        }
                        _ => formatter.write_char(letter)?,
                    }
                }
                formatter.write_str("\"")
            }
            ConstText::Number(number) => number.fmt(formatter),
            ConstText::Joined(parts) => parts.iter().try_for_each(|part| part.fmt(formatter)),
        }
    }
}

/// The text of bytes from [`ConstText::bytes`].
#[expect(clippy::panic, reason = "it stops the compiler, not the program: a text's bytes are UTF-8")]
pub const fn text(bytes: &'static [u8]) -> &'static str {
    match std::str::from_utf8(bytes) {
        Ok(text) => text,
        Err(_) => panic!("not the bytes of a text"),
    }
}

const fn copy(from: &[u8], length: usize, to: &mut [u8], at: usize) -> usize {
    to.split_at_mut(at).1.split_at_mut(length).0.copy_from_slice(from.split_at(length).0);
    at + length
}

/// The digits of a number at the end of the buffer, and how many they are.
const fn digits(mut number: usize) -> ([u8; 20], usize) {
    let (mut digits, mut length) = ([b'0'; 20], 0);
    while number > 0 || length == 0 {
        length += 1;
        digits[20 - length] = b'0' + (number % 10) as u8;
        number /= 10;
    }
    (digits, length)
}

pub(crate) const fn escape(byte: u8) -> ([u8; 6], usize) {
    const DIGITS: &[u8; 16] = b"0123456789abcdef";
    match byte {
        b'"' | b'\\' => ([b'\\', byte, 0, 0, 0, 0], 2),
        0..=0x1f => ([b'\\', b'u', b'0', b'0', DIGITS[(byte >> 4) as usize], DIGITS[(byte & 15) as usize]], 6),
        _ => ([byte, 0, 0, 0, 0, 0], 1),
    }
}
