//! Property structs in the place of a field of another one.

use crate::host::declaration::ConstText;
use crate::host::{PropertyValue, SmolStr};

/// Number of names in all lists.
pub const fn count(parts: &[&[&str]]) -> usize {
    let (mut part, mut count) = (0, 0);
    while part < parts.len() {
        count += parts[part].len();
        part += 1;
    }
    count
}

/// The names of all lists; `N` has to be their [`count`].
pub const fn all_names<const N: usize>(parts: &[&[&'static str]]) -> [&'static str; N] {
    let mut names = [""; N];
    let (mut part, mut end) = (0, 0);
    while part < parts.len() {
        let mut at = 0;
        while at < parts[part].len() {
            names[end] = parts[part][at];
            (at, end) = (at + 1, end + 1);
        }
        part += 1;
    }
    names
}

/// True if no two names are equal.
pub const fn are_distinct(names: &[&str]) -> bool {
    let mut at = 0;
    while at < names.len() {
        if super::contains(names.split_at(at).0, names[at]) {
            return false;
        }
        at += 1;
    }
    true
}

/// The items of a JSON array, with a comma before them where there are any.
pub const fn continued(array: &'static str) -> [ConstText; 2] {
    let inside = array.split_at(array.len() - 1).0.split_at(1).1;
    [ConstText::Plain(if inside.is_empty() { "" } else { "," }), ConstText::Plain(inside)]
}

/// The JSON array of items that each have a comma before them.
pub const fn list(items: &'static str) -> [ConstText; 3] {
    let items = if items.is_empty() { items } else { items.split_at(1).1 };
    [ConstText::Plain("["), ConstText::Plain(items), ConstText::Plain("]")]
}

/// The values with these names.
pub(crate) fn values_of(values: &[(SmolStr, PropertyValue)], names: &[&str]) -> Vec<(SmolStr, PropertyValue)> {
    values.iter().filter(|(name, _)| names.contains(&name.as_str())).cloned().collect()
}
