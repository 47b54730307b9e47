use core::error::Error;
use core::fmt;
use core::str::Utf8Error;

use crate::MAX_BYTES;

/// A reason why bytes, a text or a list of the other side cannot be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ReadError {
    /// So many bytes, which is more than [`MAX_BYTES`].
    TooManyBytes(usize),
    /// A list of so many elements, which is more than [`MAX_BYTES`].
    TooLongList(usize),
    /// Null for so many bytes or elements.
    Null(usize),
    /// A text that is not UTF-8.
    NotUtf8(Utf8Error),
}

impl fmt::Display for ReadError {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            ReadError::TooManyBytes(count) => {
                write!(out, "found {count} bytes, expected at most {MAX_BYTES}")
            }
            ReadError::TooLongList(count) => {
                write!(out, "found a list of {count}, which is more than {MAX_BYTES} bytes")
            }
            ReadError::Null(count) => write!(out, "found null for {count} bytes or elements"),
            ReadError::NotUtf8(error) => write!(out, "found text that is not UTF-8: {error}"),
        }
    }
}

impl Error for ReadError {}
