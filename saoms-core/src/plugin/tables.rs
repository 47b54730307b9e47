//! The tables of a library, held to be whole before anything in them is used: a null function that is called ends the
//! program, in C long after the start.

use std::mem::offset_of;

use saoms_abi::{ClassTable, ComponentTable, ImplementationTable, LoopClassTable, LoopTable, RuleTable};
use saoms_api::boundary::null_in;

/// A table of functions, which begins with its size.
pub(super) trait Table: Sized {
    /// Its name in the header of the boundary.
    const NAME: &str;
    /// The least size of it: what came later may be missing in libraries that were built before.
    const LEAST: usize = size_of::<Self>();
    /// The members that may not be null, with their places.
    const NEEDED: &[(&str, usize)];
}

macro_rules! table {
    ($table:ident: $($member:ident),*; $($least:expr)?) => {
        impl Table for $table {
            const NAME: &str = concat!("Saoms", stringify!($table));
            $(const LEAST: usize = $least;)?
            const NEEDED: &[(&str, usize)] = &[$((stringify!($member), offset_of!($table, $member))),*];
        }
    };
}

table!(ClassTable: construct, component;);
table!(
    ComponentTable: initialize, execute, shutdown, serve, destroy;
    offset_of!(ComponentTable, waits_for)
);
table!(LoopClassTable: construct, looping;);
table!(LoopTable: effect, entries, initialize, monitor, adapt, shutdown, destroy;);
table!(RuleTable: check;);
table!(ImplementationTable: declare, construct, component;);

/// Checks that a table of a class, a loop or a rule is whole.
///
/// # Errors
/// It is null, too short, or lacks a function.
///
/// # Safety
/// It is null, or there for as long as the program runs.
pub(super) unsafe fn whole<T: Table>(table: *const T, of: &str) -> Result<*const T, String> {
    let name = T::NAME;
    if table.is_null() {
        return Err(format!("its `{name}` of {of} is null: set it in the tables of the library"));
    }
    // SAFETY: as the caller promises; all tables begin with their size.
    let size = unsafe { *table.cast::<usize>() };
    if size < T::LEAST {
        let least = T::LEAST;
        return Err(format!(
            "its `{name}` of {of} has {size} bytes, expected at least {least}: set its member `size` to \
             `sizeof({name})`"
        ));
    }
    // SAFETY: the size says that all these members are there.
    if let Some(member) = unsafe { null_in(table.cast(), T::NEEDED) } {
        return Err(format!(
            "`{member}` in its `{name}` of {of} is null: set it, to a function that does nothing where there is \
             nothing to do"
        ));
    }
    Ok(table)
}

/// The tables of a list, with what each is of.
///
/// # Safety
/// As many as there are names are there, for as long as the program runs.
pub(super) unsafe fn all<T: Table>(
    first: *const *const T,
    what: &str,
    names: &[String],
) -> Result<Vec<*const T>, String> {
    if first.is_null() && !names.is_empty() {
        return Err(format!("its list of `{}`s is null, expected {} {what}", T::NAME, names.len()));
    }
    // SAFETY: as the caller promises.
    names.iter().enumerate().map(|(place, of)| unsafe { whole(*first.add(place), &format!("{what} `{of}`")) }).collect()
}
