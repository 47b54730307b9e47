use core::ffi::c_void;
use core::{ptr, slice, str};

use crate::ReadError;

/// The greatest length of a message, a text or a reply; a longer one is refused.
pub const MAX_BYTES: usize = 64 << 20;

/// Bytes that are lent for the time of a call.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Bytes {
    /// The first byte; may be null when there are none.
    pub data: *const u8,
    /// Their number.
    pub length: usize,
}

impl Bytes {
    /// No bytes.
    pub const NONE: Bytes = Bytes { data: ptr::null(), length: 0 };

    /// Lends bytes.
    pub const fn lend(bytes: &[u8]) -> Bytes {
        Bytes { data: bytes.as_ptr(), length: bytes.len() }
    }

    /// Lends text.
    pub const fn text(text: &str) -> Bytes {
        Bytes::lend(text.as_bytes())
    }

    /// The bytes.
    ///
    /// # Errors
    /// There are more than [`MAX_BYTES`], or they are null.
    ///
    /// # Safety
    /// They are readable for as long as the result is used.
    pub unsafe fn get<'a>(self) -> Result<&'a [u8], ReadError> {
        if self.length > MAX_BYTES {
            return Err(ReadError::TooManyBytes(self.length));
        }
        if self.length == 0 {
            return Ok(&[]);
        }
        if self.data.is_null() {
            return Err(ReadError::Null(self.length));
        }
        // SAFETY: the caller promises that they are readable; the length was checked.
        Ok(unsafe { slice::from_raw_parts(self.data, self.length) })
    }

    /// The bytes as text.
    ///
    /// # Errors
    /// There are too many, they are null, or they are not UTF-8.
    ///
    /// # Safety
    /// As [`get`](Bytes::get).
    pub unsafe fn get_text<'a>(self) -> Result<&'a str, ReadError> {
        // SAFETY: as the caller promises.
        str::from_utf8(unsafe { self.get() }?).map_err(ReadError::NotUtf8)
    }
}

/// A list that is lent for the time of a call.
///
/// # Errors
/// It is longer than [`MAX_BYTES`], or null.
///
/// # Safety
/// It is readable for as long as the result is used.
pub unsafe fn list<'a, T>(first: *const T, count: usize) -> Result<&'a [T], ReadError> {
    if count.saturating_mul(size_of::<T>()) > MAX_BYTES {
        return Err(ReadError::TooLongList(count));
    }
    if count == 0 {
        return Ok(&[]);
    }
    if first.is_null() {
        return Err(ReadError::Null(count));
    }
    // SAFETY: the caller promises that it is readable; the length was checked.
    Ok(unsafe { slice::from_raw_parts(first, count) })
}

/// The receiver of text or bytes that a callee gives back. They are copied at once; putting again appends.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Sink {
    /// The caller's own; the first argument of `put`.
    pub state: *mut c_void,
    /// Appends bytes.
    pub put: unsafe extern "C" fn(state: *mut c_void, bytes: Bytes),
}

impl Sink {
    /// Appends bytes.
    ///
    /// # Safety
    /// The sink's owner still waits for the call that it was given to.
    pub unsafe fn put(self, bytes: &[u8]) {
        // SAFETY: as the caller promises.
        unsafe { (self.put)(self.state, Bytes::lend(bytes)) }
    }
}
