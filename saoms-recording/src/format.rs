//! The format of the files: MCAP, <https://mcap.dev/spec>. A file is a row of records, each an operation, the length of
//! its content and that; the content has numbers in little endian, and texts, maps and bytes with their lengths.

use std::collections::BTreeMap;
use std::io::{self, Read, Write};

use lz4_flex::frame::{FrameDecoder, FrameEncoder};

/// Begin and end of each file.
pub(crate) const MAGIC: &[u8; 8] = b"\x89MCAP0\r\n";
/// The compression of chunks that this program writes.
pub(crate) const LZ4: &str = "lz4";
/// No record is larger: what says so is damaged.
pub(crate) const LARGEST: u64 = 1 << 30;

/// The operations.
pub(crate) mod op {
    pub(crate) const HEADER: u8 = 1;
    pub(crate) const FOOTER: u8 = 2;
    pub(crate) const SCHEMA: u8 = 3;
    pub(crate) const CHANNEL: u8 = 4;
    pub(crate) const MESSAGE: u8 = 5;
    pub(crate) const CHUNK: u8 = 6;
    pub(crate) const MESSAGE_INDEX: u8 = 7;
    pub(crate) const CHUNK_INDEX: u8 = 8;
    pub(crate) const ATTACHMENT: u8 = 9;
    pub(crate) const ATTACHMENT_INDEX: u8 = 10;
    pub(crate) const STATISTICS: u8 = 11;
    pub(crate) const METADATA: u8 = 12;
    pub(crate) const METADATA_INDEX: u8 = 13;
    pub(crate) const SUMMARY_OFFSET: u8 = 14;
    pub(crate) const DATA_END: u8 = 15;
}

/// Bytes to which records are written.
pub(crate) trait Put {
    fn number16(&mut self, number: u16);
    fn number32(&mut self, number: u32);
    fn number64(&mut self, number: u64);
    /// Bytes with a length of 32 bits.
    fn sized(&mut self, bytes: &[u8]);
    fn map(&mut self, map: &BTreeMap<String, String>);
    /// A record.
    fn record(&mut self, operation: u8, write: impl FnOnce(&mut Vec<u8>));
}

impl Put for Vec<u8> {
    fn number16(&mut self, number: u16) {
        self.extend_from_slice(&number.to_le_bytes());
    }

    fn number32(&mut self, number: u32) {
        self.extend_from_slice(&number.to_le_bytes());
    }

    fn number64(&mut self, number: u64) {
        self.extend_from_slice(&number.to_le_bytes());
    }

    fn sized(&mut self, bytes: &[u8]) {
        self.number32(bytes.len() as u32);
        self.extend_from_slice(bytes);
    }

    fn map(&mut self, map: &BTreeMap<String, String>) {
        let mut content = Vec::new();
        for text in map.iter().flat_map(|(name, value)| [name, value]) {
            content.sized(text.as_bytes());
        }
        self.sized(&content);
    }

    fn record(&mut self, operation: u8, write: impl FnOnce(&mut Vec<u8>)) {
        self.push(operation);
        let start = self.len();
        self.number64(0);
        write(self);
        let length = (self.len() - start - 8) as u64;
        self[start..start + 8].copy_from_slice(&length.to_le_bytes());
    }
}

/// The content of a record, from which is read; `None` where it is too short.
pub(crate) struct Take<'a>(pub(crate) &'a [u8]);

impl<'a> Take<'a> {
    fn array<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (first, rest) = self.0.split_first_chunk::<N>()?;
        self.0 = rest;
        Some(*first)
    }

    pub(crate) fn number8(&mut self) -> Option<u8> {
        self.array().map(u8::from_le_bytes)
    }

    pub(crate) fn number16(&mut self) -> Option<u16> {
        self.array().map(u16::from_le_bytes)
    }

    pub(crate) fn number32(&mut self) -> Option<u32> {
        self.array().map(u32::from_le_bytes)
    }

    pub(crate) fn number64(&mut self) -> Option<u64> {
        self.array().map(u64::from_le_bytes)
    }

    pub(crate) fn bytes(&mut self, count: u64) -> Option<&'a [u8]> {
        let (found, rest) = self.0.split_at_checked(usize::try_from(count).ok()?)?;
        self.0 = rest;
        Some(found)
    }

    /// Bytes with a length of 32 bits.
    pub(crate) fn sized(&mut self) -> Option<&'a [u8]> {
        let count = self.number32()?;
        self.bytes(count.into())
    }

    pub(crate) fn text(&mut self) -> Option<String> {
        String::from_utf8(self.sized()?.to_vec()).ok()
    }

    pub(crate) fn map(&mut self) -> Option<BTreeMap<String, String>> {
        let mut content = Take(self.sized()?);
        let mut map = BTreeMap::new();
        while !content.0.is_empty() {
            let (name, value) = (content.text()?, content.text()?);
            map.insert(name, value);
        }
        Some(map)
    }

    /// The next record.
    pub(crate) fn record(&mut self) -> Option<(u8, &'a [u8])> {
        let operation = self.number8()?;
        let length = self.number64()?;
        Some((operation, self.bytes(length)?))
    }
}

/// Bytes as a frame of LZ4.
pub(crate) fn compressed(bytes: &[u8]) -> io::Result<Vec<u8>> {
    let mut encoder = FrameEncoder::new(Vec::with_capacity(bytes.len() / 2));
    encoder.write_all(bytes)?;
    encoder.finish().map_err(io::Error::other)
}

/// The bytes of a frame of LZ4, of which there are so many.
pub(crate) fn decompressed(frame: &[u8], count: u64) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    FrameDecoder::new(frame).take(count.saturating_add(1)).read_to_end(&mut bytes)?;
    if bytes.len() as u64 == count { Ok(bytes) } else { Err(io::ErrorKind::InvalidData.into()) }
}

/// The checksum of bytes: CRC-32, as Ethernet has it.
pub(crate) fn checksum(bytes: &[u8]) -> u32 {
    const TABLE: [u32; 256] = {
        let mut table = [0; 256];
        let mut place = 0;
        while place < 256 {
            let mut value = place as u32;
            let mut bit = 0;
            while bit < 8 {
                value = if value & 1 == 1 { value >> 1 ^ 0xEDB8_8320 } else { value >> 1 };
                bit += 1;
            }
            table[place] = value;
            place += 1;
        }
        table
    };
    !bytes.iter().fold(u32::MAX, |sum, byte| sum >> 8 ^ TABLE[((sum ^ u32::from(*byte)) & 0xFF) as usize])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn checksums_are_those_of_ethernet() {
        assert_eq!(checksum(b"123456789"), 0xCBF4_3926);
    }

    #[test]
    fn what_is_compressed_comes_back() {
        let bytes = b"robot 1 robot 2 robot 3 ".repeat(10_000);
        let frame = compressed(&bytes).unwrap();
        assert!(frame.len() < bytes.len() / 10);
        assert_eq!(decompressed(&frame, bytes.len() as u64).unwrap(), bytes);
        assert!(decompressed(&frame, 7).is_err() && decompressed(&frame[..40], bytes.len() as u64).is_err());
    }
}
