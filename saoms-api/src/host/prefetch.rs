//! Loading memory before it is needed.

/// Number of bytes of a line of the processor's cache.
const LINE: usize = 64;

/// Greatest number of bytes of one object: more would push out what the present code needs.
const MOST: usize = 128 * LINE;

/// Asks the processor to load an object into its cache, without waiting for it. Where it cannot be asked, nothing
/// happens. Of a large object the first 8 kB are loaded.
///
/// ```
/// use saoms_api::host::prefetch;
///
/// let table = vec![0_u8; 4096];
/// prefetch(table.as_slice());
/// assert_eq!(table[100], 0);
/// ```
#[inline]
pub fn prefetch<T: ?Sized>(object: &T) {
    let size = size_of_val(object).min(MOST);
    let start = std::ptr::from_ref(object).cast::<u8>();
    for offset in (0..size).step_by(LINE) {
        load(start.wrapping_add(offset));
    }
}

#[inline]
#[cfg(target_arch = "x86_64")]
fn load(address: *const u8) {
    use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
    // SAFETY: a prefetch is a hint. It reads nothing that the program sees, and fails at no address.
    unsafe { _mm_prefetch::<_MM_HINT_T0>(address.cast()) }
}

#[inline]
#[cfg(target_arch = "aarch64")]
fn load(address: *const u8) {
    // SAFETY: a prefetch is a hint. It reads nothing that the program sees, and fails at no address.
    unsafe { std::arch::asm!("prfm pldl1keep, [{}]", in(reg) address, options(nostack, readonly, preserves_flags)) }
}

#[inline]
#[cfg(not(any(target_arch = "x86_64", target_arch = "aarch64")))]
fn load(_: *const u8) {}
