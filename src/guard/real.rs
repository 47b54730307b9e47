//! Functions of the system that have the names of functions of the program, which stand before them.

use std::ffi::{CStr, c_void};
use std::ptr;
use std::sync::atomic::{AtomicPtr, Ordering};

use super::blame::next;

/// A function of the system, once it was looked up.
pub(super) struct Real(&'static CStr, AtomicPtr<c_void>);

impl Real {
    pub(super) const fn of(name: &'static CStr) -> Real {
        Real(name, AtomicPtr::new(ptr::null_mut()))
    }

    /// Its address; null if there is none.
    pub(super) fn get(&self) -> *mut c_void {
        let mut known = self.1.load(Ordering::Relaxed);
        if known.is_null() {
            known = next(self.0);
            self.1.store(known, Ordering::Relaxed);
        }
        known
    }
}
