//! Hash tables for names out of files.

use std::collections::{HashMap, HashSet};
use std::hash::{BuildHasher, Hasher, RandomState};

/// A table that is fast for short names and small numbers. Where a name falls is another place in each table, so that nobody can write a
/// file whose names all fall on one.
pub(crate) type Map<K, V> = HashMap<K, V, Seeded>;

/// The same, for names alone.
pub(crate) type Set<K> = HashSet<K, Seeded>;

/// Makes hashers that start from a random number.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Seeded(u64);

impl Default for Seeded {
    fn default() -> Self {
        Self(RandomState::new().hash_one(0))
    }
}

impl BuildHasher for Seeded {
    type Hasher = Folding;

    fn build_hasher(&self) -> Folding {
        Folding(self.0)
    }
}

/// Folds words into a state.
pub(crate) struct Folding(u64);

impl Hasher for Folding {
    fn finish(&self) -> u64 {
        self.0
    }

    fn write(&mut self, bytes: &[u8]) {
        if let Some(last) = bytes.last_chunk::<8>() {
            let (words, rest) = bytes.as_chunks::<8>();
            for word in words {
                self.write_u64(u64::from_le_bytes(*word));
            }
            // The last eight hold some a second time.
            if !rest.is_empty() {
                self.write_u64(u64::from_le_bytes(*last));
            }
        } else if !bytes.is_empty() {
            self.write_u64(bytes.iter().fold(0, |word, byte| word << 8 | u64::from(*byte)));
        }
        // `a` and `a\0` differ.
        self.write_u64(bytes.len() as u64);
    }

    fn write_u8(&mut self, word: u8) {
        self.write_u64(u64::from(word));
    }

    fn write_u32(&mut self, word: u32) {
        self.write_u64(u64::from(word));
    }

    fn write_u64(&mut self, word: u64) {
        self.0 = fold(self.0, word);
    }

    fn write_usize(&mut self, word: usize) {
        self.write_u64(word as u64);
    }
}

/// Mixes one word into a hash: the two halves of a 128-bit product folded together, as in Wang Yi's wyhash (public domain). Integers only,
/// so that the result is the same on every machine.
#[inline]
pub(crate) fn fold(state: u64, word: u64) -> u64 {
    const FIRST: u64 = 0xa076_1d64_78bd_642f;
    const SECOND: u64 = 0xe703_7ed1_a0b4_28db;
    let product = u128::from(state ^ FIRST) * u128::from(word ^ SECOND);
    (product as u64) ^ ((product >> 64) as u64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_that_differ_hash_differently() {
        let hashing = Seeded::default();
        let names = ["", "\0", "a", "a\0", "ab", "Robot001", "Robot0010", "Robot001\0", "Robot00100000000"];
        for (place, one) in names.iter().enumerate() {
            for other in &names[..place] {
                assert_ne!(hashing.hash_one(one), hashing.hash_one(other), "{one:?} and {other:?}");
            }
        }
        assert_eq!(hashing.hash_one("Robot001"), hashing.hash_one(String::from("Robot001")));
        assert_ne!(Seeded::default().hash_one("a"), Seeded::default().hash_one("a"), "tables differ");
    }
}
