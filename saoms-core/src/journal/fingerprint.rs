use saoms_api::host::Phase;
use saoms_api::{Record, Value};

use crate::hash::fold;

/// Stands where the phase of a record does, so that no record has the digest of a change.
const CHANGE: u64 = 3;

/// A digest of a record: its phase, its id and its values, the same on every machine.
pub(super) fn fingerprint(phase: Phase, record: &Record) -> u64 {
    digest(phase as u64, record.id(), record.used())
}

/// A digest of a change of an entry of the knowledge.
pub(super) fn fingerprint_of_change(entry: &str, before: Value, after: Value) -> u64 {
    digest(CHANGE, entry, &[before, after])
}

fn digest(kind: u64, id: &str, values: &[Value]) -> u64 {
    let mut hash = text(kind, id);
    for value in values {
        hash = match value {
            Value::Nothing => fold(hash, 0),
            Value::Bool(value) => fold(fold(hash, 1), u64::from(*value)),
            Value::Integer(value) => fold(fold(hash, 2), *value as u64),
            // Adding 0.0 makes -0.0 and 0.0 the same.
            Value::Number(value) => fold(fold(hash, 3), (value + 0.0).to_bits()),
            Value::Pair(x, y) => fold(fold(hash, 4), u64::from(*x as u32) << 32 | u64::from(*y as u32)),
            Value::Word(word) => text(fold(hash, 5), word),
            Value::Text(short) => text(fold(hash, 5), short.as_str()),
        };
    }
    hash
}

fn text(mut hash: u64, text: &str) -> u64 {
    let (words, rest) = text.as_bytes().as_chunks::<8>();
    for word in words {
        hash = fold(hash, u64::from_le_bytes(*word));
    }
    let mut last = [0; 8];
    last[..rest.len()].copy_from_slice(rest);
    fold(fold(hash, u64::from_le_bytes(last)), text.len() as u64)
}
