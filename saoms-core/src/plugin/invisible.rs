//! Names in metadata that could hide what is shown beside them, as those with control characters.

use saoms_api::host::is_invisible;
use serde_json::Value;

/// The members of metadata that are texts for people or values, and no names.
const TEXTS: [&str; 5] = ["doc", "meaning", "default", "allowed", "preset"];

/// Refuses metadata with such a name.
///
/// # Errors
/// The first one, as the error of the metadata says it.
pub(super) fn check(text: &str) -> Result<(), String> {
    // In most metadata, a glance is enough: a character may also be written as an escape.
    if !text.contains(|character| character == '\\' || is_invisible(character)) {
        return Ok(());
    }
    let metadata: Value = serde_json::from_str(text).map_err(|error| error.to_string())?;
    match first(&metadata, "its metadata") {
        Some((name, role)) => Err(format!(
            "the name `{name}` ({role}) has a control character, or another one that nobody sees: give it another name"
        )),
        None => Ok(()),
    }
}

/// The first such name, and the member that it is a value of.
fn first<'a>(value: &'a Value, role: &'a str) -> Option<(&'a str, &'a str)> {
    match value {
        Value::String(name) => name.contains(is_invisible).then_some((name, role)),
        Value::Array(all) => all.iter().find_map(|one| first(one, role)),
        Value::Object(members) => {
            members.iter().filter(|(member, _)| !TEXTS.contains(&member.as_str())).find_map(|(member, value)| {
                if member.contains(is_invisible) { Some((&**member, role)) } else { first(value, member) }
            })
        }
        _ => None,
    }
}
