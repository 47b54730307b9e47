//! Frames of STOMP 1.2: a command, headers, and a body that a zero byte ends.

use std::io::{BufRead, ErrorKind, Read};

use crate::language::Ended;

/// Longest body: that of a message of the boundary with its attachment.
pub(super) const LONGEST: usize = 128 << 20;
/// Longest head.
const LONGEST_HEAD: usize = 64 << 10;

/// A frame of the broker.
#[derive(Debug)]
pub(super) struct Frame {
    command: String,
    /// The headers as they stand there.
    headers: Vec<(String, String)>,
    body: Vec<u8>,
}

impl Frame {
    /// Reads the next frame; the signs of life before it are passed over.
    pub(super) fn read(from: &mut impl BufRead) -> Result<Frame, Ended> {
        let mut left = LONGEST_HEAD;
        let mut command = line(from, &mut left)?;
        while command.is_empty() {
            left = LONGEST_HEAD;
            command = line(from, &mut left)?;
        }
        let mut headers = Vec::new();
        loop {
            let line = line(from, &mut left)?;
            if line.is_empty() {
                break;
            }
            let (name, value) = line.split_once(':').ok_or_else(|| Ended::malformed("a header has no `:`"))?;
            headers.push((name.to_owned(), value.to_owned()));
        }
        let mut frame = Frame { command, headers, body: Vec::new() };
        match frame.header("content-length") {
            Some(length) => {
                let length = length.parse::<usize>().ok().filter(|length| *length <= LONGEST);
                let length = length.ok_or_else(|| Ended::malformed("a frame has no good length"))?;
                // The memory for it comes with its bytes.
                from.by_ref().take(length as u64).read_to_end(&mut frame.body)?;
                let mut end = [1];
                from.read_exact(&mut end)?;
                if end != [0] {
                    return Err(Ended::malformed("a frame goes on behind its length"));
                }
            }
            None => {
                from.by_ref().take(LONGEST as u64).read_until(0, &mut frame.body)?;
                if frame.body.pop() != Some(0) {
                    return Err(early());
                }
            }
        }
        Ok(frame)
    }

    pub(super) fn command(&self) -> &str {
        &self.command
    }

    /// A header; of several with one name, the first one.
    pub(super) fn header(&self, name: &str) -> Option<String> {
        let (_, value) = self.headers.iter().find(|(known, _)| known == name)?;
        let mut plain = String::with_capacity(value.len());
        let mut rest = value.chars();
        while let Some(one) = rest.next() {
            match one {
                '\\' => plain.push(match rest.next()? {
                    'n' => '\n',
                    'r' => '\r',
                    'c' => ':',
                    '\\' => '\\',
                    _ => return None,
                }),
                one => plain.push(one),
            }
        }
        Some(plain)
    }

    pub(super) fn into_body(self) -> Vec<u8> {
        self.body
    }

    /// The reason that an error has, in one line for people.
    pub(super) fn why(&self) -> String {
        let text = self.header("message").unwrap_or_else(|| String::from_utf8_lossy(&self.body).into_owned());
        let line = text.lines().find(|line| !line.trim().is_empty()).unwrap_or("it gives no reason");
        line.trim().chars().filter(|one| !one.is_control()).take(200).collect()
    }
}

/// A line without its end.
fn line(from: &mut impl BufRead, left: &mut usize) -> Result<String, Ended> {
    let mut line = Vec::new();
    let count = from.by_ref().take(*left as u64).read_until(b'\n', &mut line)?;
    *left -= count;
    if line.pop() != Some(b'\n') {
        return Err(if *left == 0 { Ended::malformed("a head is too long") } else { early() });
    }
    if line.last() == Some(&b'\r') {
        line.pop();
    }
    String::from_utf8(line).map_err(|_| Ended::malformed("a head is not in UTF-8"))
}

/// The connection ends within a frame.
fn early() -> Ended {
    Ended::Broken(ErrorKind::UnexpectedEof.into())
}
