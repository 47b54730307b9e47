//! Truth values as people write them.

use super::nearest;

/// The truth value, `true` or `false`, that a text probably means which is neither.
pub(crate) fn meant_boolean(text: &str) -> Option<&'static str> {
    match text.to_ascii_lowercase().as_str() {
        "yes" | "y" | "on" | "t" => Some("true"),
        "no" | "n" | "off" | "f" => Some("false"),
        other => nearest(other, ["true", "false"]),
    }
}
