//! What goes over a connection: frames with a length before each.

use std::io::{self, Read, Write};
use std::sync::Arc;

/// Longer frames end a connection: nobody sends them.
pub(crate) const LONGEST: usize = 64 << 20;

/// What one end of a connection says to the other.
#[derive(Clone, Debug)]
pub(crate) enum Frame {
    /// A message.
    Put { key: Arc<str>, message: Arc<[u8]>, attachment: Arc<[u8]> },
    /// The sender wants messages with these keys.
    Subscribe { keys: Arc<str> },
    /// The sender does not want them any more.
    Unsubscribe { keys: Arc<str> },
}

impl Frame {
    /// About as many bytes as it takes.
    pub(crate) fn size(&self) -> usize {
        64 + match self {
            Frame::Put { key, message, attachment } => key.len() + message.len() + attachment.len(),
            Frame::Subscribe { keys } | Frame::Unsubscribe { keys } => keys.len(),
        }
    }

    pub(crate) fn write(&self, out: &mut impl Write) -> io::Result<()> {
        let (kind, key, message, attachment): (u8, &str, &[u8], &[u8]) = match self {
            Frame::Put { key, message, attachment } => (0, key, message, attachment),
            Frame::Subscribe { keys } => (1, keys, &[], &[]),
            Frame::Unsubscribe { keys } => (2, keys, &[], &[]),
        };
        out.write_all(&[kind])?;
        for part in [key.as_bytes(), message, attachment] {
            out.write_all(&(part.len() as u64).to_le_bytes())?;
            out.write_all(part)?;
        }
        Ok(())
    }

    pub(crate) fn read(from: &mut impl Read) -> io::Result<Frame> {
        let mut kind = [0];
        from.read_exact(&mut kind)?;
        let mut part = || {
            let mut length = [0; 8];
            from.read_exact(&mut length)?;
            let length = usize::try_from(u64::from_le_bytes(length)).unwrap_or(usize::MAX);
            if length > LONGEST {
                return Err(io::Error::new(io::ErrorKind::InvalidData, "the frame is too long"));
            }
            let mut bytes = Vec::new();
            from.take(length as u64).read_to_end(&mut bytes)?;
            if bytes.len() == length { Ok(bytes) } else { Err(io::ErrorKind::UnexpectedEof.into()) }
        };
        let (key, message, attachment) = (part()?, part()?, part()?);
        let key = String::from_utf8(key).map_err(|error| io::Error::new(io::ErrorKind::InvalidData, error))?;
        match kind {
            [0] => Ok(Frame::Put { key: key.into(), message: message.into(), attachment: attachment.into() }),
            [1] => Ok(Frame::Subscribe { keys: key.into() }),
            [2] => Ok(Frame::Unsubscribe { keys: key.into() }),
            _ => Err(io::Error::new(io::ErrorKind::InvalidData, "this is no frame of a relay")),
        }
    }
}

/// True if a key is one of these keys, in which `*` is any one part, and `**` at the end any number of them.
pub(crate) fn fits(key: &str, keys: &str) -> bool {
    let (mut parts, mut wanted) = (key.split('/'), keys.split('/'));
    loop {
        match (parts.next(), wanted.next()) {
            (_, Some("**")) | (None, None) => return true,
            (Some(part), Some(one)) if one == "*" || one == part => {}
            _ => return false,
        }
    }
}
