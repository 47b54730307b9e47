use std::hash::{BuildHasherDefault, Hasher};

/// Mixes one word into a hash: the two halves of a 128-bit product folded together, as in Wang Yi's wyhash (public domain). Integers only,
/// so that the result is the same on every machine.
#[inline]
pub(crate) fn fold(state: u64, word: u64) -> u64 {
    const FIRST: u64 = 0xa076_1d64_78bd_642f;
    const SECOND: u64 = 0xe703_7ed1_a0b4_28db;
    let product = u128::from(state ^ FIRST) * u128::from(word ^ SECOND);
    (product as u64) ^ ((product >> 64) as u64)
}

/// A hasher for keys that are small integers chosen by the fleet itself.
#[derive(Default)]
pub(super) struct KeyHasher(u64);

pub(super) type KeyHashing = BuildHasherDefault<KeyHasher>;

impl Hasher for KeyHasher {
    fn finish(&self) -> u64 {
        self.0
    }

    fn write(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            self.0 = fold(self.0, u64::from(byte));
        }
    }

    fn write_u64(&mut self, word: u64) {
        self.0 = fold(self.0, word);
    }

    fn write_u32(&mut self, word: u32) {
        self.0 = fold(self.0, u64::from(word));
    }
}
