use std::any::Any;

use crate::host::declaration::ConstText;
use crate::{Failure, Value};

/// Declared, typed entries: those of a component's knowledge, of a part of it, or those that a loop adds to it.
///
/// Derive it on a struct; the fields marked `#[entry]` are entries. Their types are [`Field`](crate::Field)s. An entry
/// has the field's name in lowerCamelCase and its doc. `#[entry(...)]` takes:
///
/// | attribute | meaning |
/// | --- | --- |
/// | `name = "..."` | another name |
/// | `unit = "m"` | shown to people |
/// | `effector` | an output: of the loops of a component only one may change it |
/// | `flatten` | the field is a struct that derives `Entries`; its entries stand in the place of the field |
/// | `quiet` | what changes all the time, or follows from others: its changes are not written to the journal |
///
/// ```
/// use saoms_api::Entries;
///
/// /// What a loop remembers for others to see.
/// #[derive(Default, Entries)]
/// struct Saving {
///     /// True if the robot spares its battery.
///     #[entry]
///     saving: bool,
///     /// What it has spared so far.
///     #[entry(unit = "%")]
///     spared: f64,
///     /// Not an entry.
///     since: u64,
/// }
///
/// let names: Vec<&str> = Saving::DECLARED.iter().map(|entry| entry.name).collect();
/// assert_eq!(names, ["saving", "spared"]);
/// ```
pub trait Entries: Send + Sized + 'static {
    /// The entries in order. An entry is known by its place in here.
    const DECLARED: &'static [EntryDeclaration];
    /// Their JSON objects with commas between, in the shape of [`crate::host::declaration`].
    const TEXT: ConstText;

    /// The value of an entry; `None` for one that is no single value, or for none at all.
    fn get(&self, entry: u32) -> Option<Value>;

    /// Sets it.
    ///
    /// # Errors
    /// There is no such entry, it is no single value, or its type is another.
    fn set(&mut self, entry: u32, value: Value) -> Result<(), Failure>;

    /// Replaces `bytes` by an entry of any type as [CDR](crate::host::cdr).
    ///
    /// # Errors
    /// There is no such entry.
    fn get_bytes(&self, entry: u32, bytes: &mut Vec<u8>) -> Result<(), Failure>;

    /// Sets an entry of any type from [CDR](crate::host::cdr).
    ///
    /// # Errors
    /// There is no such entry, or these are not the bytes of one.
    fn set_bytes(&mut self, entry: u32, bytes: &[u8]) -> Result<(), Failure>;

    /// Appends the values of all entries, [`Value::Nothing`] for those that are no single values, or quiet.
    fn read(&self, values: &mut Vec<Value>);
}

/// Declaration of an entry.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EntryDeclaration {
    /// Its name.
    pub name: &'static str,
    /// Its type as a fragment of a schema, as [`Field::TYPE`](crate::Field::TYPE).
    pub of: &'static str,
    /// True if only one of a component's loops may change it.
    pub effector: bool,
}

/// Entries of any type, as [`Extras`](crate::Extras) hold them.
pub trait DynEntries: Any + Send {
    /// See [`Entries::DECLARED`].
    fn declared(&self) -> &'static [EntryDeclaration];
    /// See [`Entries::get`].
    fn get(&self, entry: u32) -> Option<Value>;
    /// See [`Entries::set`].
    ///
    /// # Errors
    /// As there.
    fn set(&mut self, entry: u32, value: Value) -> Result<(), Failure>;
    /// See [`Entries::get_bytes`].
    ///
    /// # Errors
    /// As there.
    fn get_bytes(&self, entry: u32, bytes: &mut Vec<u8>) -> Result<(), Failure>;
    /// See [`Entries::set_bytes`].
    ///
    /// # Errors
    /// As there.
    fn set_bytes(&mut self, entry: u32, bytes: &[u8]) -> Result<(), Failure>;
    /// See [`Entries::read`].
    fn read(&self, values: &mut Vec<Value>);
}

impl<E: Entries> DynEntries for E {
    fn declared(&self) -> &'static [EntryDeclaration] {
        E::DECLARED
    }

    fn get(&self, entry: u32) -> Option<Value> {
        Entries::get(self, entry)
    }

    fn set(&mut self, entry: u32, value: Value) -> Result<(), Failure> {
        Entries::set(self, entry, value)
    }

    fn get_bytes(&self, entry: u32, bytes: &mut Vec<u8>) -> Result<(), Failure> {
        Entries::get_bytes(self, entry, bytes)
    }

    fn set_bytes(&mut self, entry: u32, bytes: &[u8]) -> Result<(), Failure> {
        Entries::set_bytes(self, entry, bytes)
    }

    fn read(&self, values: &mut Vec<Value>) {
        Entries::read(self, values);
    }
}

/// For generated code: the entries of several groups as one list of length `N`.
pub const fn joined<const N: usize>(groups: &[&[EntryDeclaration]]) -> [EntryDeclaration; N] {
    let mut all = [EntryDeclaration { name: "", of: "", effector: false }; N];
    let (mut group, mut end) = (0, 0);
    while group < groups.len() {
        let mut at = 0;
        while at < groups[group].len() {
            all[end] = groups[group][at];
            (at, end) = (at + 1, end + 1);
        }
        group += 1;
    }
    all
}

/// For generated code: whether no two entries have one name.
pub const fn are_unique(entries: &[EntryDeclaration]) -> bool {
    let mut one = 0;
    while one < entries.len() {
        let mut other = 0;
        while other < one {
            if crate::property::equal(entries[one].name.as_bytes(), entries[other].name.as_bytes()) {
                return false;
            }
            other += 1;
        }
        one += 1;
    }
    true
}

/// For generated code: there is no entry at this place.
#[cold]
pub fn no_entry(entry: u32) -> Failure {
    Failure::new(format!("there is no entry {entry}"))
}

/// For generated code: sets a field from a single value.
///
/// # Errors
/// The value is not one of the field's type.
pub fn set_field<F: crate::Field>(field: &mut F, name: &str, value: Value) -> Result<(), Failure> {
    match F::of_value(value) {
        Some(value) => {
            *field = value;
            Ok(())
        }
        None => Err(Failure::new(format!("entry `{name}`: `{value}` is not a {}", F::TYPE))),
    }
}

/// For generated code: sets a field from its bytes.
///
/// # Errors
/// They are not those of a value of its type.
pub fn decode_field<F: crate::Field>(field: &mut F, name: &str, bytes: &[u8]) -> Result<(), Failure> {
    *field = crate::host::cdr::decode(bytes).map_err(|error| Failure::new(format!("entry `{name}`: {error}")))?;
    Ok(())
}
