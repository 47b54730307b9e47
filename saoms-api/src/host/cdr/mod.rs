//! The byte form of messages and service calls: CDR, as ROS 2 uses it.
//!
//! It is plain CDR, version 1 (XCDR1), little endian, from the DDS Interoperability Wire Protocol (OMG
//! formal/2022-04-01, section 10):
//!
//! | value | bytes |
//! | --- | --- |
//! | whole message | the header `00 01 00 00`, then its fields in order |
//! | bool, integers, floats | little endian, aligned to their size, counted from after the header; padding is zero |
//! | string | u32 length with the final NUL, the UTF-8 text, NUL |
//! | sequence, with a bound or without | u32 number of elements, the elements |
//! | array | its elements |
//! | nested message | its fields |
//! | enumeration | the integer of its constant |
//! | nothing: a message without fields, `()`, no arguments | one zero byte, as ROS 2 has it |
//!
//! Bytes from outside are not trusted: [`decode`] checks every length before it allocates, and refuses bytes that are
//! left over.
//!
//! ```
//! use saoms_api::host::cdr;
//! use saoms_api::Message;
//!
//! #[derive(Clone, Debug, PartialEq, Message)]
//! struct Position {
//!     robot: u8,
//!     x: i32,
//! }
//!
//! let bytes = cdr::encode(&Position { robot: 7, x: -1 });
//! assert_eq!(bytes, [0, 1, 0, 0, 7, 0, 0, 0, 255, 255, 255, 255]);
//! assert_eq!(cdr::decode(&bytes), Ok(Position { robot: 7, x: -1 }));
//! ```

mod error;
mod reader;
#[cfg(test)]
mod tests;
mod writer;

pub use error::DecodeError;
pub use reader::Reader;
pub use writer::Writer;

use crate::Field;

/// The header: representation identifier `CDR_LE`, no options.
const HEADER: [u8; 4] = [0, 1, 0, 0];

/// The bytes of a message or field.
///
/// # Panics
/// As [`Writer::length`]: a string or sequence has 2^32 elements or more.
pub fn encode<F: Field>(value: &F) -> Vec<u8> {
    // Enough for whatever holds no strings and sequences, and for short ones.
    let mut writer = Writer::reusing(Vec::with_capacity(F::LEAST_SIZE + 64));
    value.write(&mut writer);
    writer.into_bytes()
}

/// [`encode`] into a reused buffer: its content is replaced, its memory is kept.
///
/// # Panics
/// As [`encode`].
pub fn encode_into<F: Field>(value: &F, bytes: &mut Vec<u8>) {
    let mut writer = Writer::reusing(std::mem::take(bytes));
    value.write(&mut writer);
    *bytes = writer.into_bytes();
}

/// The message or field of these bytes.
///
/// # Errors
/// The bytes end too early or too late, or hold something that is no such value.
pub fn decode<F: Field>(bytes: &[u8]) -> Result<F, DecodeError> {
    let mut reader = Reader::new(bytes)?;
    let value = F::read(&mut reader)?;
    reader.finish()?;
    Ok(value)
}
