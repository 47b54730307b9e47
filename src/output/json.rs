//! JSON that steers no terminal: what is invisible in a text stands there as an escape, which is the same JSON.

use std::io::{self, Write};

use saoms_api::host::is_invisible;
use serde::Serialize;

/// Writes data as JSON for programs and people, in lines.
///
/// # Errors
/// It cannot be written.
pub(crate) fn json(output: &mut (impl Write + ?Sized), value: &impl Serialize) -> io::Result<()> {
    serde_json::to_writer_pretty(Escaping(&mut *output), value)?;
    output.write_all(b"\n")
}

/// Writes data as JSON in one line.
///
/// # Errors
/// It cannot be written.
pub(crate) fn json_line(output: &mut (impl Write + ?Sized), value: &impl Serialize) -> io::Result<()> {
    serde_json::to_writer(Escaping(&mut *output), value)?;
    output.write_all(b"\n")
}

/// Escapes characters of JSON that are written in pieces of whole characters. Those beyond ASCII are in strings alone,
/// and below it `serde_json` escapes all but DEL itself.
struct Escaping<W>(W);

impl<W: Write> Write for Escaping<W> {
    fn write(&mut self, piece: &[u8]) -> io::Result<usize> {
        self.write_all(piece)?;
        Ok(piece.len())
    }

    fn write_all(&mut self, piece: &[u8]) -> io::Result<()> {
        let steers = |character: char| is_invisible(character) && character != '\n';
        let Some(text) = str::from_utf8(piece).ok().filter(|text| text.contains(steers)) else {
            return self.0.write_all(piece);
        };
        for part in text.split_inclusive(steers) {
            let last = part.chars().next_back().filter(|last| steers(*last));
            self.0.write_all(&part.as_bytes()[..part.len() - last.map_or(0, char::len_utf8)])?;
            if let Some(last) = last {
                let mut units = [0; 2];
                last.encode_utf16(&mut units).iter().try_for_each(|unit| write!(self.0, "\\u{unit:04x}"))?;
            }
        }
        Ok(())
    }

    fn flush(&mut self) -> io::Result<()> {
        self.0.flush()
    }
}

#[cfg(test)]
mod tests {
    use serde_json::{Value, json};

    #[test]
    fn what_steers_is_escaped_and_nothing_is_lost() {
        let value = json!({ "a\u{202e}b": ["\u{1b}[2J", "\u{9b}\u{7f}é\u{feff}", "plain\n\"Ü\" 🤖"] });
        let mut written = Vec::new();
        super::json(&mut written, &value).unwrap();
        let text = String::from_utf8(written).unwrap();
        let expected = "{\n  \"a\\u202eb\": [\n    \"\\u001b[2J\",\n    \"\\u009b\\u007fé\\ufeff\",\n    \"plain\\n\\\"Ü\\\" 🤖\"\n  ]\n}\n";
        assert_eq!(text, expected);
        assert_eq!(serde_json::from_str::<Value>(&text).unwrap(), value);
    }
}
