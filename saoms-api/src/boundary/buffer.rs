use std::ffi::c_void;
use std::ptr;

use saoms_abi::{Bytes, MAX_BYTES, Sink};

use crate::Failure;

/// Bytes that a callee put.
#[derive(Debug, Default)]
pub(super) struct Buffer {
    pub(super) bytes: Vec<u8>,
    /// True if there were more than [`MAX_BYTES`].
    overflowed: bool,
}

impl Buffer {
    /// # Safety
    /// The bytes are readable.
    pub(super) unsafe fn take(&mut self, bytes: Bytes) {
        // SAFETY: as the caller promises.
        match unsafe { bytes.get() } {
            Ok(bytes) if self.bytes.len() + bytes.len() <= MAX_BYTES => self.bytes.extend_from_slice(bytes),
            _ => self.overflowed = true,
        }
    }

    /// All that was put.
    pub(super) fn get(&self) -> Result<&[u8], Failure> {
        if self.overflowed {
            return Err(Failure::new(format!("found more than {MAX_BYTES} bytes, or bytes that cannot be read")));
        }
        Ok(&self.bytes)
    }

    /// Makes it empty; memory for more than this many bytes is given back.
    pub(super) fn reset(&mut self, kept: usize) {
        self.bytes.clear();
        self.bytes.shrink_to(kept);
        self.overflowed = false;
    }
}

/// A sink into a buffer, for a callee that is known to put only while it is called.
pub(super) fn sink(buffer: &mut Buffer) -> Sink {
    unsafe extern "C" fn put(state: *mut c_void, bytes: Bytes) {
        // SAFETY: `state` is the buffer of `sink`, which only this call uses; the callee lends the bytes to it.
        unsafe { (*state.cast::<Buffer>()).take(bytes) }
    }
    Sink { state: ptr::from_mut(buffer).cast(), put }
}
