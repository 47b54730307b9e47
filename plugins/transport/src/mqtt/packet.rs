//! Packets of MQTT 5: how long they are, and what is in them.

use std::io::{Read, Take};

use crate::language::Ended;

/// Longest packet: four bytes of seven bits, but not more than a message of the boundary with its attachment.
pub(super) const LONGEST: usize = 128 << 20;
/// The property of a name and a value.
pub(super) const USER_PROPERTY: u8 = 0x26;

/// A packet of the broker.
#[derive(Debug)]
pub(super) struct Packet {
    head: u8,
    body: Vec<u8>,
}

/// The kind of a packet, as far as it matters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// A message; one that was sent above quality of service 0 has a number.
    Publish {
        has_number: bool,
    },
    PublishAck,
    SubscribeAck,
    Disconnect,
    Other,
}

/// What matters of properties.
#[derive(Debug, Default)]
pub(super) struct Properties {
    /// The length of what is said beside a message.
    pub(super) beside: usize,
    /// The longest packet that the broker takes.
    pub(super) longest: Option<usize>,
    pub(super) has_no_wildcards: bool,
    pub(super) has_quality_0_alone: bool,
}

impl Packet {
    pub(super) fn read(from: &mut impl Read) -> Result<Packet, Ended> {
        let mut head = [0];
        from.read_exact(&mut head)?;
        let mut length = 0;
        for place in 0.. {
            let mut byte = [0];
            from.read_exact(&mut byte)?;
            length |= usize::from(byte[0] & 0x7f) << (7 * place);
            match byte[0] {
                0..0x80 => break,
                _ if place == 3 => return Err(Ended::malformed("a length has five bytes")),
                _ => {}
            }
        }
        if length > LONGEST {
            return Err(Ended::malformed("a packet is too long"));
        }
        // The memory for it comes with its bytes.
        let mut body = Vec::new();
        let mut limited: Take<_> = from.take(length as u64);
        limited.read_to_end(&mut body)?;
        if body.len() < length {
            return Err(std::io::Error::from(std::io::ErrorKind::UnexpectedEof).into());
        }
        Ok(Packet { head: head[0], body })
    }

    pub(super) fn kind(&self) -> Kind {
        match self.head >> 4 {
            3 => Kind::Publish { has_number: self.head & 0x06 != 0 },
            4 => Kind::PublishAck,
            9 => Kind::SubscribeAck,
            14 => Kind::Disconnect,
            _ => Kind::Other,
        }
    }

    pub(super) fn body(&self) -> Rest<'_> {
        Rest(&self.body)
    }
}

/// What is left of a packet.
#[derive(Debug)]
pub(super) struct Rest<'a>(&'a [u8]);

impl<'a> Rest<'a> {
    fn bytes(&mut self, count: usize) -> Result<&'a [u8], Ended> {
        let (bytes, rest) =
            self.0.split_at_checked(count).ok_or_else(|| Ended::malformed("a packet ends too early"))?;
        self.0 = rest;
        Ok(bytes)
    }

    pub(super) fn rest(self) -> &'a [u8] {
        self.0
    }

    pub(super) fn skip(&mut self, count: usize) -> Result<(), Ended> {
        self.bytes(count).map(|_| ())
    }

    pub(super) fn byte(&mut self) -> Result<u8, Ended> {
        Ok(self.bytes(1)?[0])
    }

    fn number(&mut self, count: usize) -> Result<usize, Ended> {
        Ok(self.bytes(count)?.iter().fold(0, |all, byte| all << 8 | usize::from(*byte)))
    }

    fn variable(&mut self) -> Result<usize, Ended> {
        let mut value = 0;
        for place in 0..4 {
            let byte = self.byte()?;
            value |= usize::from(byte & 0x7f) << (7 * place);
            if byte < 0x80 {
                return Ok(value);
            }
        }
        Err(Ended::malformed("a length has five bytes"))
    }

    pub(super) fn text(&mut self) -> Result<&'a str, Ended> {
        let length = self.number(2)?;
        std::str::from_utf8(self.bytes(length)?).map_err(|_| Ended::malformed("a text is not in UTF-8"))
    }

    pub(super) fn properties(&mut self) -> Result<Properties, Ended> {
        // A packet that ends here has none, as those of earlier versions.
        if self.0.is_empty() {
            return Ok(Properties::default());
        }
        let length = self.variable()?;
        let mut rest = Rest(self.bytes(length)?);
        let mut found = Properties::default();
        while !rest.0.is_empty() {
            match rest.byte()? {
                0x24 => found.has_quality_0_alone = rest.byte()? == 0,
                0x28 => found.has_no_wildcards = rest.byte()? == 0,
                0x27 => found.longest = Some(rest.number(4)?),
                USER_PROPERTY => {
                    let (name, value) = (rest.text()?, rest.text()?);
                    if name == super::BESIDE {
                        found.beside = value.parse().map_err(|_| Ended::malformed("`saoms` is no number"))?;
                    }
                }
                0x01 | 0x17 | 0x19 | 0x25 | 0x29 | 0x2a => rest.skip(1)?,
                0x13 | 0x21 | 0x22 | 0x23 => rest.skip(2)?,
                0x02 | 0x11 | 0x18 => rest.skip(4)?,
                0x0b => _ = rest.variable()?,
                0x03 | 0x08 | 0x09 | 0x12 | 0x15 | 0x16 | 0x1a | 0x1c | 0x1f => {
                    let length = rest.number(2)?;
                    rest.skip(length)?;
                }
                _ => return Err(Ended::malformed("a property is not known")),
            }
        }
        Ok(found)
    }
}

/// Appends a text with its length, which fits.
pub(super) fn text(to: &mut Vec<u8>, text: &str) {
    let text = &text.as_bytes()[..text.len().min(usize::from(u16::MAX))];
    to.extend(u16::try_from(text.len()).unwrap_or(u16::MAX).to_be_bytes());
    to.extend_from_slice(text);
}

/// Appends a length of up to four bytes.
pub(super) fn variable(to: &mut Vec<u8>, mut value: usize) {
    loop {
        let low = (value & 0x7f) as u8;
        value >>= 7;
        if value == 0 {
            return to.push(low);
        }
        to.push(low | 0x80);
    }
}

/// A packet.
pub(super) fn framed(head: u8, body: &[u8]) -> Vec<u8> {
    let mut all = vec![head];
    variable(&mut all, body.len());
    all.extend_from_slice(body);
    all
}
