use super::HEADER;

/// Writer of CDR.
#[derive(Clone, Debug)]
pub struct Writer {
    bytes: Vec<u8>,
}

impl Writer {
    /// A writer that has written the header.
    pub fn new() -> Writer {
        Writer::reusing(Vec::with_capacity(64))
    }

    /// The same in the memory of this buffer, whose content is replaced.
    pub fn reusing(mut bytes: Vec<u8>) -> Writer {
        bytes.clear();
        bytes.extend_from_slice(&HEADER);
        Writer { bytes }
    }

    /// The written bytes, header included.
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// The written bytes, header included.
    pub fn into_bytes(self) -> Vec<u8> {
        self.bytes
    }

    /// Writes a number of 1, 2, 4 or 8 bytes, given in little endian, at its alignment.
    #[inline]
    pub fn scalar<const SIZE: usize>(&mut self, value: [u8; SIZE]) {
        self.align(SIZE);
        self.bytes.extend_from_slice(&value);
    }

    /// Writes numbers of one size side by side.
    #[inline]
    pub fn scalars<const SIZE: usize, T: Copy>(&mut self, values: &[T], to_bytes: impl Fn(T) -> [u8; SIZE]) {
        if values.is_empty() {
            return;
        }
        self.align(SIZE);
        let start = self.bytes.len();
        self.bytes.resize(start + values.len() * SIZE, 0);
        for (place, value) in self.bytes[start..].chunks_exact_mut(SIZE).zip(values) {
            place.copy_from_slice(&to_bytes(*value));
        }
    }

    /// Writes bytes side by side.
    pub fn octets(&mut self, bytes: &[u8]) {
        self.bytes.extend_from_slice(bytes);
    }

    /// Writes the length of a string or sequence.
    ///
    /// # Panics
    /// The length needs more than 32 bits, which the encoding does not have.
    #[inline]
    pub fn length(&mut self, length: usize) {
        // The panic that is documented above: a length beyond this is a text or sequence of 4 GiB in memory, which no
        // message is meant to be.
        #[expect(clippy::expect_used, reason = "a value of 4 GiB is a fault of the program that made it")]
        let length = u32::try_from(length).expect("CDR has no strings and sequences of 2^32 elements or more");
        self.scalar(length.to_le_bytes());
    }

    /// Writes a string.
    ///
    /// # Panics
    /// As [`length`](Writer::length).
    pub fn string(&mut self, text: &str) {
        self.length(text.len() + 1);
        self.bytes.extend_from_slice(text.as_bytes());
        self.bytes.push(0);
    }

    #[inline]
    fn align(&mut self, size: usize) {
        // `size` is a power of two, so the mask gives the bytes missing to its next multiple, counted from after the
        // header.
        let padding = HEADER.len().wrapping_sub(self.bytes.len()) & (size - 1);
        if padding > 0 {
            self.bytes.extend_from_slice(&[0; 8][..padding]);
        }
    }
}

impl Default for Writer {
    fn default() -> Writer {
        Writer::new()
    }
}
