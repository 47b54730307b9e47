//! Names in metadata that would spoil what is shown beside them: with control characters, or without end.

use saoms_api::host::{is_invisible, shorten};
use serde_json::Value;

/// The members of metadata that are texts for people or values, and no names.
const TEXTS: [&str; 5] = ["doc", "meaning", "default", "allowed", "preset"];

/// The most bytes of a name.
const LONGEST: usize = 1000;

/// Refuses metadata with such a name.
///
/// # Errors
/// The first one, as the error of the metadata says it.
pub(super) fn check(text: &str) -> Result<(), String> {
    let metadata: Value = serde_json::from_str(text).map_err(|error| error.to_string())?;
    let Some((name, role)) = first(&metadata, "its metadata") else { return Ok(()) };
    let mut message = match name.len() {
        length if length > LONGEST => {
            format!("the name `{name}` ({role}) has {length} bytes, expected at most {LONGEST}")
        }
        _ => format!(
            "the name `{name}` ({role}) contains a control character or another invisible character: choose another name"
        ),
    };
    shorten(&mut message);
    Err(message)
}

/// The first such name, and the member that it is a value of.
fn first<'a>(value: &'a Value, role: &'a str) -> Option<(&'a str, &'a str)> {
    let is_wrong = |name: &str| name.len() > LONGEST || name.contains(is_invisible);
    match value {
        Value::String(name) => is_wrong(name).then_some((name, role)),
        Value::Array(all) => all.iter().find_map(|one| first(one, role)),
        Value::Object(members) => members
            .iter()
            .filter(|(member, _)| !TEXTS.contains(&member.as_str()))
            .find_map(|(member, value)| if is_wrong(member) { Some((&**member, role)) } else { first(value, member) }),
        _ => None,
    }
}
