//! Null pointers from C where they are not allowed: reported as such before the program ends.

use std::ffi::c_void;

use crate::Failure;

/// The first of these members of a table that is null, each with its place in the table. All are pointers.
///
/// # Safety
/// The table has all of them.
pub unsafe fn null_in(table: *const c_void, members: &[(&'static str, usize)]) -> Option<&'static str> {
    // SAFETY: as the caller promises; functions have the size of pointers, and are read as such, as a null one is no
    // value of their type.
    let is_null = |place: usize| unsafe { *table.byte_add(place).cast::<*const c_void>() }.is_null();
    members.iter().find(|(_, place)| is_null(*place)).map(|(member, _)| *member)
}

/// The value behind an argument.
///
/// # Errors
/// It is null.
///
/// # Safety
/// It is null or readable.
pub(super) unsafe fn given<'a, T>(argument: *const T, what: &str) -> Result<&'a T, Failure> {
    // SAFETY: as the caller promises.
    unsafe { argument.as_ref() }.ok_or_else(|| null(what))
}

/// The place behind an argument that takes an answer.
///
/// # Errors
/// It is null.
///
/// # Safety
/// It is null or can be written.
pub(super) unsafe fn place<'a, T>(argument: *mut T, what: &str) -> Result<&'a mut T, Failure> {
    // SAFETY: as the caller promises.
    unsafe { argument.as_mut() }.ok_or_else(|| null(what))
}

#[cold]
fn null(what: &str) -> Failure {
    Failure::new(format!("found null for {what}, expected its address"))
}
