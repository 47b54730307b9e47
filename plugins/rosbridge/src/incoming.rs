//! The end of a WebSocket that is read.

use std::io::{self, Read};

use crate::socket::{BINARY, CLOSE, CONTINUATION, PING, PONG, TEXT};

/// Bytes of a message, at most.
pub(crate) const LONGEST: usize = 16 << 20;
/// The same of a sign of life or an end.
const LONGEST_OF_CONTROL: u64 = 125;

/// What comes from the other end.
#[derive(Debug, PartialEq, Eq)]
pub(crate) enum Said {
    Text(String),
    /// A sign of life, to be answered.
    Ping(Vec<u8>),
    /// Nothing that matters.
    Nothing,
    End,
}

/// Reads frames, and makes messages of them.
pub(crate) struct Incoming<R> {
    from: R,
    /// True for a server, whose clients have to mask.
    is_masked: bool,
    /// What there is of a message.
    parts: Option<Vec<u8>>,
}

fn wrong(text: &str) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, text)
}

impl<R: Read> Incoming<R> {
    pub(crate) fn new(from: R, is_masked: bool) -> Incoming<R> {
        Incoming { from, is_masked, parts: None }
    }

    fn bytes<const N: usize>(&mut self) -> io::Result<[u8; N]> {
        let mut bytes = [0; N];
        self.from.read_exact(&mut bytes)?;
        Ok(bytes)
    }

    /// Waits for the next frame.
    ///
    /// # Errors
    /// The connection is broken or quiet, or the other end does not speak WebSocket.
    pub(crate) fn next(&mut self) -> io::Result<Said> {
        let [first, second] = self.bytes()?;
        let (is_last, kind) = (first & 0x80 != 0, first & 0x0f);
        if first & 0x70 != 0 {
            return Err(wrong("a frame has an extension that was not agreed on"));
        }
        if (second & 0x80 != 0) != self.is_masked {
            return Err(wrong("a frame of a client is not masked, or one of a server is"));
        }
        let length = match second & 0x7f {
            126 => u64::from(u16::from_be_bytes(self.bytes()?)),
            127 => u64::from_be_bytes(self.bytes()?),
            length => u64::from(length),
        };
        let is_control = kind >= CLOSE;
        let before = self.parts.as_ref().map_or(0, Vec::len);
        if is_control && (length > LONGEST_OF_CONTROL || !is_last) || length > (LONGEST - before) as u64 {
            return Err(wrong("a message is too long"));
        }
        let mask = if self.is_masked { self.bytes()? } else { [0; 4] };
        let mut content = Vec::new();
        (&mut self.from).take(length).read_to_end(&mut content)?;
        if content.len() as u64 != length {
            return Err(io::ErrorKind::UnexpectedEof.into());
        }
        content.iter_mut().zip(mask.iter().cycle()).for_each(|(byte, mask)| *byte ^= mask);
        match kind {
            CLOSE => return Ok(Said::End),
            PING => return Ok(Said::Ping(content)),
            PONG => return Ok(Said::Nothing),
            BINARY => return Err(wrong("a message is binary, expected JSON in a text")),
            TEXT if self.parts.is_none() => self.parts = Some(content),
            CONTINUATION => match &mut self.parts {
                Some(parts) => parts.extend_from_slice(&content),
                None => return Err(wrong("a message has no beginning")),
            },
            _ => return Err(wrong("a message begins within another one")),
        }
        if !is_last {
            return Ok(Said::Nothing);
        }
        let text = String::from_utf8(self.parts.take().unwrap_or_default());
        text.map(Said::Text).map_err(|_| wrong("a text is not in UTF-8"))
    }
}
