//! The hash of traces and of topics: the same on every machine.

/// Mixes one word into a hash: the two halves of a 128-bit product folded together, as in Wang Yi's wyhash (public
/// domain). Integers only, so that the result is the same on every machine.
#[inline]
pub(crate) fn fold(state: u64, word: u64) -> u64 {
    const FIRST: u64 = 0xa076_1d64_78bd_642f;
    const SECOND: u64 = 0xe703_7ed1_a0b4_28db;
    let product = u128::from(state ^ FIRST) * u128::from(word ^ SECOND);
    (product as u64) ^ ((product >> 64) as u64)
}

/// The hash of a text: the same on every machine, in every program.
pub(crate) fn text_hash(text: &str) -> u64 {
    text.bytes().fold(0, |hash, byte| fold(hash, u64::from(byte)))
}
