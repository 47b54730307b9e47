use super::{DecodeError, HEADER};

/// Reader of CDR from any source.
#[derive(Clone, Debug)]
pub struct Reader<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Reader<'a> {
    /// A reader that has read the header.
    ///
    /// # Errors
    /// There is no header, or one of another encoding.
    pub fn new(bytes: &'a [u8]) -> Result<Reader<'a>, DecodeError> {
        match bytes {
            // The last two bytes are options that plain CDR does not use.
            [0, 1, _, _, ..] => Ok(Reader { bytes, at: HEADER.len() }),
            [first, second, _, _, ..] => Err(DecodeError::new(
                format!("found the header {first:02x} {second:02x}, expected 00 01 (plain CDR, little endian)"),
                0,
            )),
            _ => Err(DecodeError::new(
                format!("found {} bytes, expected at least the header of {}", bytes.len(), HEADER.len()),
                0,
            )),
        }
    }

    /// The number of the next byte, the header included.
    pub const fn offset(&self) -> usize {
        self.at
    }

    /// Number of bytes left.
    pub const fn remaining(&self) -> usize {
        self.bytes.len() - self.at
    }

    /// Reads a number of 1, 2, 4 or 8 bytes, in little endian, at its alignment.
    ///
    /// # Errors
    /// There are not enough bytes.
    #[inline]
    pub fn scalar<const SIZE: usize>(&mut self) -> Result<[u8; SIZE], DecodeError> {
        self.align(SIZE);
        match self.bytes.get(self.at..).and_then(|rest| rest.first_chunk::<SIZE>()) {
            Some(value) => {
                self.at += SIZE;
                Ok(*value)
            }
            None => Err(self.too_short(SIZE)),
        }
    }

    /// Reads numbers of one size that stand side by side. The caller has their number from [`length`](Reader::length).
    ///
    /// # Errors
    /// There are not enough bytes.
    pub fn scalars<const SIZE: usize, T>(
        &mut self,
        count: usize,
        from_bytes: impl Fn([u8; SIZE]) -> T,
    ) -> Result<Vec<T>, DecodeError> {
        if count == 0 {
            return Ok(Vec::new());
        }
        self.align(SIZE);
        let size = count.saturating_mul(SIZE);
        let bytes = self.take(size)?;
        Ok(bytes.as_chunks::<SIZE>().0.iter().map(|chunk| from_bytes(*chunk)).collect())
    }

    /// Reads an array of numbers of one size.
    ///
    /// # Errors
    /// There are not enough bytes.
    pub fn array<const SIZE: usize, const COUNT: usize, T>(
        &mut self,
        from_bytes: impl Fn([u8; SIZE]) -> T,
    ) -> Result<[T; COUNT], DecodeError> {
        self.align(SIZE);
        let chunks = self.take(SIZE.saturating_mul(COUNT))?.as_chunks::<SIZE>().0;
        Ok(std::array::from_fn(|place| from_bytes(chunks[place])))
    }

    /// Reads the length of a sequence whose elements have at least this size.
    ///
    /// # Errors
    /// The bytes that are left cannot hold that many elements. Checked before memory is allocated for them.
    pub fn length(&mut self, least_size: usize) -> Result<usize, DecodeError> {
        let length = u32::from_le_bytes(self.scalar()?) as usize;
        if length.saturating_mul(least_size) > self.remaining() {
            let (at, left) = (self.at - 4, self.remaining());
            return Err(DecodeError::new(format!("found the length {length}, but only {left} bytes are left"), at));
        }
        Ok(length)
    }

    /// Reads a string. A length of zero, which some writers use for the empty string, is accepted.
    ///
    /// # Errors
    /// The string is longer than the bytes that are left, does not end with NUL, or is not UTF-8.
    pub fn string(&mut self) -> Result<&'a str, DecodeError> {
        let length = self.length(1)?;
        let start = self.at;
        match self.take(length)? {
            [] => Ok(""),
            [text @ .., 0] => std::str::from_utf8(text)
                .map_err(|error| DecodeError::new("the string is not UTF-8", start + error.valid_up_to())),
            _ => Err(DecodeError::new("the string does not end with NUL", self.at - 1)),
        }
    }

    /// Checks that everything was read.
    ///
    /// # Errors
    /// There are bytes left.
    pub fn finish(&self) -> Result<(), DecodeError> {
        match self.remaining() {
            0 => Ok(()),
            left => Err(DecodeError::new(format!("found {left} more bytes, expected the end"), self.at)),
        }
    }

    fn take(&mut self, size: usize) -> Result<&'a [u8], DecodeError> {
        match self.bytes.get(self.at..).and_then(|rest| rest.get(..size)) {
            Some(bytes) => {
                self.at += size;
                Ok(bytes)
            }
            None => Err(self.too_short(size)),
        }
    }

    #[inline]
    fn align(&mut self, size: usize) {
        let padding = HEADER.len().wrapping_sub(self.at) & (size - 1);
        // Padding beyond the end shows when the value behind it is read.
        self.at = (self.at + padding).min(self.bytes.len());
    }

    #[cold]
    fn too_short(&self, size: usize) -> DecodeError {
        let left = self.remaining();
        DecodeError::new(format!("found {left} more bytes, expected {size}"), self.at)
    }
}
